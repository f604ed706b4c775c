// Directions of a state in words, as observability/directions.py has them.

import { short } from "../../draw/scales.js";

const MOST_TERMS = 6;

/** Directions, each a row of numbers, as sums of named states: each of as few states as elimination gets it to. */
export function inWords(directions, names) {
  return reduced(directions.map((row) => Array.from(row))).map((row) => sumOf(row, names));
}

function reduced(rows) {
  for (let k = 0; k < rows.length; k++) {
    const candidates = rows[k].map((_, c) => Math.max(...rows.slice(k).map((row) => Math.abs(row[c]))));
    // The earliest state whose entry is about the largest, so that directions read in the states' order.
    const most = Math.max(...candidates);
    const column = candidates.findIndex((value) => value > 0.5 * most);
    let pivot = k;
    for (let i = k; i < rows.length; i++) if (Math.abs(rows[i][column]) > Math.abs(rows[pivot][column])) pivot = i;
    [rows[k], rows[pivot]] = [rows[pivot], rows[k]];
    const size = rows[k][column];
    rows[k] = rows[k].map((value) => value / size);
    rows.forEach((row, i) => {
      if (i === k) return;
      const factor = row[column];
      rows[i] = row.map((value, c) => value - factor * rows[k][c]);
    });
  }
  return rows;
}

function sumOf(row, names) {
  const largest = Math.max(...row.map(Math.abs));
  const terms = row.map((value, k) => [value, names[k]]).filter(([value]) => Math.abs(value) >= 1e-6 * largest);
  const shown = terms.length <= MOST_TERMS ? terms : terms.slice(0, MOST_TERMS - 1);
  let words = "";
  for (const [value, name] of shown) {
    const size = Math.abs(Math.abs(value) - 1) < 1e-6 ? "" : `${short(Math.abs(value))} `;
    words += words ? ` ${value < 0 ? "-" : "+"} ${size}${name}` : `${value < 0 ? "-" : ""}${size}${name}`;
  }
  return shown === terms ? words : `${words} and ${terms.length - shown.length} more states`;
}

/** The states that a direction changes most, at most three. */
export function mainly(direction, names) {
  const largest = Math.max(...direction.map(Math.abs));
  const sizes = Array.from(direction, (value) => Math.round((1e6 * Math.abs(value)) / largest));
  const order = [...sizes.keys()].sort((a, b) => sizes[b] - sizes[a]);
  return order
    .slice(0, 3)
    .filter((k) => sizes[k] > 0)
    .map((k) => names[k])
    .join(", ");
}
