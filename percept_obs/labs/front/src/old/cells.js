// @ts-check
// The cells of a map over two settings: what became of one observer's run at each of them.

import { gainAxes, valueIn } from "./axes.js";

/** Outcomes of a run. */
export const [NOT_YET, FOLLOWED, DIVERGED, IMPOSSIBLE] = [0, 1, 2, 3];

/** Numbers of a cell: what became of it, its settling time in s, its relative error at the end. */
export const EACH_CELL = 3;

/** Cells along a side of the first picture, for which a moving hand waits, and of those that follow. */
export const FIRST = [4, 6, 8, 12, 16];
export const THEN = [24, 64, 128];

/** Settings of a run that nobody looks at but a map: one observer, and nothing that is only drawn. */
export function bare(settings, observer) {
  return { ...settings, observers: [observer], pictures: [], bound: [], kept: null, over: null };
}

/** Settings without the values that a map goes over; those of two maps are the same only if the maps are. */
export function baseOf(settings, { observer, across, up }, functions) {
  const middle = (given, axis) => given && axis.put(given, valueIn(axis, 0, 1), functions);
  return middle(middle(bare(settings, observer), across), up);
}

/**
 * The settings of a cell, null where there are none.
 *
 * @param {any} base
 * @param {{across: import("./axes.js").Axis, up: import("./axes.js").Axis}} plan
 * @param {number[]} place  the values of both
 * @param {any} functions
 */
export function settingsAt(base, { across, up }, [x, y], functions) {
  const moved = across.put(base, x, functions);
  return moved && up.put(moved, y, functions);
}

/**
 * The column and the row of the k-th cell: what makes another recording changes last, so that most cells share theirs.
 */
export function orderOf({ across, up }, cells) {
  const rows = up.records || !across.records;
  return (k) => (rows ? [k % cells, Math.floor(k / cells)] : [Math.floor(k / cells), k % cells]);
}

/** Fill in what becomes of a run. */
export function fillCell(out, at, settings, { engine, kernels }, functions) {
  const allowed = settings && gainsAllowed(settings, engine.model, kernels);
  const result = allowed && engine.run(settings, functions, false);
  if (!result || result.problem || result.refusal || !result.truth) {
    out[at] = IMPOSSIBLE;
    return;
  }
  const { divergedAt, settling, error } = result.runs[0];
  out[at] = divergedAt === null ? FOLLOWED : DIVERGED;
  out[at + 1] = settling;
  out[at + 2] = error[error.length - 1];
}

function gainsAllowed({ observers: [name], gains }, model, kernels) {
  return gainAxes(model, name).every(({ place }) => {
    const gain = place.split(".")[2];
    return kernels.allows(name, gain, gains[name][gain]);
  });
}
