// Apparent size as a third output: s = r eta, between the image coordinates and the inverse distance eta.
// Observers run on all four; what is drawn of a run has the three that every other run has.

import { derived } from "../../engine/derived.js";

/** Place of s, and how many coordinates there are with it. */
const [SIZE, WIDTH] = [2, 4];
const [MEASURED, HIDDEN] = [[0, 1], [2]];

export const seesSize = ({ outputs }) => outputs.includes("s");

/** The coordinates that are drawn, of those that a form measures and hides. */
export const drawn = (settings, { measured, hidden }) =>
  seesSize(settings) ? { measured: MEASURED, hidden: HIDDEN } : { measured, hidden };

/** A result as the observers of its form have it. */
export function withSize(result, { measured, hidden }, radius) {
  const { truth } = result;
  if (!seesSize(result.settings)) return result;
  const make = () => Float64Array.from({ length: (truth.length / 3) * WIDTH }, (_, k) => {
    const [row, c] = [3 * Math.floor(k / WIDTH), k % WIDTH];
    return c === SIZE ? radius * truth[row + 2] : truth[row + Math.min(c, 2)];
  });
  return { ...result, width: WIDTH, measured, hidden, truth: derived(truth, "with size", make) };
}

/** A run as it is drawn. */
export function withoutSize(run) {
  const without = (rows) => rows && rows.filter((_, k) => k % WIDTH !== SIZE);
  const make = () => ({ ...run, estimate: without(run.estimate), deviation: without(run.deviation) });
  return run.estimate ? derived(run.estimate, "without size", make) : run;
}

/** The exact outputs, a column each, from the columns of all coordinates but s. */
export function outputsOf([y1, y2, inverse], measured, radius) {
  if (measured.length < 3) return measured.map((c) => [y1, y2][c]);
  return [y1, y2, derived(inverse, "size", () => inverse.map((value) => radius * value))];
}

/** Estimates to start from, with the size as it is seen first. */
export function startWithSize(values, columns) {
  return columns.length < 3 ? values : [...values.slice(0, SIZE), columns[SIZE][0], ...values.slice(SIZE)];
}
