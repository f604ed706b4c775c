// A lab: settings in, pictures and words out, once a frame and for the latest settings only.

import { within } from "../engine/between.js";
import { Latest } from "../engine/latest.js";
import { Results } from "../engine/results.js";
import { readOf } from "../engine/typed.js";
import { themeOf } from "../draw/canvas.js";
import { element, listen } from "../draw/dom.js";
import { roundStep } from "../draw/scales.js";
import { changesInWords } from "../state/settings.js";
import { Address } from "./address.js";
import { Drawer } from "./drawer.js";
import { LabBase } from "./lab_base.js";
import { keys, messagesOf } from "./messages.js";
import { openWorker } from "./worker.js";
import { verdict } from "./words.js";

/** Milliseconds after which a hand that has stopped has come to rest, and a zoom that goes on is another step. */
const [REST, ZOOM_REST] = [150, 400];
/** Milliseconds between texts: nobody reads sixty a second, and each makes the page lay itself out. */
const BETWEEN_TEXTS = 250;
/** No part of the time in sight is thinner than this part of the whole. */
const THINNEST = 1e-4;
/** Seconds from which on a run is long; it opens on its beginning where all observers settle within this part. */
const [LONG, EARLY] = [10, 0.1];
/** Settling times that this first part has. */
const SETTLINGS = 4;
/** Elements that use the space bar themselves. */
const OWN_SPACE = "input, select, button, summary, a";
const NULL = /** @type {any} */ (null);

/**
 * A lab that follows the hand and tells Python when the hand rests.  A lab of its own sets `formulas`, `screen` and
 * `panel` before open(), names in `computing` the Kernels that make functions of settings and the Engine that makes
 * results of them, and gives these parts:
 *   words                       what the page calls the settings
 *   names, symbols              what settings are called in a sentence, and what letters stand for
 *   charts, chartOf             titles of the charts below the first by their names, and the parts of one
 *   reasons                     why it happened, in words
 *   summaryOf, pythonOf         what Python is told of a result, and the Python text of it
 */
export class Lab extends LabBase {
  /** @type {{Kernels: any, Engine: any}} */
  static computing;
  /** @type {import("./screen.js").Screen} */
  screen = NULL;
  drawer = NULL;
  formulas = NULL;
  /** Result of the kept run. */
  ghost = NULL;
  /** Timer that runs while a zoom may go on. */
  zooming = NULL;
  down = false;
  /** True once pictures and words are of the present settings, and Python was told of them. */
  settled = false;
  /** Part of a long run that it opens on, and the run that this was found for. */
  part = { of: "", span: NULL };
  choices = 0;
  pictures = 0;
  /** When words were last written. */
  spoken = 0;
  worker = NULL;

  constructor(widget, model, parts) {
    super(widget, model, parts.words);
    this.parts = parts;
    const { Kernels, Engine } = new.target.computing;
    this.kernels = new Kernels(this.model);
    this.makeEngine = () => new Engine(this.model);
    /** What is looked at first. */
    this.opening = this.state.view;
    this.results = new Results(this.kernels, this.makeEngine);
    this.latest = new Latest(this.results, (error) => (error ? this.fail(new Error(error)) : this.schedule()));
    this.hear = () => Object.assign((this.model.written ??= {}), widget.get("written"));
    this.hear();
    widget.on("change:written", this.hear);
    this.address = widget.get("address") ? new Address(this, widget.get("address")) : null;
  }

  /** Build the page, with the groups of the lab's own drawer. */
  open(place, groups) {
    const messages = messagesOf();
    this.drawer = new Drawer(this, this.panel, groups, messages);
    const { body } = this.screen.build(this.drawer.more);
    const root = element(
      "div",
      { class: "percept-lab" },
      ...[messages.problem, messages.pythonError, messages.notice],
      element("div", { class: "lab" }, body, this.drawer.body),
      messages.silence,
    );
    place.append(root);
    keys(root, this);
    listen(root, {
      keydown: (event) => {
        if (event.key !== " " || event.defaultPrevented || event.target.closest(OWN_SPACE)) return;
        event.preventDefault();
        this.screen.clock.toggle();
      },
    });
    for (const type of ["pointerdown", "pointerup", "pointercancel"]) {
      root.addEventListener(type, () => this.hold(type === "pointerdown"), true);
    }
    this.follow({ root, ...messages.functions });
    this.screen.follow();
    this.address?.follow();
  }

  close() {
    super.close();
    this.widget.off("change:written", this.hear);
    this.address?.close();
    this.screen?.close();
    this.worker?.terminate();
  }

  get late() {
    return this.shown?.settings !== this.settings;
  }

  get figures() {
    return this.screen.views;
  }

  /** True while a hand holds something, so that what is around it stands still. */
  get held() {
    return this.down || this.resting !== null;
  }

  /** The run that arrows and sentence are about; none of an impossible choice. */
  chosenOf({ runs = [] }) {
    return runs.find(({ name }) => name === this.state.view.chosen) ?? runs[0] ?? null;
  }

