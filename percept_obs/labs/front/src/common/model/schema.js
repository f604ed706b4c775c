// Kinds of settings, as the schemas of the labs have them; types.js says what each of them holds.

export const NOISES = { uniform: "uniform", gaussian: "Gaussian" };

/** What observers may take for the outputs between samples. */
export const HOLDS = { zero: "the last sample", first: "a line, a sample ahead", exact: "the exact signal" };

/** A list with a number of each name; what differs is told by the functions of a name. */
export function listOf(names, labelOf, number) {
  return { kind: "list", entries: names.map((name) => ({ kind: "number", ...number, name, label: labelOf(name) })) };
}

/** The schema of the value at a place in the settings. */
export function schemaAt(schema, place) {
  const [key, ...rest] = place.split(".");
  return rest.reduce((part, name) => part.entries[name], schema[key]);
}
