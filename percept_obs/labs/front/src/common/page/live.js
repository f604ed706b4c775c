// What every lab does: settings in, pictures and words out, once a frame and for the latest settings only.

import { Latest } from "../model/latest.js";
import { Results } from "../model/results.js";
import { changesInWords, same } from "../model/settings.js";
import { readOf } from "../model/typed.js";
import { verdict } from "../model/words.js";
import { Address } from "./address.js";
import { openBeside } from "./beside.js";
import { themeOf } from "./canvas.js";
import { build } from "./layout.js";
import { LINE } from "./lines.js";
import { Showing } from "./showing.js";
import { TimeCharts } from "./time_charts.js";

const REST = 150;
const BETWEEN_WORDS = 250;

/**
 * A lab that follows the hand and tells Python when the hand rests.  A lab of its own gives it `planes`, `formulas` and
 * `panel` before open(), says as `computing` which Kernels make functions of settings and which Engine makes results of
 * them, and what is its own in these parts:
 *   words                       what the page calls the settings
 *   presets, settingsOf         points worth seeing, and the settings of an act
 *   names, symbols              what settings are called in a sentence, and what letters stand for
 *   labels, chartOf             labels of the time charts by their names, and the parts of one
 *   causesOf                    settings without one cause each, in a lab that can tell some
 *   reasons, readingAt          why it happened, and values at a time, in words
 *   summaryOf, pythonOf         what Python is told of a result, and the Python text of it
 */
export class Live extends Showing {
  /** @type {{Kernels: any, Engine: any}} */
  static computing;

  constructor(widget, model, parts) {
    super(widget, model, parts);
    const { Kernels, Engine } = new.target.computing;
    this.kernels = new Kernels(this.model);
    this.makeEngine = () => new Engine(this.model);
    this.results = new Results(this.kernels, this.makeEngine);
    this.latest = new Latest(this.results, (error) => (error ? this.fail(new Error(error)) : this.schedule()));
    /** @type {Worker | null} */
    this.worker = null;
    /** @type {Address | null} its part of the page's address, where it has one */
    this.address = widget.get("address") ? new Address(this, widget.get("address")) : null;
    /** @type {any} */
    this.formulas = null;
    this.pictures = 0;
    this.spoken = 0;
    /** Whether pictures and words are of the present settings, and Python was told of them. */
    this.settled = false;
  }

  open(place) {
    const { labels, presets } = this.parts;
    this.time = new TimeCharts(labels);
    // A lab with settings of its own is about these, and not about the first question.
    if (same(this.settings, this.model.standard)) this.state.open(presets[0].name);
    this.follow(build(this, place, presets));
    this.view.preset();
    this.address?.follow();
  }

  close() {
    super.close();
    this.address?.close();
    this.view.close();
    this.worker?.terminate();
    for (const plane of this.planes) plane.close?.();
  }

  // What the hand does.

  touched(chosen) {
    this.settled = false;
    if (chosen) {
      this.choices += 1;
      this.view.notice("");
      const { settings, why } = this.fitted(this.settings);
      if (why) this.view.notice(why);
      this.state.amend(settings);
    }
    this.hire();
    // What is found beside the page is drawn when it comes.
    if (!this.latest.beside || this.compute()) this.schedule();
    if (!chosen) {
      clearTimeout(this.resting);
      this.resting = setTimeout(() => this.settle(), REST);
      return undefined;
    }
    // What a choice hides must be gone before the next event can reach it.
    this.panel.show();
    this.view.preset();
    return this.rest();
  }

  /** Take a step and say what it has changed. */
  changeAndSay(title, changes) {
    const before = this.settings;
    this.change(changes, true);
    this.view.notice(`${title}. ${changesInWords(before, this.settings, this.parts.names)}`);
  }

  /** Ask a question, over the settings that it is about. */
  ask(name) {
    const { asks } = this.parts.presets.find((preset) => preset.name === name);
    this.state.ask(name, this.parts.settingsOf({ changes: asks }, this.model.standard));
    this.touched(true);
  }

  predict(found) {
    this.state.predict(found);
    this.view.preset();
    this.view.steps(this.state);
    this.redraw();
  }

  act(act, number) {
    this.state.act(number, this.parts.settingsOf(act, this.model.standard));
    this.touched(true);
  }

  goBack() {
    this.state.leave();
    this.touched(true);
  }

  /** Show settings that somebody sent; they are about no question that is open here. */
  visit(settings) {
    this.state.step({ settings, preset: null });
    this.touched(true);
  }

  reset() {
    this.time.timeline.forget();
    super.reset();
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

  /** The settings, or those that take their place where they are impossible, and why. */
  fitted(settings) {
    return { settings, why: "" };
  }

  /** Why settings do not go together that the lab's own controls never let meet; empty if they do. */
  clash(_settings) {
    return "";
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
    try {
      while (!this.closed && settings === this.settings && !this.latest.want(settings, true)) await this.latest.next();
    } catch (error) {
      this.fail(error);
      return;
    }
    if (this.closed || settings !== this.settings) return;
    if (this.pending || this.shown?.settings !== settings) this.paint();
    if (this.shown?.settings !== settings) return;
    Object.assign(this, { shown: this.latest.shown, ghost: this.latest.ghost });
    this.speakNow();
    this.link?.send(settings, this.parts.summaryOf(this.shown, ++this.serial, this.model));
    this.address?.rested(settings);
    this.describe();
    this.view.rested();
    this.settled = true;
  }

  /** Compute beside the page, from the first touch on: at the first picture nobody waits. */
  hire() {
    const bundle = this.widget.get("_esm");
    if (this.worker || typeof Worker === "undefined") return;
    const [kind, texts, model] = ["kind", "texts", "model"].map((name) => this.widget.get(name));
    this.worker = openBeside({ bundle, kind, texts, model }, {
      onReady: ({ ask }) => {
        this.latest.beside = { ask: (task) => ask({ ...task, written: readOf(task.settings, this.model) }) };
      },
      onAnswer: (answer) => this.closed || this.latest.take(answer),
      onGone: () => this.latest.lose(),
    });
  }

  /** Nobody reads sixty texts a second, and the page would lay itself out for each of them. */
  get speaking() {
    return this.stale && performance.now() - this.spoken > BETWEEN_WORDS;
  }

  /** Find what is shown of the settings, and say whether it is there. */
  compute() {
    const { settings } = this;
    if (!this.wanted(settings).every((s) => this.kernels.of(s))) {
      this.wait(settings);
      return false;
    }
    return this.latest.want(settings, this.speaking, { ...this.span, cursor: this.state.cursor });
  }

  /** Draw the latest that was found, which is computed only when settings have changed. */
  paint() {
    this.pending = false;
    cancelAnimationFrame(this.frame);
    try {
      this.compute();
      const { shown, ghost } = this.latest;
      if (!shown) return;
      Object.assign(this, { shown, ghost });
      const speaking = this.speaking && shown.whole;
      this.theme ??= { ...themeOf(this.view.root), picked: null };
      this.draw();
      this.latest.drawn();
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
    // What is drawn may be of settings before those that cannot be shown.
    if (!this.late) this.view.problem("");
    this.panel.show();
    this.view.steps(this.state);
    this.view.preset();
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
}