  /** Name of the chosen observer. */
  chosenName() {
    const { observers } = this.settings;
    const { chosen } = this.state.view;
    return observers.includes(chosen) ? chosen : observers[0];
  }

  // The time in sight.

  /** The time of a whole run: the asked duration, though the point may leave earlier. */
  get whole() {
    const { shown } = this;
    if (!shown?.time?.length) return { low: 0, high: 1 };
    const { settings, time } = shown;
    const recorded = settings.scenario in (this.model.recordings ?? {});
    return { low: time[0], high: recorded ? time.at(-1) : Math.max(settings.duration, time.at(-1)) };
  }

  /** The part of it that is shown. */
  get span() {
    const { whole } = this;
    const [low, high] = (this.state.view.sight ?? this.part.span ?? [whole.low, whole.high])
      .map((time) => within(time, whole.low, whole.high));
    return high - low > THINNEST * (whole.high - whole.low) ? { low, high } : whole;
  }

  /** Show less or more of the time about a time. */
  zoom(factor, about) {
    const { span, whole } = this;
    const all = whole.high - whole.low;
    const length = within(factor * (span.high - span.low), THINNEST * all, all);
    const now = within(about ?? this.screen.clock.present(), span.low, span.high);
    const begin = now - ((now - span.low) / (span.high - span.low)) * length;
    const low = within(begin, whole.low, whole.high - length);
    this.state.look({ sight: [low, low + length] }, true);
    clearTimeout(this.zooming);
    this.zooming = setTimeout(() => this.state.seen(), ZOOM_REST);
    this.looked();
  }

  showAll() {
    const { low, high } = this.whole;
    this.look({ sight: [low, high] });
  }

  /** Open a long run on the part where something happens, if all observers settle early. */
  findPart() {
    const { shown } = this;
    const { low, high } = this.whole;
    const of = [shown.settings.scenario, low, high, shown.settings.observers].join();
    if (this.part.of === of || this.late) return;
    const last = Math.max(...(shown.runs ?? []).map(({ settling }) => settling ?? Infinity));
    const early = shown.runs?.length > 0 && last > 0 && last < EARLY * (high - low) && high - low > LONG;
    this.part = { of, span: early ? [low, Math.min(low + roundStep(SETTLINGS * last), high)] : null };
  }

  // What the hand does.

  /** Open a group of the drawer; no step, for the buttons that lead back stand in it. */
  unfold(more) {
    this.state.amend({ view: { ...this.state.view, more } });
    this.looked();
  }

