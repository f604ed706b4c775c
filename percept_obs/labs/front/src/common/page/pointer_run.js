// The run at the pointer of a map: its error as a thin line on the chart of the error.

import { tracePath } from "./charts.js";
import { setAttribute, setText, svg } from "./dom.js";

/** Shows one run at a time; of all that are wanted while it is computed, only the latest is asked for. */
export class PointerRun {
  /** @param {any} chart  of the error */
  constructor(chart) {
    this.chart = chart;
    this.path = svg("path");
    this.name = svg("text");
    this.picture = svg("svg", { class: "there", "aria-hidden": "true" }, this.path, this.name);
    chart.figure.append(this.picture);
    /** @type {((task: {key: string, follow: any}) => void) | null} what computes runs */
    this.ask = null;
    /** @type {{key: string, follow: any} | null} the run that is wanted */
    this.wanted = null;
    /** @type {{key: string, time: ArrayLike<number>, errors: ArrayLike<number>} | null} */
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

  /** Take the run that was asked for. */
  take(found) {
    this.waiting = false;
    if (!this.wanted) return;
    this.found = found;
    this.next();
    this.show();
  }

  /** Let something else compute runs; null for nothing. */
  computeBy(ask) {
    this.ask = ask;
    this.waiting = false;
  }

  show() {
    const { chart: { place }, found, name, path, picture } = this;
    const pieces = [];
    if (found && place) tracePath(writing(pieces), place, found.time, found.errors);
    setAttribute(path, "d", pieces.join(""));
    setText(name, pieces.length ? "the run at the pointer" : "");
    if (!pieces.length) return;
    picture.style.clipPath = `inset(${place.top}px 0 calc(100% - ${place.bottom}px) 0)`;
    name.setAttribute("x", String(place.left + place.width - 4));
    name.setAttribute("y", String(place.top + 10));
  }
}

/** A pen that writes a path down. */
function writing(pieces) {
  const write = (letter) => (x, y) => pieces.push(`${letter}${x.toFixed(1)},${y.toFixed(1)}`);
  return { moveTo: write("M"), lineTo: write("L") };
}
