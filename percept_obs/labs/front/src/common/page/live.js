// What every lab does: settings in, pictures and words out, once a frame and for the latest settings only.

import { same, settingsAfter } from "../model/settings.js";
import { State } from "../model/state.js";
import { linearScale } from "../model/scales.js";
import { readingAt, summaryOf, verdict } from "../model/words.js";
import { themeOf } from "./canvas.js";
import { chartInWords } from "./chart_parts.js";
import { Link } from "./link.js";

const REST = 150;
const BETWEEN_WORDS = 250;

/**
 * A lab that follows the hand and tells Python when the hand rests.  A lab of its own gives it `kernels`, `results`,
 * `planes`, `charts`, `formulas` and `panel` before follow(), and says in methods of its own:
 *   chartOf(name)   the parts of a time chart
 *   reasons()       why it happened, in sentences
 *   copy()          the Python text of what is shown
 */
export class Live {
  constructor(widget, schema) {
    this.widget = widget;
    this.model = widget.get("model");
    this.schema = schema;
    this.state = new State(structuredClone(widget.get("settings")));
    this.width = 800;
    this.serial = 0;
    this.pictures = 0;
    this.spoken = 0;
    this.answer = null;
    this.drawn = {};
  }

  get settings() {
    return this.state.settings;
  }

  get figures() {
    return [...this.planes, ...Object.values(this.charts)];
  }

  /** Begin to follow, once the page is built: the hand, the page's size and theme, Python. */
  follow(view) {
    this.view = view;
    this.link = new Link(this.widget, {
      onSettings: (settings) => same(settings, this.settings) || this.replace(settings),
      onAnalysis: (analysis, settings) => this.analysed({ ...analysis, settings }),
      onError: (text) => this.view.pythonError(text),
      onSilence: (silence) => this.view.silence(silence),
      onPart: (part, value) => this.arrived(part, value),
      onUnprinted: () => this.schedule(),
    });
    this.observeSurroundings();
    this.panel.show();
    this.schedule();
    this.rest();
  }

