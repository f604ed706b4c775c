// A lab: settings in, pictures and words out, once a frame and for the latest settings only.

import { Latest } from "../engine/latest.js";
import { within } from "../engine/between.js";
import { Results } from "../engine/results.js";
import { changesInWords } from "../state/settings.js";
import { readOf } from "../engine/typed.js";
import { verdict } from "../state/words.js";
import { Address } from "./address.js";
import { themeOf } from "../draw/canvas.js";
import { LabBase } from "./lab_base.js";
import { build } from "./layout.js";
import { LINE, MOVING_LINE } from "../old/line_styles.js";
import { TimeCharts } from "../old/time_charts.js";
import { openWorker } from "./worker.js";

/** Milliseconds after which a hand that has stopped has come to rest, and a zoom that goes on is another step. */
const [REST, ZOOM_REST] = [150, 400];
/** Milliseconds between texts: nobody reads sixty a second, and each makes the page lay itself out. */
const BETWEEN_TEXTS = 250;
const NULL = /** @type {any} */ (null);

/**
 * A lab that follows the hand and tells Python when the hand rests.  A lab of its own sets `planes`, `formulas` and
 * `panel` before open(), names in `computing` the Kernels that make functions of settings and the Engine that makes
 * results of them, and gives these parts:
 *   words                       what the page calls the settings
 *   names, symbols              what settings are called in a sentence, and what letters stand for
 *   labels, chartOf             labels of the time charts by their names, and the parts of one
 *   causesOf                    settings without one cause each, in a lab that can tell some
 *   reasons, readingAt          why it happened, and values at a time, in words
 *   summaryOf, pythonOf         what Python is told of a result, and the Python text of it
 */
export class Lab extends LabBase {
  /** @type {{Kernels: any, Engine: any}} */
  static computing;
  /** @type {import("../types.js").Plane[]} */
  planes = [];
  /** @type {import("./screen.js").FirstScreen} the screen that the lab opens with */
  first = NULL;
  /** @type {"first" | "workbench"} */
  face = "workbench";
  formulas = NULL;
  /** Result of the kept run. */
  ghost = NULL;
  /** Time under the pointer. */
  peeked = NULL;
  /** Settings at which the hand took hold. */
  taken = NULL;
  /** Timer that runs while a zoom may go on. */
  zooming = NULL;
  down = false;
  /** True where charts and words are to be brought to what is shown. */
  stale = true;
  /** True once pictures and words are of the present settings, and Python was told of them. */
  settled = false;
  choices = 0;
  pictures = 0;
  /** When words, and the reading of the present time, were last written. */
  spoken = 0;
  read = 0;
  worker = NULL;

  constructor(widget, model, parts) {
    super(widget, model, parts.words);
    this.parts = parts;
    this.time = new TimeCharts(parts.labels ?? {});
    const { Kernels, Engine } = new.target.computing;
    this.kernels = new Kernels(this.model);
    this.makeEngine = () => new Engine(this.model);
    this.results = new Results(this.kernels, this.makeEngine);
    this.latest = new Latest(this.results, (error) => (error ? this.fail(new Error(error)) : this.schedule()));
    this.address = widget.get("address") ? new Address(this, widget.get("address")) : null;
  }

  open(place) {
    this.face = this.widget.get("face") ?? "first";
    this.follow(build(this, place));
    this.first.follow();
    this.address?.follow();
  }

  /** Show the first screen, or the workbench, of the same settings at the same time. */
  turn(face) {
    this.face = face;
    this.first.clock.pause();
    this.view.turn(face);
    this.spoken = 0;
    this.schedule();
    this.settle();
  }

  close() {
    super.close();
    this.address?.close();
    this.first?.close();
    this.view.close();
    this.worker?.terminate();
    for (const plane of this.planes) plane.close?.();
  }

  get late() {
    return this.shown?.settings !== this.settings;
  }

  get charts() {
    return this.time.charts;
  }

  get drawn() {
    return this.time.drawn;
  }

  /** Times in sight. */
  get span() {
    return this.time.timeline.span;
  }

  get figures() {
    return [...(this.first?.views ?? []), ...this.planes, ...Object.values(this.charts)];
  }

  /** Times that are drawn: all of them on the first screen. */
  get sight() {
    const { face, shown, span } = this;
    return face === "first" && shown?.time?.length ? { low: shown.time[0], high: shown.time.at(-1) } : span;
  }

  /** True while a hand holds something, so that what is around it stands still. */
  get held() {
    return this.down || this.resting !== null;
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
    this.openWorker();
    // What a worker finds is drawn when it comes.
    if (!this.latest.beside || this.compute()) this.schedule();
    if (!chosen) {
      clearTimeout(this.resting);
      this.resting = setTimeout(() => this.settle(), REST);
      return undefined;
    }
    // What a choice hides must be gone before the next event can reach it.
    this.panel.show();
    return this.rest();
  }

  /** Take a step and say what it has changed. */
  changeAndSay(title, changes) {
    const before = this.settings;
    this.change(changes, true);
    this.view.notice(`${title}. ${changesInWords(before, this.settings, this.parts.names)}`);
  }

  goBack() {
    this.state.leave();
    this.touched(true);
  }

  /** Show settings that somebody sent; they are about no question that is open here. */
  visit(settings) {
    this.state.step({ settings, question: null });
    this.touched(true);
  }

  keep() {
    this.change({ kept: this.settings.kept ? null : { ...structuredClone(this.settings), kept: null } }, true);
  }

  /** The hand takes hold, or lets go: what it did not move follows now. */
  hold(down) {
    if (down) this.taken = this.settings;
    else if (this.down && this.taken !== this.settings) this.schedule();
    this.down = down;
  }