  looked() {
    this.choices += 1;
    this.spoken = 0;
    this.settled = false;
    this.schedule();
    this.drawer.show();
    this.resize();
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.settle(), REST);
  }

  /** Let a chart stand below the first, or not. */
  showChart(name, on) {
    const { charts } = this.state.view;
    const all = Object.keys(this.parts.charts);
    this.look({ charts: all.filter((each) => (each === name ? on : charts.includes(each))) });
  }

  /** Let arrows and sentence be about an observer. */
  choose(chosen) {
    this.look({ chosen });
  }

  /** Bring the page to the open drawer and charts. */
  resize() {
    const { view } = this.state;
    const { root } = this.view;
    root.classList.toggle("open", Boolean(view.more));
    root.style.setProperty("--charts", String(view.charts.length));
    this.screen.showCharts(view.charts);
  }

  touched(chosen) {
    this.settled = false;
    if (chosen) {
      this.choices += 1;
      this.view.notice("");
      const { settings, why } = this.fitted(this.settings);
      if (why) this.view.notice(why);
      this.state.amend({ settings });
      this.resize();
    }
    this.openWorker();
    // What a worker finds is drawn when it comes.
    if (!this.latest.beside || this.compute()) this.schedule();
    if (!chosen) {
      clearTimeout(this.resting);
      this.resting = setTimeout(() => this.settle(), REST);
      return undefined;
    }
    // What a choice hides must be gone before the next event can reach it.
    this.drawer.show();
    return this.rest();
  }

  change(changes, chosen = false) {
    if (this.state.view.sight && ("scenario" in changes || "duration" in changes))
      this.state.amend({ view: { ...this.state.view, sight: null } });
    super.change(changes, chosen);
  }

  /** Take a step and say what it has changed. */
  changeAndSay(title, changes) {
    const before = this.settings;
    this.change(changes, true);
    this.view.notice(`${title}. ${changesInWords(before, this.settings, this.parts.names)}`);
  }

  /** Put everything back to the opening, but the drawer, which stays as it is. */
  reset() {
    const { more } = this.state.view;
    this.state.reset(structuredClone(this.model.opening), { ...this.opening, more });
    this.touched(true);
  }

  goBack() {
    this.state.leave();
    this.touched(true);
  }

  /** Show settings that somebody sent, and how they looked at them; they are about no question that is open here. */
  visit(settings, view) {
    this.state.step({ settings, view, question: null });
    this.touched(true);
  }

  keep() {
    this.change({ kept: this.settings.kept ? null : { ...structuredClone(this.settings), kept: null } }, true);
  }

  /** The hand takes hold, or lets go: what it did not move follows now. */
  hold(down) {
    if (!down && this.down) this.schedule();
    this.down = down;
  }

  /** Show a time: nothing is computed again. */
  point(cursor) {
    if (cursor === null || cursor === this.state.cursor || this.shown?.problem) return;
    this.state.cursor = cursor;
    this.redraw();
  }

  // Results.

  /** Settings of which a result is drawn: the present ones, and those of the kept run. */
  wanted(settings) {
    return settings.kept ? [settings, settings.kept] : [settings];
  }

  prepare(settings) {
    return Promise.all(this.wanted(settings).map((s) => this.kernels.prepare(s)));
  }

  /** Return the settings, or those that take their place where they are impossible, and why. */
  fitted(settings) {
    return { settings, why: "" };
  }

  /** Return why settings do not go together that the lab's own controls never let meet; empty if they do. */
  clash(_settings) {
    return "";
  }

  rest() {
    this.state.release();
    return this.settle();
  }

  /** Tell Python, and those who listen, of settings that have come to rest. */
  async settle() {
    clearTimeout(this.resting);
    // What stood still under the hand follows now.
    if (this.resting !== null) this.schedule();
    this.resting = null;
    if (this.pending) this.paint();
    const { settings } = this;
    try {
      await this.prepare(settings);
      while (!this.closed && settings === this.settings && !this.latest.want(settings, true)) await this.latest.next();
    } catch (error) {
      this.fail(error);
      return;
    }
    if (this.closed || settings !== this.settings) return;
    if (this.pending || this.late) this.paint();
    if (this.late) return;
    Object.assign(this, { shown: this.latest.shown, ghost: this.latest.ghost });
    this.speakNow();
    this.link?.send(settings, this.parts.summaryOf(this.shown, ++this.serial, this.model), this.state.view);
    this.address?.rested(settings, this.state.view);
    this.screen.describe();
    this.settled = true;
  }

  /** Compute in a worker from the first touch on: at the first picture nobody waits. */
  openWorker() {
    if (this.worker || typeof Worker === "undefined") return;
    this.worker = openWorker(this.widget, {
      ready: (ask) => {
        this.latest.beside = { ask: (task) => ask({ ...task, written: readOf(task.settings, this.model) }) };
      },
      answer: (answer) => this.closed || this.latest.take(answer),
      gone: () => this.latest.lose(),
    });
  }

  get speaking() {
    return performance.now() - this.spoken > BETWEEN_TEXTS;
  }

  /** Ask for the result of the present settings; return true if it is there. */
  compute() {
    const { settings, state: { view } } = this;
    if (!this.wanted(settings).every((s) => this.kernels.of(s))) {
      this.wait(settings);
      return false;
    }
    return this.latest.want(settings, view.charts.length > 0 || (Boolean(view.more) && this.speaking));
  }

  /** Draw once the functions of settings are there. */
  wait(settings) {
    if (this.awaited === settings) return;
    this.awaited = settings;
    this.prepare(settings).then(
      () => this.awaited === settings && this.schedule(),
      (error) => this.fail(error),
    );
  }

  // Pictures.

  /** Draw once more, soon. */
  redraw() {
    this.schedule();
  }

  /** Draw the latest result, which is computed only when settings have changed. */
  paint() {
    this.pending = false;
    cancelAnimationFrame(this.frame);
    try {
      this.compute();
      const { shown, ghost } = this.latest;
      if (!shown) return;
      Object.assign(this, { shown, ghost });
      const speaking = this.speaking && shown.whole;
      this.theme ??= themeOf(this.view.root);
      // What is drawn may be of settings before those that cannot be shown.
      if (!this.late) this.view.problem(shown.problem || "");
      if (!shown.problem && shown.time.length) {
        this.findPart();
        this.screen.draw(shown, ghost, this.theme);
      }
      this.pictures += 1;
      if (speaking) this.speakNow();
    } catch (error) {
      this.fail(error);
    }
  }

  // Words.

  /** Bring words and controls to what is drawn. */
  speakNow() {
    this.spoken = performance.now();
    this.drawer.show();
    this.drawer.speak();
  }

  /** What the words of the drawer tell: a verdict on each run, and why it came out so. */
  told() {
    return { verdicts: this.verdicts(), reasons: this.parts.reasons(this.shown, this.model) };
  }

  verdicts() {
    const { shown, model } = this;
    return shown.runs.map((run) => ({ title: run.title, text: verdict(run, shown, model) }));
  }

  copy() {
    return this.parts.pythonOf(this.shown, this.model, this.state.view.charts);
  }

  /** Take what Python has found out about settings. */
  analysed(answer) {
    this.answer = answer;
    // What is said of it is said with the next picture, however short the last words are ago.
    this.spoken = 0;
    this.schedule();
  }

  /** Python's answer, if it is about what is shown. */
  answered() {
    return this.answer?.settings === this.shown?.settings ? this.answer : null;
  }
}