  observeSurroundings() {
    this.sized = new ResizeObserver((entries) => {
      for (const { target, contentRect } of entries) {
        const picture = this.figures.find(({ figure }) => figure === target);
        if (picture) picture.size = { width: contentRect.width, height: contentRect.height };
        else this.width = contentRect.width;
      }
      this.schedule();
    });
    for (const { figure } of this.figures) this.sized.observe(figure);
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

  // What the hand does.

  /** Take changed settings; what is chosen rather than moved is a step of its own, and told to Python at once. */
  change(changes, chosen = false) {
    if (chosen) this.state.step({ settings: { ...this.settings, ...changes } });
    else this.state.move(changes);
    this.touched(chosen);
  }

  /** Take whole settings, which Python has set. */
  replace(settings) {
    this.state.step({ settings: structuredClone(settings) });
    this.touched(true);
  }

  touched(chosen) {
    this.schedule();
    if (!chosen) {
      clearTimeout(this.resting);
      this.resting = setTimeout(() => this.settle(), REST);
      return undefined;
    }
    this.view.notice("");
    this.state.amend(this.fitted(this.settings));
    // What a choice hides must be gone before the next event can reach it.
    this.panel.show();
    this.view.preset();
    return this.rest();
  }

  ask(name) {
    this.state.ask(name);
    this.view.preset();
  }

  act(act, number) {
    this.state.act(number, this.afterAct(act));
    this.touched(true);
  }

  goBack() {
    this.state.leave();
    this.touched(true);
  }

  reset() {
    this.state.reset(structuredClone(this.model.opening));
    this.touched(true);
  }

  undo() {
    if (this.state.undo()) this.touched(true);
  }

  redo() {
    if (this.state.redo()) this.touched(true);
  }

  keep() {
    this.change({ kept: this.settings.kept ? null : { ...structuredClone(this.settings), kept: null } }, true);
  }

  point(cursor) {
    if (cursor === this.state.cursor || this.shown?.problem) return;
    this.state.cursor = cursor;
    this.spoken = 0;
    this.schedule();
  }

  // What is there to show it with.

  /** The settings that a preset's act shows. */
  afterAct(act) {
    return settingsAfter(act, this.model.standard);
  }

  /** What is shown, and what is kept to compare with. */
  wanted(settings) {
    return settings.kept ? [settings, settings.kept] : [settings];
  }

  /** A promise of all that these settings need. */
  prepare(settings) {
    return Promise.all(this.wanted(settings).map((s) => this.kernels.prepare(s)));
  }

  /** How much of what follows is there, for those who have to wait. */
  progress() {
    return { done: this.kernels.whole.size, of: this.widget.get("parts").length, reason: this.widget.get("unprinted") };
  }

  allows(observer, gain, value) {
    return this.kernels.allows(observer, gain, value);
  }

  /** The settings, or those that take their place where they are impossible. */
  fitted(settings) {
    return settings;
  }

  /** Take a part of the model that Python hands over after opening. */
  arrived(part, value) {
    this.kernels.arrive(part, value);
    if (!this.link) return;
    this.panel.shownFor = null;
    this.state.amend(this.fitted(this.settings));
    this.panel.show();
    if (this.shown?.settings !== this.settings) this.settle();
  }

  /** The hand lets go. */
  rest() {
    this.state.release();
    return this.settle();
  }

  /** Settings stay as they are for a while: tell Python, and those who listen. */
  async settle() {
    clearTimeout(this.resting);
    this.resting = null;
    if (this.pending) this.paint();
    const { settings } = this;
    try {
      await this.prepare(settings);
    } catch (error) {
      this.fail(error);
      return;
    }
    if (this.closed || settings !== this.settings) return;
    if (this.pending || this.shown?.settings !== settings) this.paint();
    if (this.shown?.settings !== settings) return;
    this.speakNow();
    this.link.send(settings, this.summary(++this.serial));
    this.describe();
    this.view.rested();
  }

  schedule() {
    if (this.pending || this.closed) return;
    this.pending = true;
    this.frame = requestAnimationFrame(() => this.pending && this.paint());
  }

  /** Draw what is shown of the settings, which is computed only when they have changed. */
  paint() {
    this.pending = false;
    cancelAnimationFrame(this.frame);
    const { settings } = this;
    if (!this.wanted(settings).every((s) => this.kernels.of(s))) {
      this.wait(settings);
      return;
    }
    this.view.waiting(null);
    // Nobody reads sixty texts a second, and the page would lay itself out for each of them.
    const speaking = performance.now() - this.spoken > BETWEEN_WORDS;
    try {
      Object.assign(this, this.results.of(settings, speaking));
      this.theme ??= themeOf(this.view.root);
      this.draw();
      this.pictures += 1;
      if (speaking) this.speakNow();
    } catch (error) {
      this.fail(error);
    }
  }

  wait(settings) {
    this.view.waiting(this.progress());
    if (this.awaited === settings) return;
    this.awaited = settings;
    this.prepare(settings).then(
      () => this.awaited === settings && this.schedule(),
      (error) => this.fail(error),
    );
  }

  // What is shown.

  /** Names of the time charts that are shown. */
  chosen() {
    const { problem, settings } = this.shown;
    return problem ? [] : this.model.pictures.filter((name) => settings.pictures.includes(name));
  }

  draw() {
    const { shown, ghost, theme } = this;
    if (shown.problem || shown.refusal) this.state.cursor = null;
    const { cursor } = this.state;
    for (const plane of this.planes) plane.draw(shown, ghost, cursor, theme);
    this.view.answered(this.answered());
    const chosen = this.chosen();
    for (const [name, chart] of Object.entries(this.charts)) chart.figure.hidden = !chosen.includes(name);
    this.drawn = Object.fromEntries(chosen.map((name) => [name, this.chartOf(name)]));
    if (!chosen.length) return;
    // The asked duration, though the point may leave earlier: an axis that stays is easier to read while dragging.
    const recorded = shown.settings.scenario in (this.model.recordings ?? {});
    const [low, high] = [shown.time[0], recorded ? shown.time.at(-1) : shown.settings.duration];
    const span = { low, high, ticks: linearScale(low, high, this.width < 600 ? 4 : 8).ticks };
    for (const [name, chart] of Object.entries(this.drawn)) {
      this.charts[name].draw({ ...chart, span, cursor, theme, last: name === chosen.at(-1) });
    }
  }

  /** Bring words and controls to what is drawn. */
  speakNow() {
    this.spoken = performance.now();
    Object.assign(this, this.results.of(this.shown.settings, true));
    this.view.problem("");
    this.panel.show();
    this.view.steps(this.state);
    this.speak();
  }

  speak() {
    const { shown } = this;
    const { cursor } = this.state;
    this.view.words({
      verdicts: this.verdicts(),
      reasons: this.reasons(),
      reading: cursor === null || shown.problem ? "" : this.readingAt(cursor),
      problem: shown.problem ?? (shown.refusal || undefined),
      legend: [...this.legend(), ...(shown.settings.kept ? [["kept", "kept run"]] : [])],
    });
  }

  /** What happened, beside the lines that it happened to. */
  verdicts() {
    const { shown, model } = this;
    return shown.runs.map((run) => ({ which: run.order, title: run.title, text: verdict(run, shown, model) }));
  }

  readingAt(cursor) {
    return readingAt(this.shown, cursor);
  }

  /** Lines with their names. */
  legend() {
    const { truth, runs } = this.shown;
    return [...(truth ? [["truth", "truth"]] : []), ...runs.map(({ order, title }) => [order, title])];
  }

  describe() {
    for (const plane of this.planes) plane.describe(this.shown);
    for (const [name, chart] of Object.entries(this.drawn)) this.charts[name].describe(chartInWords(chart));
    this.formulas.show(this.shown.settings);
  }

  summary(serial) {
    return summaryOf(this.shown, serial, this.model);
  }

  // What Python adds.

  /** Take what Python has found out about settings. */
  analysed(answer) {
    this.answer = answer;
    this.view.analysis((answer.sentences ?? []).filter(Boolean));
    this.schedule();
  }

  /** Python's answer, if it is about what is shown. */
  answered() {
    return this.answer?.settings === this.shown?.settings ? this.answer : null;
  }

  say(text) {
    this.view.say(text);
  }

  fail(error) {
    this.view.problem(error.message);
  }
}