  /** Show a time: nothing is computed again. */
  point(cursor) {
    if (cursor === null || cursor === this.state.cursor || this.shown?.problem) return;
    this.state.cursor = cursor;
    this.peeked = null;
    this.redraw();
  }

  /** Show the time under a pointer until it leaves. */
  peek(time) {
    if (time === this.peeked) return;
    this.peeked = time;
    this.redraw();
  }

  /** Show another part of the time. */
  zoom(change) {
    const { timeline } = this.time;
    const before = timeline.span;
    change(timeline);
    if (timeline.span !== before) this.state.look({ span: timeline.span, of: timeline.of });
    clearTimeout(this.zooming);
    this.zooming = setTimeout(() => this.state.seen(), ZOOM_REST);
    this.view.steps(this.state);
    this.choices += 1;
    this.peeked = null;
    this.schedule();
  }

  /** Let a line stand out until another one is chosen: a step of its own. */
  choose(picked) {
    this.state.step({ picked });
    this.view.steps(this.state);
  }

  /** Let the line of a colour stand out, or all of them. */
  pick(colour) {
    if (!this.theme || this.theme.picked === colour) return;
    this.theme = { ...this.theme, picked: colour };
    this.schedule();
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
    this.resting = null;
    if (this.theme && this.theme.width !== LINE) this.schedule();
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
    this.link?.send(settings, this.parts.summaryOf(this.shown, ++this.serial, this.model));
    this.address?.rested(settings);
    this.describe();
    this.view.rested();
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
    return this.stale && performance.now() - this.spoken > BETWEEN_TEXTS;
  }

  /** Ask for the result of the present settings; return true if it is there. */
  compute() {
    const { settings } = this;
    if (!this.wanted(settings).every((s) => this.kernels.of(s))) {
      this.wait(settings);
      return false;
    }
    return this.latest.want(settings, this.speaking, { ...this.sight, cursor: this.state.cursor });
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

  /** Draw once more, soon: what has changed. */
  schedule() {
    this.stale = true;
    this.redraw();
  }

  /** Draw once more, soon: the charts only if they have changed. */
  redraw() {
    super.schedule();
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
      this.theme ??= { ...themeOf(this.view.root), picked: null };
      this.draw();
      this.pictures += 1;
      if (speaking) this.speakNow();
    } catch (error) {
      this.fail(error);
    }
  }

  draw() {
    const { shown, ghost, theme } = this;
    theme.resting = this.face === "workbench" && !this.held;
    if (this.face === "first" && !shown.problem && shown.time.length) {
      this.first.draw(shown, ghost, theme);
      this.stale = false;
      return;
    }
    theme.width = this.held ? MOVING_LINE : LINE;
    const cursor = this.present();
    for (const plane of this.planes) plane.draw(shown, ghost, cursor, theme);
    if (this.stale) this.drawCharts();
    this.stale = false;
    this.time.point(cursor);
    this.view.time(cursor);
    const now = performance.now();
    const nothing = cursor === null || shown.refusal;
    if (!nothing && (this.held || this.view.playing()) && now - this.read < BETWEEN_TEXTS) return;
    this.read = now;
    this.view.read(nothing ? "" : this.parts.readingAt(shown, cursor));
  }

  /** Return the time that is shown, and let the span in sight follow the result. */
  present() {
    const { shown, state } = this;
    if (shown.problem || !shown.time.length) return null;
    const { settings, time } = shown;
    const recorded = settings.scenario in (this.model.recordings ?? {});
    // The asked duration, though the point may leave earlier: an axis that stays is easier to read while dragging.
    const whole = { low: time[0], high: recorded ? time.at(-1) : settings.duration };
    this.time.timeline.follow(whole, [settings.scenario, whole.low, whole.high].join(), state.now.sight);
    state.cursor = within(state.cursor ?? this.span.low, this.span.low, this.span.high);
    return this.peeked ?? state.cursor;
  }

  /** Names of the time charts that are shown. */
  chosen() {
    const { problem, settings } = this.shown;
    return problem ? [] : this.model.pictures.filter((name) => settings.pictures.includes(name));
  }

  drawCharts() {
    const { shown, ghost, theme, held, width } = this;
    this.view.answered(this.answered());
    const more = this.besides();
    const partsOf = (name) => this.parts.chartOf(name, shown, ghost, theme, more);
    this.time.draw(this.chosen(), partsOf, { theme, held, narrow: width < 600 });
  }

  /** More values for the time charts. */
  besides() {
    return {};
  }

  // Words.

  /** Bring words and controls to what is drawn. */
  speakNow() {
    this.spoken = performance.now();
    // What is drawn may be of settings before those that cannot be shown.
    if (!this.late) this.view.problem((this.face === "first" && this.shown.problem) || "");
    if (this.face === "first") return;
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

  /** Verdicts, each with the line that it is about. */
  verdicts() {
    const { shown, model } = this;
    return shown.runs.map((run) => ({ which: run.order, title: run.title, text: verdict(run, shown, model) }));
  }

  legend() {
    const { truth, runs, problem } = this.shown;
    if (problem) return [];
    return [...(truth ? [["truth", "truth"]] : []), ...runs.map(({ order, title }) => [order, title])];
  }

  copy() {
    return this.parts.pythonOf(this.shown, this.model);
  }

  describe() {
    if (this.face === "first") {
      this.first.describe();
      return;
    }
    for (const plane of this.planes) plane.describe(this.shown);
    this.time.describe();
    this.formulas.show(this.shown.settings);
  }

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
