// The run at the pointer of a map: its error as a thin line on the chart of the error.

import { indicesIn } from "../model/timeline.js";

/** @typedef {{key: string, time: ArrayLike<number>, errors: ArrayLike<number>}} Followed */

export class RunThere {
  /** @param {any} chart  of the error */
  constructor(chart) {
    this.chart = chart;
    const space = "http://www.w3.org/2000/svg";
    const picture = (this.picture = document.createElementNS(space, "svg"));
    this.path = document.createElementNS(space, "path");
    this.name = document.createElementNS(space, "text");
    picture.append(this.path, this.name);
    picture.setAttribute("class", "sketched there");
    picture.setAttribute("aria-hidden", "true");
    chart.figure.append(picture);
    /** @type {((task: {key: string, follow: any}) => void) | null} what follows runs */
    this.ask = null;
    /** @type {{key: string, follow: any} | null} the run that is wanted */
    this.wanted = null;
    /** @type {Followed | null} */
    this.found = null;
    this.waiting = false;
  }

  /** Show the run of settings, named by a key; null shows none. */
  want(wanted) {
    this.wanted = this.chart.figure.hidden ? null : wanted;
    if (!this.wanted) this.found = null;
    this.next();
    // The chart is drawn after the map.
    queueMicrotask(() => this.show());
  }

  /** Ask for the latest one as soon as the one before it is there. */
  next() {
    const { ask, found, waiting, wanted } = this;
    if (!ask || waiting || !wanted || found?.key === wanted.key) return;
    this.waiting = true;
    ask(wanted);
  }

  /** @param {Followed} found  that was asked for */
  take(found) {
    this.waiting = false;
    if (!this.wanted) return;
    this.found = found;
    this.next();
    this.show();
  }

  /** Let something else follow runs; null for nothing. */
  from(ask) {
    this.ask = ask;
    this.waiting = false;
  }

  show() {
    const { chart: { place }, found, name, path, picture } = this;
    const drawn = found && place ? pathOf(found, place) : "";
    if ((path.getAttribute("d") ?? "") !== drawn) path.setAttribute("d", drawn);
    name.textContent = drawn && "the run at the pointer";
    if (!drawn) return;
    picture.style.clipPath = `inset(${place.top}px 0 calc(100% - ${place.bottom}px) 0)`;
    name.setAttribute("x", String(place.left + place.width - 4));
    name.setAttribute("y", String(place.top + 10));
  }
}

/** The least and the greatest error of each pixel column, as a path with gaps where there is none. */
function pathOf({ time, errors }, place) {
  const pieces = [];
  let column = NaN;
  let ends = [NaN, NaN];
  const flush = () => {
    if (Number.isNaN(column)) return;
    for (const value of ends[0] === ends[1] ? [ends[0]] : ends) pieces.push(`${pieces.at(-1) ? "L" : "M"}${column},${place.y(value).toFixed(1)}`);
    column = NaN;
  };
  const [from, to] = indicesIn(time, place.span);
  for (let k = from; k <= to; k++) {
    const value = errors[k];
    const at = Math.round(place.x(time[k]));
    if (at !== column) flush();
    if (!Number.isFinite(value)) {
      flush();
      if (pieces.at(-1)) pieces.push("");
    } else if (Number.isNaN(column)) [column, ends] = [at, [value, value]];
    else ends = [Math.min(ends[0], value), Math.max(ends[1], value)];
  }
  flush();
  return pieces.join("");
}
