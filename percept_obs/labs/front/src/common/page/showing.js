// What a lab shows: its pictures of a result, at one time, over the part of the time that is in sight.

import { within } from "../model/playback.js";
import { Following } from "./following.js";
import { LINE, MOVING_LINE } from "./lines.js";
import { TimeCharts } from "./time_charts.js";

/** @typedef {import("../../types.js").Plane} Plane */
/** @typedef {import("../../types.js").Settings} Settings */

const BETWEEN_READINGS = 250;
/** Milliseconds after which a zoom that goes on is another step. */
const LOOK = 400;

/** Pictures of what was computed.  Another time, another look, or another part of the time computes nothing again. */
export class Showing extends Following {
  constructor(widget, model, parts) {
    super(widget, model, parts.words);
    this.parts = parts;
    /** @type {Plane[]} */
    this.planes = [];
    /** @type {TimeCharts} */
    this.time = new TimeCharts({});
    /** @type {any} the result of the kept run */
    this.ghost = null;
    /** @type {number | null} the time under the pointer */
    this.peeked = null;
    this.choices = 0;
    /** @type {Settings | null} those at which the hand took hold */
    this.taken = null;
    this.read = 0;
    /** @type {any} the timer that runs while a zoom may go on */
    this.looking = null;
    this.down = false;
    this.stale = true;
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

  /** The times in sight. */
  get span() {
    return this.time.timeline.span;
  }

  get figures() {
    return [...this.planes, ...Object.values(this.charts)];
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
    if (timeline.span !== before) this.state.look({ span: timeline.span, question: timeline.question });
    clearTimeout(this.looking);
    this.looking = setTimeout(() => this.state.seen(), LOOK);
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

  /** The hand takes hold, or lets go: what it did not move follows now. */
  hold(down) {
    if (down) this.taken = this.settings;
    else if (this.down && this.taken !== this.settings) this.schedule();
    this.down = down;
  }

  /** Whether a hand holds something, so that what is around it stands still. */
  get held() {
    return this.down || this.resting !== null;
  }

  /** Draw once more, soon: what has changed. */
  schedule() {
    this.stale = true;
    this.redraw();
  }

  /** Draw once more, soon: the charts only if they have changed. */
  redraw() {
    super.schedule();
  }

  chosen() {
    const { problem, settings } = this.shown;
    return problem ? [] : this.model.pictures.filter((name) => settings.pictures.includes(name));
  }

  draw() {
    const { shown, ghost, theme } = this;
    theme.width = this.held ? MOVING_LINE : LINE;
    const cursor = this.present();
    for (const plane of this.planes) plane.draw(shown, ghost, cursor, theme);
    if (this.stale) this.drawCharts();
    this.stale = false;
    this.time.point(cursor);
    this.view.time(cursor);
    const now = performance.now();
    const nothing = cursor === null || shown.refusal;
    // Nobody reads sixty texts a second, and the page would lay itself out for each of them.
    if (!nothing && (this.held || this.view.playing()) && now - this.read < BETWEEN_READINGS) return;
    this.read = now;
    this.view.read(nothing ? "" : this.parts.readingAt(shown, cursor));
  }

  /** The time that is shown, in what there is to show. */
  present() {
    const { shown, state } = this;
    if (shown.problem || !shown.time.length) return null;
    const { settings, time } = shown;
    const recorded = settings.scenario in (this.model.recordings ?? {});
    // The asked duration, though the point may leave earlier: an axis that stays is easier to read while dragging.
    const whole = { low: time[0], high: recorded ? time.at(-1) : settings.duration };
    const { name, act } = state.preset ?? { name: "", act: -1 };
    const question = [settings.scenario, whole.low, whole.high, ...(act < 0 ? [] : [name, act])].join();
    const { sight } = state.now;
    const { timeline } = this.time;
    // A result of other settings tells another story: the present one is opened when its result is there.
    const now = this.late ? { ...timeline, held: true } : { question, choice: this.choices, held: this.held };
    timeline.follow(whole, this.story(), { ...now, asked: sight?.question === now.question ? sight.span : null });
    state.cursor = within(state.cursor ?? this.span.low, this.span.low, this.span.high);
    return this.peeked ?? state.cursor;
  }

  /** When each run settled, in seconds, null where there is no truth to say so; and until when something else happens. */
  story() {
    const { runs, inside = [] } = this.shown;
    return { settlings: runs.map(({ settling }) => settling), events: inside.at(-1)?.[1] };
  }

  drawCharts() {
    const { shown, ghost, theme, held, width } = this;
    this.view.answered(this.answered());
    const more = this.besides();
    const partsOf = (name) => this.parts.chartOf(name, shown, ghost, theme, more);
    this.time.draw(this.chosen(), partsOf, { theme, held, narrow: width < 600 });
  }

  /** Python's answer, if it is about what is shown. */
  answered() {
    return /** @type {any} */ (null);
  }

  /** What else the time charts show. */
  besides() {
    return {};
  }
}
