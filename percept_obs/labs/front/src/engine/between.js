// @ts-check
// Values between two others, and where between samples a time lies.

import { sampleAt } from "./tables.js";

/** A time between two others. */
export function within(time, low, high) {
  return Math.min(Math.max(time, low), high);
}

/** The sample before a time, and which part of the way to the next one has passed. */
export function between(time, when) {
  const sample = sampleAt(time, when);
  const way = time[sample + 1] - time[sample];
  const part = way > 0 ? within((when - time[sample]) / way, 0, 1) : 0;
  // Within a rounding of a sample it is that sample, whatever the next one lacks.
  return { sample, part: part < 1e-6 ? 0 : part };
}

/** A column of rows of numbers at a place between samples. */
export function valueBetween(rows, width, column, { sample, part }) {
  const value = rows[sample * width + column];
  return part > 0 ? value + part * (rows[(sample + 1) * width + column] - value) : value;
}
