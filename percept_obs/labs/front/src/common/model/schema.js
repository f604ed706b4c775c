// @ts-check
// Kinds of settings, as the schemas of the labs have them; types.js says what each of them holds.

export const SEED = { kind: "number", label: "seed", low: 0, high: 100, step: 1, whole: true, least: 0, most: 2 ** 32 - 1 };
export const DROPOUT = { kind: "number", label: "lost samples", low: 0, high: 0.9, step: 0.01, least: 0, most: 0.95 };

/** What observers may take for the outputs between samples. */
export const HOLDS = { zero: "the last sample", first: "a line, a sample ahead", exact: "the exact signal" };

/** How large something is that may be 0 and never exceeds 1. */
export function amount(label, high, step) {
  return { kind: "number", label, low: 0, high, step, least: 0, most: 1 };
}

/** A camera's noise: its kind, and how large it is in what is measured. */
export function noise(label, sizes) {
  const kind = { kind: "choice", label, choices: { uniform: "uniform", gaussian: "Gaussian" } };
  return { kind: "group", entries: { kind, ...sizes } };
}

/** A list with a number of each name; what differs is told by the functions of a name. */
export function listOf(names, labelOf, number) {
  return { kind: "list", entries: names.map((name) => ({ kind: "number", ...number, name, label: labelOf(name) })) };
}

/** The schema of the value at a place in the settings. */
export function schemaAt(schema, place) {
  const [key, ...rest] = place.split(".");
  return rest.reduce((part, name) => part.entries[name], schema[key]);
}
