// @ts-check
// Playing a recording: which time is shown next, at which speed, and where between the samples it lies.

import { sampleAt } from "./tables.js";

/** Seconds of the recording that pass in one second. */
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];

/** Parts into which steps by hand divide what is in sight. */
const PARTS = 40;

/** The time that follows after some seconds of play, and whether play goes on from there; at the end it stops. */
export function advanced(time, { low, high }, speed, seconds) {
  const next = Math.max(time, low) + speed * seconds;
  return next < high ? { time: next, playing: true } : { time: high, playing: false };
}

/** Where play begins: at the time that is shown, but from the end again at the beginning. */
export function begun(time, { low, high }) {
  return time === null || time >= high - 1e-9 * (high - low) || time < low ? low : time;
}

/** A time some steps further, in what is in sight. */
export function stepped(time, { low, high }, steps) {
  return within((time ?? low) + (steps * (high - low)) / PARTS, low, high);
}

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
