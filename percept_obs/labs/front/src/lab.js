// The observer lab: settings in, pictures and words out, once a frame, for the latest settings only.

import { chartOf, LABELS } from "./pictures.js";
import { themeOf } from "./canvas.js";
import { TimeChart } from "./charts.js";
import { pythonOf } from "./code.js";
import { same } from "./equal.js";
import { Engine, translationTowards } from "./engine.js";
import { Formulas } from "./formula.js";
import { ImagePlane } from "./image_plane.js";
import { Kernels } from "./kernels.js";
import { build } from "./layout.js";
import { Link } from "./link.js";
import { Panel } from "./panel.js";
import { PRESETS, settingsOf } from "./presets.js";
import { linearScale } from "./scales.js";
import { chartInWords, imagePlaneInWords, readingAt, reasons, summaryOf, verdict } from "./text.js";

const REST = 150;
const BETWEEN_WORDS = 250;

export class ObserverLab {
  constructor(widget, place) {
    this.widget = widget;
    this.model = widget.get("model");
    this.settings = structuredClone(widget.get("settings"));
    this.kernels = new Kernels(this.model);
    this.engine = new Engine(this.model);
    this.ghostEngine = new Engine(this.model);
    this.cursor = null;
    this.width = 800;
    this.serial = 0;
    this.before = null;
    this.pictures = 0;
    this.spoken = 0;
    this.plane = new ImagePlane(
      (foe) => this.moveFoe(foe),
      () => this.rest(),
    );
    this.charts = Object.fromEntries(this.model.pictures.map((name) => [name, new TimeChart(name, LABELS[name])]));
    this.formulas = new Formulas(this.model);
    this.panel = new Panel(this.model, this);
    this.view = build(this, place, PRESETS);
    this.link = new Link(widget, {
      onSettings: (settings) => this.adopt(settings),
      onAnalysis: ({ sentences }) => this.view.analysis((sentences ?? []).filter(Boolean)),
      onError: (text) => this.view.pythonError(text),
      onSilence: (silence) => this.view.silence(silence),
    });
    this.observeSurroundings();
    this.panel.show();
    this.schedule();
    this.rest();
    this.kernels.prepareAll().catch((error) => this.fail(error));
  }

  observeSurroundings() {
    const pictures = [this.plane, ...Object.values(this.charts)];
    this.sized = new ResizeObserver((entries) => {
      for (const { target, contentRect } of entries) {
        const picture = pictures.find(({ figure }) => figure === target);
        if (picture) picture.size = { width: contentRect.width, height: contentRect.height };
        else this.width = contentRect.width;
      }
      this.schedule();
    });
    for (const { figure } of pictures) this.sized.observe(figure);
    this.sized.observe(this.view.root);
    this.themed = new MutationObserver(() => this.retheme());
    this.themed.observe(document.body, { attributes: true, attributeFilter: ["data-jp-theme-light", "class"] });
    this.scheme = window.matchMedia("(prefers-color-scheme: dark)");
    this.onScheme = () => this.retheme();
    this.scheme.addEventListener("change", this.onScheme);
  }

  retheme() {
    this.theme = null;
    this.schedule();
  }

  close() {
    this.closed = true;
    cancelAnimationFrame(this.frame);
    clearTimeout(this.resting);
    this.link.close();
    this.sized.disconnect();
    this.themed.disconnect();
    this.scheme.removeEventListener("change", this.onScheme);
  }

  /** Take changed settings; what is chosen rather than moved is told to Python at once. */
  change(changes, chosen = false) {
    this.settings = { ...this.settings, ...changes };
    this.touched(chosen);
  }

  /** Take whole settings: of a preset, of Reset, of the way back. */
  replace(settings) {
    this.settings = structuredClone(settings);
    this.touched(true);
  }

  /** Take settings that Python has set. */
  adopt(settings) {
    if (same(settings, this.settings)) return;
    this.settings = structuredClone(settings);
    this.touched(true);
  }

  touched(chosen) {
    this.schedule();
    if (!chosen) return this.restSoon();
    // What a choice hides must be gone before the next event can reach it.
    this.panel.show();
    return this.rest();
  }

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

  allows(observer, gain, value) {
    const functions = this.kernels.groups.get(`gains of ${observer}`);
    if (!functions) return true;
    return functions[`allow_${gain}`]([value], [0])[0] === 1;
  }

  act(preset, number) {
    this.before ??= this.settings;
    const standard = { ...this.model.opening, ...this.model.scenarios.ma2005_eq35, scenario: "ma2005_eq35" };
    delete standard.title;
    this.replace(settingsOf(preset.acts[number], { ...standard, believed: null, surface: "pinhole" }));
  }

