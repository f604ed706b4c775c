// @ts-check
// Which part of a run's time is in sight: where the story is at first, then what the hand asks for.

import { within } from "./playback.js";
import { linearScale } from "./scales.js";
import { sampleAt } from "./tables.js";

/** @typedef {{low: number, high: number}} Span */

/** The story is shown with three times as much after it, unless that is most of the run. */
const AFTER = 4;
const SHORTLY_AFTER = 1.2;
const MOST = 0.6;
/** No part is thinner than this part of the whole. */
const THINNEST = 1e-4;

/**
 * The part of a run in which errors fall, and something else happens until `events`; all of it where one never settles.
 */
export function storyOf(whole, /** @type {(number | null)[]} */ settlings, events = whole.low) {
  const latest = settlings.length ? Math.max(...settlings.map((value) => value ?? Infinity)) : Infinity;
  if (!(latest > 0 && latest < Infinity)) return whole;
  const length = linearScale(0, Math.max(AFTER * latest, SHORTLY_AFTER * (events - whole.low))).high;
  return length < MOST * (whole.high - whole.low) ? { low: whole.low, high: whole.low + length } : whole;
}

/** A span made so many times as long about a time that stays where it is, inside the whole. */
export function zoomed({ low, high }, whole, factor, about) {
  const all = whole.high - whole.low;
  const length = within(factor * (high - low), THINNEST * all, all);
  const part = (within(about, low, high) - low) / (high - low);
  const begin = within(about - part * length, whole.low, whole.high - length);
  return { low: begin, high: begin + length };
}

/** The span of time that is shown; it stays as it is while a hand moves settings. */
export class Timeline {
  constructor() {
    /** @type {Span} */
    this.whole = { low: 0, high: 1 };
    /** @type {Span} */
    this.span = this.whole;
    this.byHand = false;
    this.question = "";
    this.choice = -1;
  }

  /**
   * Follow a run: another question shows its story, and so does another choice, unless the hand had zoomed.  What the
   * hand had `asked` for is shown, whatever was before; null takes a zoom back.
   */
  follow(
    whole,
    { settlings, events },
    { question, choice, held, asked = /** @type {Span | null | undefined} */ (undefined) },
  ) {
    const story = storyOf(whole, settlings, events);
    if (asked) [this.span, this.byHand, this.question] = [asked, true, question];
    else if (asked === null && this.byHand) this.forget();
    const other = question !== this.question;
    if (other) this.byHand = false;
    this.whole = whole;
    const chosen = choice !== this.choice && !this.byHand && !held;
    if (other || chosen) {
      this.span = story;
      this.choice = choice;
    }
    this.question = question;
    if (this.span.high > whole.high || this.span.low < whole.low)
      this.span = zoomed(this.span, whole, 1, this.span.low);
  }

  /** Show the story again. */
  forget() {
    this.question = "";
  }

  zoom(factor, about) {
    this.select(zoomed(this.span, this.whole, factor, about));
  }

  /** Show a part; the ends may come in any order. */
  select({ low, high }) {
    const { whole } = this;
    const [begin, end] = [Math.min(low, high), Math.max(low, high)].map((time) => within(time, whole.low, whole.high));
    if (end - begin < THINNEST * (whole.high - whole.low)) return;
    this.span = { low: begin, high: end };
    this.byHand = true;
  }
}

/** Which of increasing times a span needs to be drawn: its own, and one at either side. */
export function indicesIn(time, { low, high }) {
  return [sampleAt(time, low), Math.min(sampleAt(time, high) + 1, time.length - 1)];
}
