// The lab of many points: points of one state before a moving camera, and an observer that follows them.

import { readable } from "../../draw/scales.js";
import { FormulaSheet, lettered } from "../../ui/formulas.js";
import { Lab } from "../../ui/lab.js";
import { pythonOf } from "./code.js";
import { PointsEngine } from "./engine.js";
import { PointsKernels } from "./kernels.js";
import { SYMBOLS } from "./symbols.js";
import { decayInWords, reasons, summaryOf, verdict } from "./text.js";
import { PointsScreen } from "./screen.js";
import { NAMES, Panel, WORDS } from "./panel.js";
import { chartOf, CHARTS } from "./charts.js";

/** The equations of the observer and of the motion, with the numbers that sliders set. */
class Formulas extends FormulaSheet {
  constructor({ equations }) {
    super();
    for (const { title, lines } of equations) this.section(title, "", lines);
  }

  show(settings) {
    const numbers = { ...settings, ...lettered({ v_c: settings.camera_velocity }) };
    this.setNumbers((_, letter) => numbers[letter]);
  }
}

/** Where one more point is put, beside the first. */
function placeBeside([x, y, z], k) {
  const round = (value) => Number(value.toFixed(2));
  return [x + 0.5 * Math.cos(2.4 * k), y + 0.4 * Math.sin(2.4 * k), Math.max(z, 1) + 0.1 * k].map(round);
}

export class PointsLab extends Lab {
  static computing = { Kernels: PointsKernels, Engine: PointsEngine };

  constructor(widget, place, model) {
    const parts = { names: NAMES, symbols: SYMBOLS, charts: CHARTS, chartOf, reasons, summaryOf, pythonOf };
    super(widget, model, { words: WORDS, ...parts });
    this.formulas = new Formulas(this.model);
    this.panel = new Panel(this);
    this.screen = new PointsScreen(this);
    this.open(place, this.panel.groups);
  }

  // What the hand does.

  depthOf(k) {
    const { l } = this.model.block;
    return this.settings.points[k].reduce((sum, value, i) => sum + l[i] * value, 0);
  }

  placePoint(k, place) {
    const { most = Infinity } = this.schema.points;
    if (!place.every((value) => Math.abs(value) <= most)) return;
    this.change({ points: this.settings.points.with(k, place) });
  }

  moveDepth(k, depth) {
    const now = this.depthOf(k);
    const [x, y, z] = this.settings.points[k];
    if (depth > 0) this.placePoint(k, now > 0 ? [x, y, z].map((value) => (value * depth) / now) : [x, y, depth]);
  }

  addPoint() {
    const { points, hidden } = this.settings;
    const k = points.length;
    if (k === this.model.mostPoints || !this.layouts[k]) return;
    this.change({ points: [...points, placeBeside(points[0], k)], hidden: [...hidden, null] }, true);
  }

  /** The layouts of the state by the number of points; a form of one's own has one only. */
  get layouts() {
    return this.model.states[this.settings.state].layouts;
  }

  /** With as many points as the state may have. */
  fitted(asked) {
    const { layouts, samples } = this.model.states[asked.state];
    if (samples && asked.duration > samples.until) {
      const { settings, why } = this.fitted({ ...asked, duration: samples.times.at(-1) });
      return { settings, why: `${why} The samples of your motion end at ${readable(samples.times.at(-1))} s.`.trim() };
    }
    if (layouts[asked.points.length - 1]) return { settings: asked, why: "" };
    const count = layouts.findIndex(Boolean) + 1;
    const points = Array.from({ length: count }, (_, k) => asked.points[k] ?? placeBeside(asked.points[0], k));
    const settings = { ...asked, points, hidden: points.map((_, k) => asked.hidden[k] ?? null), motion: "" };
    return { settings, why: `Your own form has ${count} point${count === 1 ? "" : "s"}.` };
  }

  clash({ points, hidden, state, motion }) {
    if (hidden.length !== points.length) {
      return `There are ${points.length} points, and ${hidden.length} are said to be hidden or not.`;
    }
    if (hidden.some((times) => times && !(times[0] < times[1]))) {
      return "A point is hidden until after the time from which it is hidden.";
    }
    return state === "own" && motion.trim() ? "Your own form has a motion of its own, and none can be given." : "";
  }

  removePoint(k) {
    const { points, hidden } = this.settings;
    if (points.length === 1 || k >= points.length || !this.layouts[points.length - 2]) return;
    this.change({ points: points.toSpliced(k, 1), hidden: hidden.toSpliced(k, 1) }, true);
  }

  someTime() {
    const { duration } = this.settings;
    return [0.2, 0.5].map((part) => Number((part * duration).toFixed(1)));
  }

  hide(k, times, chosen = true) {
    this.change({ hidden: this.settings.hidden.with(k, times) }, chosen);
  }

  /** Let nothing turn and nothing move but the first point, along its ray. */
  aim() {
    const [first] = this.settings.points;
    const length = Math.hypot(...first) || 1;
    const camera_velocity = first.map((value) => Number(((-0.2 * value) / length).toPrecision(9)));
    this.changeAndSay("Along the ray of point 1", { turning: 0, input: 0, camera_velocity });
  }

  // What is shown.

  /** The guaranteed rate of decay, if Python has told it of what is shown. */
  guaranteed() {
    return this.answered()?.bound ?? null;
  }

  verdicts() {
    return [
      { title: "Error", text: verdict(this.shown, this.model) },
      { title: "Decay", text: decayInWords(this.shown, this.guaranteed()) },
    ];
  }
}
