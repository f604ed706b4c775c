// Settings of a lab: kinds and ranges of Python's schema, with the page's words; types.js says what each holds.

/** Holds of the outputs between samples. */
export const HOLD = { choices: { zero: "the last sample", first: "a line to the next", exact: "the exact signal" } };
export const WINDOW = { meaning: "at least from one sample to the next" };
export const NOISE = { kind: { choices: { uniform: "uniform", gaussian: "Gaussian" } } };

/**
 * A lab's schema for its controls.
 *
 * @param {Record<string, any>} told   Python's kinds, by the settings' names
 * @param {Record<string, any>} words  what the page calls them, where that is not their name or Python's label
 * @returns {Record<string, import("../types.js").SettingSchema>}
 */
export function schemaOf(told, words) {
  const made = (kind, name) => MAKE[kind.kind]?.(kind, words[name] ?? {}, name) ?? kind;
  return Object.fromEntries(Object.entries(told).map(([name, kind]) => [name, made(kind, name)]));
}

/** The schema of the value at a place in the settings. */
export function schemaAt(schema, place) {
  const [key, ...rest] = place.split(".");
  return rest.reduce((part, name) => part.entries[name], schema[key]);
}

const MAKE = {
  number: ({ label, unit, low: least, high: most, usual, step, whole, nonzero, topic }, words, name) => {
    const [low, high] = usual ?? [least, most];
    const said = { label: label ?? name, unit, low, high, step, log: step === undefined && low > 0 };
    return { kind: "number", ...said, least, most, whole, nonzero, topic, ...words };
  },
  choice: ({ label, names }, words, name) => ({
    kind: "choice",
    label: label ?? name[0].toUpperCase() + name.slice(1),
    choices: Object.fromEntries((names ?? []).map((each) => [each, each])),
    ...words,
  }),
  names: (kind, words, name) => ({ ...MAKE.choice(kind, words, name), kind: words.kind ?? "names" }),
  row: ({ entries, label }, words) => {
    const [first] = entries;
    if (first.kind === "row") {
      const [{ step, low: least, high: most }] = first.entries;
      const columns = first.entries.length;
      return { kind: "matrix", label, rows: entries.length, columns, step, least, most, ...words };
    }
    const called = (text, entry) => text?.replace("{}", entry.label) ?? entry.label;
    const named = (entry) => ({ name: called(words.name, entry), label: called(words.label, entry) });
    return { kind: "list", entries: entries.map((entry) => MAKE.number(entry, named(entry), "")) };
  },
  group: ({ of }, words) => ({ kind: "group", entries: schemaOf(of, words) }),
  optional: ({ of }, words, name) => MAKE[of.kind]?.(of, words, name) ?? of,
  several: ({ of }, words) => {
    const { entries } = MAKE.optional({ of }, {}, "");
    return { kind: "several", most: entries.at(-1).most, ...words };
  },
};
