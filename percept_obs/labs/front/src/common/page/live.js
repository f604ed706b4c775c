// What every lab does: settings in, pictures and words out, once a frame and for the latest settings only.

import { Results } from "../model/results.js";
import { schemaOf } from "../model/schema.js";
import { same } from "../model/settings.js";
import { State } from "../model/state.js";
import { verdict } from "../model/words.js";
import { themeOf } from "./canvas.js";
import { build } from "./layout.js";
import { LINE } from "./lines.js";
import { Link } from "./link.js";
import { Showing } from "./showing.js";
import { surround } from "./surroundings.js";
import { TimeCharts } from "./time_charts.js";

const REST = 150;
const BETWEEN_WORDS = 250;

/**
 * A lab that follows the hand and tells Python when the hand rests.  A lab of its own gives it `planes`, `formulas` and
 * `panel` before open(), and says what is its own in these parts:
 *   Kernels, Engine             functions of settings, and what makes results of them
 *   words                       what the page calls the settings
 *   presets, settingsOf         points worth seeing, and the settings of an act
 *   labels, chartOf             labels of the time charts by their names, and the parts of one
 *   reasons, readingAt          why it happened, and values at a time, in words
 *   summaryOf, pythonOf         what Python is told of a result, and the Python text of it
 */
export class Live extends Showing {
  constructor(widget, model, { Kernels, Engine, ...parts }) {
    super(model, new State(structuredClone(widget.get("settings"))), parts);
    this.widget = widget;
    this.schema = schemaOf(model.schema, parts.words);
    this.kernels = new Kernels(this.model);
    this.results = new Results(this.kernels, () => new Engine(this.model));
    /** @type {any} */
    this.panel = this.formulas = null;
    /** @type {Record<string, any> | null} what Python has answered, with the settings that it is about */
    this.answer = null;
    /** @type {Link | null} */
    this.link = null;
    this.serial = 0;
    this.pictures = 0;
    this.spoken = 0;
    this.frame = 0;
    this.pending = this.closed = false;
    this.leave = () => {};
  }

  open(place) {
    const { labels, presets } = this.parts;
    this.time = new TimeCharts(labels);
    this.follow(build(this, place, presets));
  }

  /** Begin to follow, once the page is built: the hand, the page's size and theme, Python. */
  follow(view) {
    this.view = view;
    this.link = new Link(this.widget, {
      onSettings: (settings) => same(settings, this.settings) || this.replace(settings),
      onAnalysis: (analysis, settings) => this.analysed({ ...analysis, settings }),
      onError: (text) => this.view.pythonError(text),
      onSilence: (silence) => this.view.silence(silence),
    });
    this.leave = surround(this.view.root, {
      figures: this.figures.map(({ figure }) => figure),
      onSize: (node, size) => this.resized(node, size),
      onTheme: () => this.retheme(),
    });
    this.panel.show();
    this.schedule();
    this.rest();
  }

  close() {
    this.closed = true;
    cancelAnimationFrame(this.frame);
    clearTimeout(this.resting);
    this.link?.close();
    this.view.close();
    this.leave();
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
    if (chosen) this.choices += 1;
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
    this.state.act(number, this.parts.settingsOf(act, this.model.standard));
    this.touched(true);
  }

  goBack() {
    this.state.leave();
    this.touched(true);
  }

  reset() {
    this.state.reset(structuredClone(this.model.opening));
    this.time.timeline.forget();
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

  // What is there to show it with.

  /** What is shown, and what is kept to compare with. */
  wanted(settings) {
    return settings.kept ? [settings, settings.kept] : [settings];
  }

  prepare(settings) {
    return Promise.all(this.wanted(settings).map((s) => this.kernels.prepare(s)));
  }

  /** The settings, or those that take their place where they are impossible. */
  fitted(settings) {
    return settings;
  }

  rest() {
    this.state.release();
    return this.settle();
  }

  /** Settings stay as they are for a while: tell Python, and those who listen. */
  async settle() {
    clearTimeout(this.resting);
    this.resting = null;
    if (this.theme && this.theme.width !== LINE) this.schedule();
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
    this.link?.send(settings, this.parts.summaryOf(this.shown, ++this.serial, this.model));
    this.describe();
    this.view.rested();
  }

  /** Draw what was computed, at another time or from elsewhere; the time charts only if they have changed. */
  redraw() {
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
    // Nobody reads sixty texts a second, and the page would lay itself out for each of them.
    const speaking = this.stale && performance.now() - this.spoken > BETWEEN_WORDS;
    try {
      Object.assign(this, this.results.of(settings, speaking));
      this.theme ??= { ...themeOf(this.view.root), picked: null };
      this.draw();
      this.pictures += 1;
      if (speaking) this.speakNow();
    } catch (error) {
      this.fail(error);
    }
  }

  wait(settings) {
    if (this.awaited === settings) return;
    this.awaited = settings;
    this.prepare(settings).then(
      () => this.awaited === settings && this.schedule(),
      (error) => this.fail(error),
    );
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
    const { shown, model, parts } = this;
    this.view.words({
      verdicts: this.verdicts(),
      reasons: parts.reasons(shown, model),
      problem: shown.problem ?? (shown.refusal || undefined),
      legend: [...this.legend(), ...(shown.settings.kept ? [["kept", "kept run"]] : [])],
    });
  }

  /** What happened, beside the lines that it happened to. */
  verdicts() {
    const { shown, model } = this;
    return shown.runs.map((run) => ({ which: run.order, title: run.title, text: verdict(run, shown, model) }));
  }

  copy() {
    return this.parts.pythonOf(this.shown, this.model);
  }

  legend() {
    const { truth, runs, problem } = this.shown;
    if (problem) return [];
    return [...(truth ? [["truth", "truth"]] : []), ...runs.map(({ order, title }) => [order, title])];
  }

  describe() {
    for (const plane of this.planes) plane.describe(this.shown);
    this.time.describe();
    this.formulas.show(this.shown.settings);
  }

  // What Python adds.

  /** Take what Python has found out about settings. */
  analysed(answer) {
    this.answer = answer;
    this.view.analysis((answer.sentences ?? []).filter(Boolean));
    // What is said of it is said with the next picture, however short the last words are ago.
    this.spoken = 0;
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
