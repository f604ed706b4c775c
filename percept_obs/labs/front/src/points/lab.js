// The lab of many points: points of one state before a moving camera, and an observer that follows them.

import { chartInWords } from "../common/chart_parts.js";
import { TimeChart } from "../common/charts.js";
import { build } from "../common/layout.js";
import { Live } from "../common/live.js";
import { linearScale } from "../common/scales.js";
import { pythonOf } from "./code.js";
import { Engine } from "./engine.js";
import { Formulas } from "./formula.js";
import { Functions } from "./functions.js";
import { ImagePlane } from "./image_plane.js";
import { Panel } from "./panel.js";
import { chartOf, LABELS } from "./pictures.js";
import { PRESETS, settingsOf } from "./presets.js";
import { decayInWords, imagePlaneInWords, readingAt, reasons, summaryOf, verdict } from "./text.js";

const FARTHEST = 1000;

export class PointsLab extends Live {
  constructor(widget, place, model) {
    super(widget, model);
    this.kernels = new Functions(this.model);
    this.engine = new Engine(this.model);
    this.ghostEngine = new Engine(this.model);
    this.bound = { of: null, rate: null };
    this.plane = new ImagePlane(this, this.model.mostPoints);
    this.charts = Object.fromEntries(this.model.pictures.map((name) => [name, new TimeChart(name, LABELS[name])]));
    this.figures = [this.plane, ...Object.values(this.charts)];
    this.formulas = new Formulas(this.model);
    this.panel = new Panel(this.model, this);
    this.view = build(this, place, PRESETS);
    this.open();
  }

  // What the hand does.

  depthOf(k) {
    const { l } = this.model.block;
    return this.settings.points[k].reduce((sum, value, i) => sum + l[i] * value, 0);
  }

  put(k, place) {
    if (!place.every((value) => Math.abs(value) <= FARTHEST)) return;
    this.change({ points: this.settings.points.map((old, i) => (i === k ? place : old)) });
  }

  /** Move a point in the image, with its depth kept. */
  movePoint(k, [y1, y2]) {
    const functions = this.kernels.of(this.settings);
    if (k >= this.settings.points.length || !functions) return;
    this.put(k, Array.from(functions.locate([y1, y2, this.depthOf(k)], new Float64Array(3))));
  }

  /** Move a point along its ray. */
  moveDepth(k, depth) {
    const now = this.depthOf(k);
    const [x, y, z] = this.settings.points[k];
    if (depth > 0) this.put(k, now > 0 ? [x, y, z].map((value) => (value * depth) / now) : [x, y, depth]);
  }

  addPoint() {
    const { points, hidden } = this.settings;
    const k = points.length;
    if (k === this.model.mostPoints) return;
    const [x, y, z] = points[0];
    const round = (value) => Number(value.toFixed(2));
    const place = [x + 0.5 * Math.cos(2.4 * k), y + 0.4 * Math.sin(2.4 * k), Math.max(z, 1) + 0.1 * k].map(round);
    this.change({ points: [...points, place], hidden: [...hidden, null] }, true);
  }

  removePoint(k) {
    const { points, hidden } = this.settings;
    if (points.length === 1 || k >= points.length) return;
    const others = (list) => list.filter((_, i) => i !== k);
    this.change({ points: others(points), hidden: others(hidden) }, true);
  }

  /** A span in which a point may be hidden. */
  someTime() {
    const { duration } = this.settings;
    return [0.2, 0.5].map((part) => Number((part * duration).toFixed(1)));
  }

  hide(k, times, chosen = true) {
    this.change({ hidden: this.settings.hidden.map((old, i) => (i === k ? times : old)) }, chosen);
  }

  /** Let nothing turn and nothing move but the first point, along its ray. */
  aim() {
    const [first] = this.settings.points;
    const length = Math.hypot(...first) || 1;
    const velocity = first.map((value) => Number(((0.2 * value) / length).toPrecision(9)));
    this.change({ turning: 0, input: 0, velocity }, true);
  }

  afterAct(act) {
    return settingsOf(act, this.model.standard);
  }

  copy() {
    return pythonOf(this.shown, this.model);
  }

  // What is shown.

  show(settings) {
    const { kept } = settings;
    if (kept && this.ghost?.settings !== kept) this.ghost = this.ghostEngine.run(kept, this.kernels.of(kept));
    if (!kept) this.ghost = null;
    return this.engine.run(settings, this.kernels.of(settings));
  }

  /** The guaranteed rate of decay, if Python has told it of what is shown. */
  guaranteed() {
    return this.bound.of === this.shown.settings ? this.bound.rate : null;
  }

  draw() {
    const { shown, ghost, cursor, theme } = this;
    this.plane.draw(shown, ghost, cursor, theme);
    this.drawn = {};
    const chosen = this.model.pictures.filter((name) => shown.settings.pictures.includes(name));
    for (const [name, chart] of Object.entries(this.charts)) chart.figure.hidden = !chosen.includes(name);
    const span = { low: 0, high: shown.settings.duration };
    span.ticks = linearScale(span.low, span.high, this.width < 600 ? 4 : 8).ticks;
    const more = { bound: this.guaranteed(), unseen: this.model.unseen };
    for (const name of chosen) {
      const chart = chartOf(name, shown, ghost, theme, more);
      this.drawn[name] = chart;
      this.charts[name].draw({ ...chart, span, cursor, theme, last: name === chosen.at(-1) });
    }
  }

  speak() {
    const { shown, cursor, model } = this;
    const points = Array.from({ length: shown.points }, (_, k) => [k, `point ${k + 1}`]);
    this.view.words({
      verdicts: [
        { which: "truth", title: "Error", text: verdict(shown, model) },
        { which: "fit", title: "Decay", text: decayInWords(shown, this.guaranteed()) },
      ],
      reasons: reasons(shown, model),
      reading: cursor === null ? "" : readingAt(shown, cursor),
      legend: [
        ...points,
        ...(this.guaranteed() === null ? [] : [["bound", "guaranteed"]]),
        ...(shown.settings.kept ? [["kept", "kept run"]] : []),
      ],
    });
  }

  describe() {
    this.plane.describe(imagePlaneInWords(this.shown), this.shown);
    for (const [name, chart] of Object.entries(this.drawn)) this.charts[name].describe(chartInWords(chart));
    this.formulas.show(this.shown.settings);
  }

  summary(serial) {
    return summaryOf(this.shown, serial, this.model);
  }

  analysed(analysis) {
    super.analysed(analysis);
    this.bound = { of: this.settings, rate: analysis.bound ?? null };
    this.schedule();
  }
}