  goBack() {
    if (this.before) this.replace(this.before);
    this.before = null;
  }

  keep() {
    this.change({ kept: this.settings.kept ? null : { ...structuredClone(this.settings), kept: null } }, true);
  }

  reset() {
    this.before = null;
    this.cursor = null;
    this.view.forgetPreset();
    this.replace(this.model.opening);
  }

  copy() {
    return pythonOf(this.shown, this.model);
  }

  point(cursor) {
    if (cursor === this.cursor || this.shown?.problem) return;
    this.cursor = cursor;
    this.spoken = 0;
    this.schedule();
  }

  restSoon() {
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.rest(), REST);
  }

  /** The hand rests: tell Python, and those who listen. */
  async rest() {
    clearTimeout(this.resting);
    this.resting = null;
    if (this.pending) this.paint();
    const { settings } = this;
    try {
      await this.kernels.prepare(settings);
    } catch (error) {
      this.fail(error);
      return;
    }
    if (this.closed || settings !== this.settings) return;
    if (this.pending || this.shown?.settings !== settings) this.paint();
    if (!this.shown) return;
    this.speak();
    this.link.send(settings, summaryOf(this.shown, ++this.serial));
    this.describe();
    this.formulas.show(settings);
    this.view.rested(this);
  }

  schedule() {
    if (this.pending || this.closed) return;
    this.pending = true;
    this.frame = requestAnimationFrame(() => this.pending && this.paint());
  }

  paint() {
    this.pending = false;
    cancelAnimationFrame(this.frame);
    const { settings } = this;
    const wanted = [settings, ...(settings.kept ? [settings.kept] : [])];
    const [kernels, ghostKernels] = wanted.map((s) => this.kernels.of(s));
    if (!kernels || (settings.kept && !ghostKernels)) {
      Promise.all(wanted.map((s) => this.kernels.prepare(s))).then(
        () => this.schedule(),
        (error) => this.fail(error),
      );
      return;
    }
    try {
      this.shown = this.engine.run(settings, kernels);
      this.ghost = settings.kept ? this.ghostOf(settings.kept, ghostKernels) : null;
      this.draw();
    } catch (error) {
      this.fail(error);
    }
  }

  ghostOf(kept, kernels) {
    if (this.keptGhost?.settings !== kept) this.keptGhost = this.ghostEngine.run(kept, kernels);
    return this.keptGhost.problem ? null : this.keptGhost;
  }

  draw() {
    const { shown, ghost, cursor } = this;
    this.theme ??= themeOf(this.view.root);
    this.plane.draw(shown, ghost, cursor, this.theme);
    this.drawn = {};
    if (shown.problem) this.cursor = null;
    const chosen = this.model.pictures.filter((name) => shown.settings.pictures.includes(name));
    for (const [name, chart] of Object.entries(this.charts)) chart.figure.hidden = !chosen.includes(name);
    if (!shown.problem) {
      // The asked duration, though the point may leave earlier: an axis that stays is easier to read while dragging.
      const recorded = shown.settings.scenario in this.model.recordings;
      const span = { low: shown.time[0], high: recorded ? shown.time.at(-1) : shown.settings.duration };
      span.ticks = linearScale(span.low, span.high, this.width < 600 ? 4 : 8).ticks;
      for (const name of chosen) {
        const chart = chartOf(name, shown, ghost, this.theme);
        this.drawn[name] = chart;
        const last = name === chosen.at(-1);
        this.charts[name].draw({ ...chart, span, cursor, theme: this.theme, last });
      }
    }
    this.pictures += 1;
    // Nobody reads sixty texts a second, and the page would lay itself out for each of them.
    if (performance.now() - this.spoken > BETWEEN_WORDS) this.speak();
  }

  /** Bring words and controls to what is drawn. */
  speak() {
    const { shown, cursor } = this;
    this.spoken = performance.now();
    this.view.problem("");
    this.panel.show();
    this.view.words({
      verdicts: shown.runs.map((run) => [run, verdict(run, shown)]),
      reasons: reasons(shown),
      reading: cursor === null || shown.problem ? "" : readingAt(shown, cursor),
    });
    this.view.controls(this);
  }

  describe() {
    this.plane.describe(imagePlaneInWords(this.shown));
    for (const [name, chart] of Object.entries(this.drawn)) this.charts[name].describe(chartInWords(chart));
  }

  say(text) {
    this.view.say(text);
  }

  fail(error) {
    this.view.problem(error.message);
  }
}
