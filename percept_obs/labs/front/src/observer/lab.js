// The observer lab: a camera, a moving point, and observers that recover its distance.

import { chartInWords } from "../common/chart_parts.js";
import { TimeChart } from "../common/charts.js";
import { ImagePlane } from "../common/image_plane.js";
import { same } from "../common/equal.js";
import { build } from "../common/layout.js";
import { Live } from "../common/live.js";
import { linearScale } from "../common/scales.js";
import { readingAt, summaryOf, verdict } from "../common/words.js";
import { pythonOf } from "./code.js";
import { Engine, translationTowards } from "./engine.js";
import { Formulas } from "./formula.js";
import { Kernels } from "./kernels.js";
import { Panel } from "./panel.js";
import { chartOf, LABELS } from "./pictures.js";
import { PRESETS, settingsOf } from "./presets.js";
import { imagePlaneInWords, reasons } from "./text.js";

const ALWAYS_POSSIBLE = "identifier_based";

export class ObserverLab extends Live {
  constructor(widget, place, model) {
    super(widget, model);
    this.kernels = new Kernels(this.model);
    this.engine = new Engine(this.model);
    this.ghostEngine = new Engine(this.model);
    this.plane = new ImagePlane({
      name: "foe",
      label: "Focus of expansion",
      tag: "FOE",
      placeOf: (shown) => shown.foe,
      onMove: (foe) => this.moveFoe(foe),
      onRest: () => this.rest(),
    });
    this.charts = Object.fromEntries(this.model.pictures.map((name) => [name, new TimeChart(name, LABELS[name])]));
    this.figures = [this.plane, ...Object.values(this.charts)];
    this.formulas = new Formulas(this.model);
    this.panel = new Panel(this.model, this);
    this.view = build(this, place, PRESETS);
    this.open();
  }

  // What the hand does.

  moveFoe(place) {
    const kernels = this.kernels.of(this.settings);
    if (!kernels || this.settings.scenario in this.model.recordings) return;
    const b = translationTowards(place, this.settings, kernels);
    if (b.every((value) => Math.abs(value) <= 1000)) this.change({ b });
  }

  chooseScenario(name) {
    const { title: _title, ...fit } = this.model.scenarios[name] ?? {};
    const track = this.model.recordings[name];
    if (!track) return this.change({ scenario: name, ...fit }, true);
    const { surface, outputs, duration, window } = track;
    const hold = this.settings.hold === "exact" ? "zero" : this.settings.hold;
    return this.change({ scenario: name, surface, outputs, duration, window, hold, believed: null }, true);
  }

  afterAct(act) {
    return settingsOf(act, this.model.standard);
  }

  copy() {
    return pythonOf(this.shown, this.model);
  }

  // What is there to show it with.

  fitted(asked) {
    const { outputs } = this.model.surfaces[asked.surface];
    const allowed = outputs.some((names) => same(names, asked.outputs));
    const settings = allowed ? asked : { ...asked, outputs: outputs[0] };
    if (!allowed) this.view.notice(`The ${asked.surface} surface needs ${outputs[0].join(" and ")} to be measured.`);
    const refused = this.kernels.refused(settings);
    const lost = settings.observers.filter((name) => refused[name]);
    if (!lost.length) return settings;
    const left = settings.observers.filter((name) => !refused[name]);
    const why = lost.map((name) => `The ${this.model.observers[name].title} observer was dropped: ${refused[name]}.`);
    this.view.notice(why.join(" "));
    return { ...settings, observers: left.length ? left : [ALWAYS_POSSIBLE] };
  }

  // What is shown.

  show(settings) {
    const { kept } = settings;
    if (kept && this.keptGhost?.settings !== kept) this.keptGhost = this.ghostEngine.run(kept, this.kernels.of(kept));
    this.ghost = kept && !this.keptGhost.problem ? this.keptGhost : null;
    return this.engine.run(settings, this.kernels.of(settings));
  }

  draw() {
    const { shown, ghost, cursor, theme } = this;
    this.plane.draw(shown, ghost, cursor, theme);
    this.drawn = {};
    if (shown.problem) this.cursor = null;
    const chosen = this.model.pictures.filter((name) => shown.settings.pictures.includes(name));
    for (const [name, chart] of Object.entries(this.charts)) chart.figure.hidden = !chosen.includes(name);
    if (shown.problem) return;
    // The asked duration, though the point may leave earlier: an axis that stays is easier to read while dragging.
    const recorded = shown.settings.scenario in this.model.recordings;
    const span = { low: shown.time[0], high: recorded ? shown.time.at(-1) : shown.settings.duration };
    span.ticks = linearScale(span.low, span.high, this.width < 600 ? 4 : 8).ticks;
    for (const name of chosen) {
      const chart = chartOf(name, shown, ghost, theme);
      this.drawn[name] = chart;
      this.charts[name].draw({ ...chart, span, cursor, theme, last: name === chosen.at(-1) });
    }
  }

  speak() {
    const { shown, cursor, model } = this;
    this.view.words({
      verdicts: shown.runs.map((run) => ({ which: run.order, title: run.title, text: verdict(run, shown, model) })),
      reasons: reasons(shown),
      reading: cursor === null || shown.problem ? "" : readingAt(shown, cursor),
      problem: shown.problem,
      legend: [
        ...(shown.truth ? [["truth", "truth"]] : []),
        ...shown.runs.map(({ order, title }) => [order, title]),
        ...(shown.settings.kept ? [["kept", "kept run"]] : []),
      ],
    });
  }

  describe() {
    this.plane.describe(imagePlaneInWords(this.shown));
    for (const [name, chart] of Object.entries(this.drawn)) this.charts[name].describe(chartInWords(chart));
    this.formulas.show(this.shown.settings);
  }

  summary(serial) {
    return summaryOf(this.shown, serial, this.model);
  }
}
