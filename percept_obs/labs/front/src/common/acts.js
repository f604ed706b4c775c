// What a preset's act shows.

/** The settings of an act: the standard ones, whatever the lab was opened with, and the act's changes. */
export function settingsAfter(act, standard) {
  const changed = { ...structuredClone(standard), ...structuredClone(act.changes), kept: null };
  changed.gains = structuredClone(standard.gains);
  for (const [name, gains] of Object.entries(act.changes.gains ?? {})) Object.assign(changed.gains[name], gains);
  return changed;
}
