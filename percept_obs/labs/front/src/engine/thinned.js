// @ts-check
// As much of a result as is drawn while a hand moves: fewer samples, each with the numbers that it has at rest.

import { indicesIn } from "./tables.js";

/**
 * @typedef {object} Sight   what is drawn while a hand moves
 * @property {number} low    the span of the charts
 * @property {number} high
 * @property {number | null} cursor  the time that is shown
 * @property {boolean} [complete]  whether charts show what is read off a whole result
 */

/** Numbers of what is in sight at most; and samples that there are at least, one for two pixels of a chart. */
const [MOST, LEAST] = [30_000, 375];

/** Names of a result's arrays with a row for each sample; those of other clocks have other names. */
const ROWS = new Set([
  ...["outputs", "truth", "image", "estimate", "deviation", "error", "bound", "quiet", "sizes", "determinants"],
  ...["images", "seenImages", "depths", "size", "errors", "relative", "worst"],
]);

/** Parts of 1 that lie apart however many there are: what changes with each sample is met at all of its phases. */
const APART = (Math.sqrt(5) - 1) / 2;

/**
 * A result with fewer samples, if it has many: of those in sight as many as can be told apart, of the others fewer.
 * The first and the last one stay, and those about the time that is read.
 *
 * @param {any} result
 * @param {Sight} sight
 */
export function thinned(result, sight) {
  const { time } = result;
  if (time.length <= LEAST) return result;
  const [from, to] = indicesIn(time, sight);
  const most = Math.max(LEAST, MOST / widthOf(result, time.length));
  if (time.length <= most) return result;
  const read = sight.cursor === null ? [] : indicesIn(time, { low: sight.cursor, high: sight.cursor });
  const parts = [[0, from], [from, to], [to, time.length]];
  const some = [...parts.flatMap(([begin, end]) => spaced(begin, end, most)), ...read, time.length - 1];
  const which = Int32Array.from(new Set(some)).sort();
  const picked = new Map();
  const pick = (rows) => {
    if (!picked.has(rows)) picked.set(rows, rowsAt(rows, rows.length / time.length, which));
    return picked.get(rows);
  };
  return { ...changed(result, pick), time: pick(time), whole: false };
}

/** The first number from one on to another, and at most so many more: one from each equal part. */
function spaced(from, to, most) {
  const every = Math.max(1, (to - from) / most);
  const count = Math.floor((to - from) / every);
  return Array.from({ length: count }, (_, j) => (j ? Math.floor(from + every * (j + ((j * APART) % 1))) : from));
}

/** Total of numbers of a sample. */
function widthOf(result, count) {
  const all = new Set();
  changed(result, (rows) => all.add(rows) && rows);
  return Array.from(all, (rows) => rows.length / count).reduce((sum, width) => sum + width, 0);
}

/** A result with other rows: its own, those of its runs, and those of its other parts. */
function changed(value, pick, rows = false) {
  if (ArrayBuffer.isView(value)) return rows ? pick(value) : value;
  if (Array.isArray(value)) return value.map((each) => changed(each, pick, rows));
  if (value?.constructor !== Object) return value;
  return Object.fromEntries(
    Object.entries(value).map(([name, inner]) => [
      name,
      name === "settings" ? inner : changed(inner, pick, ROWS.has(name)),
    ]),
  );
}

function rowsAt(rows, width, which) {
  const found = new Float64Array(width * which.length);
  for (let j = 0; j < which.length; j++) {
    for (let c = 0; c < width; c++) found[j * width + c] = rows[which[j] * width + c];
  }
  return found;
}
