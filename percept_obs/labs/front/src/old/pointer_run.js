// The run at the pointer of a map: its error as a thin line on the chart of the error.

import { tracePath } from "../draw/old_charts.js";
import { setAttribute, setText, svg } from "../ui/dom.js";
import { meet } from "../draw/labels.js";

const NAME = "the run at the pointer";
/** Pixels below a chart's upper rim at which its name may stand, and the height of its letters. */
const [ROWS, ROW] = [[0, 14, 28, 42], 14];

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
    const { chart, chart: { place }, found, name, path, picture } = this;
    const pieces = [];
    if (found && place) tracePath(writing(pieces), place, found.time, found.errors);
    setAttribute(path, "d", pieces.join(""));
    if (!pieces.length) {
      setText(name, "");
      return;
    }
    picture.style.clipPath = `inset(${place.top}px 0 calc(100% - ${place.bottom}px) 0)`;
    const wide = chart.context.measureText(NAME).width + 2;
    const [right, tops] = [place.right - 4, ROWS.map((row) => place.top + row)];
    const top = tops.find((y) => !chart.texts.some(({ box }) => meet([right - wide, y, right, y + ROW], box)));
    setText(name, top === undefined ? "" : NAME);
    name.setAttribute("x", String(right));
    name.setAttribute("y", String((top ?? 0) + ROW - 4));
  }
}

/** A pen that writes a path down. */
function writing(pieces) {
  const write = (letter) => (x, y) => pieces.push(`${letter}${x.toFixed(1)},${y.toFixed(1)}`);
  return { moveTo: write("M"), lineTo: write("L") };
}
