// @ts-check
// Which part of a run's time is in sight: all of it, then what the hand asks for.

import { within } from "../engine/between.js";
import { sampleAt } from "../engine/tables.js";

/** @typedef {{low: number, high: number}} Span */

/** No part is thinner than this part of the whole. */
const THINNEST = 1e-4;

/** A span made so many times as long about a time that stays where it is, inside the whole. */
export function zoomed({ low, high }, whole, factor, about) {
  const all = whole.high - whole.low;
  const length = within(factor * (high - low), THINNEST * all, all);
  const part = (within(about, low, high) - low) / (high - low);
  const begin = within(about - part * length, whole.low, whole.high - length);
  return { low: begin, high: begin + length };
}

/** The span of time that is shown. */
export class Timeline {
  constructor() {
    /** @type {Span} */
    this.whole = { low: 0, high: 1 };
    /** @type {Span} */
    this.span = this.whole;
    this.of = "";
  }

  /** Follow a run: all of it is shown, or the part that the hand has asked for in a run `of` the same. */
  follow(whole, of, /** @type {import("../state/state.js").Sight | null} */ sight) {
    Object.assign(this, { whole, of, span: sight && sight.of === of ? sight.span : whole });
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
  }
}

/** Which of increasing times a span needs to be drawn: its own, and one at either side. */
export function indicesIn(time, { low, high }) {
  return [sampleAt(time, low), Math.min(sampleAt(time, high) + 1, time.length - 1)];
}
