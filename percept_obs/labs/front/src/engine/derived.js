// Values derived from a result's rows: made when they are first needed, and kept as long as the rows.

import { column, knownAt, withColumns } from "./tables.js";

const kept = new WeakMap();

/** The value made of these rows under a name, once. */
export function derived(rows, name, make) {
  if (!kept.has(rows)) kept.set(rows, new Map());
  const found = kept.get(rows);
  if (!found.has(name)) found.set(name, make());
  return found.get(name);
}

export function columnOf(rows, width, which) {
  return derived(rows, `column ${which}`, () => column(rows, width, which));
}

/** Sampled numbers at some times, as rows: between two samples they are on a line. */
export function sampledAt(samples, times) {
  return knownAt(derived(samples, "columns", () => withColumns(samples)), [], times);
}
