// The lab of structure and motion: what is known, what can therefore be estimated, and how the estimates converge.

import { settingsAfter } from "../common/acts.js";
import { chartInWords } from "../common/chart_parts.js";
import { TimeChart } from "../common/charts.js";
import { ImagePlane } from "../common/image_plane.js";
import { build } from "../common/layout.js";
import { Live } from "../common/live.js";
import { linearScale } from "../common/scales.js";
import { summaryOf, verdict } from "../common/words.js";
import { ChoiceOfUnknowns } from "./choice.js";
import { pythonOf } from "./code.js";
import { StructureEngine } from "./engine.js";
import { StructureFormulas } from "./formula.js";
import { StructureKernels } from "./kernels.js";
import { StructurePanel } from "./panel.js";
import { chartOf, chartsOf, LABELS } from "./pictures.js";
import { PRESETS } from "./presets.js";
import { Scene } from "./scene.js";
import { imagePlaneInWords, readingAt, reasons, sceneInWords } from "./text.js";

export class StructureLab extends Live {
  constructor(widget, place, model) {
    super(widget, model);
    this.kernels = new StructureKernels(this.model);
    this.engine = new StructureEngine(this.model);
    this.ghostEngine = new StructureEngine(this.model);
    this.plane = new ImagePlane({
      name: "ybar",
      label: "Start of the point",
      tag: "start",
      placeOf: (shown) => shown.settings.ybar.slice(0, 2),
      onMove: (point) => this.moveStart(point),
      onRest: () => this.rest(),
    });
    this.scene = new Scene();
    this.planes = [this.plane, this.scene];
    this.charts = Object.fromEntries(Object.entries(LABELS).map(([name, label]) => [name, new TimeChart(name, label)]));
    this.figures = [...this.planes, ...Object.values(this.charts)];
    this.formulas = new StructureFormulas(this.model);
    this.panel = new StructurePanel(this.model, this);
    this.choice = new ChoiceOfUnknowns(this.model, this);
    this.head = this.choice.body;
    this.view = build(this, place, PRESETS);
    this.open();
  }

  // What the hand does.

  moveStart([y1, y2]) {
    if (Math.abs(y1) <= 1000 && Math.abs(y2) <= 1000) this.change({ ybar: [y1, y2, this.settings.ybar[2]] });
  }

  afterAct(act) {
    return settingsAfter(act, this.model.standard);
  }

  copy() {
    return pythonOf(this.shown, this.model);
  }

  // What is shown.

  show(settings) {
    const { kept } = settings;
    const run = (engine, s) => engine.run(s, this.kernels.of(s), this.kernels.refusal(s));
    if (kept && this.keptGhost?.settings !== kept) this.keptGhost = run(this.ghostEngine, kept);
    this.ghost = kept && !this.keptGhost.problem && !this.keptGhost.refusal ? this.keptGhost : null;
    return run(this.engine, settings);
  }

  draw() {
    const { shown, ghost, cursor, theme } = this;
    this.plane.draw(shown, ghost, cursor, theme);
    this.scene.draw(shown, ghost, cursor, theme);
    this.drawn = {};
    if (shown.problem || shown.refusal) this.cursor = null;
    const chosen = chartsOf(shown);
    for (const [name, chart] of Object.entries(this.charts)) chart.figure.hidden = !chosen.includes(name);
    // The asked duration, though the point may leave earlier: an axis that stays is easier to read while dragging.
    const span = { low: 0, high: shown.settings.duration };
    span.ticks = linearScale(span.low, span.high, this.width < 600 ? 4 : 8).ticks;
    for (const name of chosen) {
      const chart = chartOf(name, shown, ghost, theme);
      this.drawn[name] = chart;
      this.charts[name].draw({ ...chart, span, cursor, theme, last: name === chosen.at(-1) });
    }
  }

  speak() {
    const { shown, cursor, model } = this;
    this.choice.show(shown);
    this.view.words({
      verdicts: shown.runs.map((run) => ({ which: run.order, title: run.title, text: verdict(run, shown, model) })),
      reasons: reasons(shown, model),
      reading: cursor === null || shown.problem || shown.refusal ? "" : readingAt(shown, cursor),
      problem: shown.problem ?? (shown.refusal || undefined),
      legend: [
        ["truth", "truth"],
        ...shown.runs.map(({ order, title }) => [order, title]),
        ...(shown.settings.kept ? [["kept", "kept run"]] : []),
      ],
    });
  }

  describe() {
    this.plane.describe(imagePlaneInWords(this.shown));
    this.scene.describe(sceneInWords(this.shown));
    for (const [name, chart] of Object.entries(this.drawn)) this.charts[name].describe(chartInWords(chart));
    this.formulas.show(this.shown.settings);
  }

  summary(serial) {
    const { shown } = this;
    return shown.refusal ? { serial, refusal: shown.refusal } : summaryOf(shown, serial, this.model);
  }
}
