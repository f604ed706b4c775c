// Settings: comparing them, reading and changing them by the place of a value such as "noise.size" or "b.0".

/** True if two settings are equal, whatever the order of their keys. */
export function same(one, other) {
  if (Object.is(one, other)) return true;
  if (typeof one !== "object" || typeof other !== "object" || !one || !other) return false;
  const keys = Object.keys(one);
  return keys.length === Object.keys(other).length && keys.every((key) => same(one[key], other[key]));
}

/** The value at a place; undefined where there is none. */
export function valueAt(settings, place) {
  return place.split(".").reduce((part, key) => part?.[key], settings);
}

/** Changes of the settings that put a value at a place. */
export function changeAt(settings, place, value) {
  const [key, ...rest] = place.split(".");
  if (!rest.length) return { [key]: value };
  const part = settings[key];
  const change = changeAt(part, rest.join("."), value);
  return { [key]: Array.isArray(part) ? Object.assign([...part], change) : { ...part, ...change } };
}

/** The switch of an observer, or an empty text; its loop has this name. */
export function switchOf(settings, name) {
  return settings.switches?.[name] ?? "";
}

/**
 * The settings of a question: the standard ones, whatever the lab was opened with, with changes; and those of the run
 * that is kept `beside` it, with changes of its own.
 */
export function settingsOf({ changes, beside = null }, standard) {
  const gains = { ...standard.gains };
  for (const [name, changed] of Object.entries(changes.gains ?? {})) gains[name] = { ...gains[name], ...changed };
  const kept = beside ? settingsOf({ changes: beside }, standard) : null;
  return structuredClone({ ...standard, ...changes, ...(standard.gains && { gains }), kept });
}

/** Sentence on the changes from some settings to others, with a lab's names of them. */
export function changesInWords(before, after, names) {
  const changed = Object.keys(after).filter((key) => key !== "kept" && !same(before[key], after[key]));
  if (!changed.length) return "Nothing has changed.";
  const told = [...new Set(changed.map((key) => names[key] ?? `the ${key}`))];
  const last = told.pop();
  return `Changed: ${told.length ? `${told.join(", ")} and ${last}` : last}. All else is as it was.`;
}
