// Causes of an error that the lab can switch off, one at a time.

/** @type {[string, (settings: Record<string, any>) => any][]} words, and the changes without the cause, if any */
const CAUSES = [
  ["with y1 and y2 measured", ({ outputs }) => outputs.length < 2 && { outputs: ["y1", "y2"] }],
  ["without noise", ({ noise }) => noise.size > 0 && { noise: { ...noise, size: 0 } }],
  ["with the bias of noise taken out", ({ gains, noise, observers }) => {
    const variance = noise.kind === "uniform" ? noise.size ** 2 / 3 : noise.size ** 2;
    const biased = variance > 0 ? observers.filter((name) => gains[name].noise_variance === 0) : [];
    return withGains(gains, biased, () => ({ noise_variance: variance }));
  }],
  ["with a bound of 100/m instead", ({ gains, observers }) =>
    withGains(gains, observers.filter((name) => gains[name].bound < 100), () => ({ bound: 100 }))],
  ["with half the gain", scaled(0.5)],
  ["with twice the gain", scaled(2)],
  ["started at the first sample", ({ start }) => start.mode !== "own" && { start: { ...start, mode: "own" } }],
  ["with the exact signal between samples", ({ hold }) => hold !== "exact" && { hold: "exact" }],
  ["with no sample lost", ({ dropout }) => dropout > 0 && { dropout: 0 }],
  ["with the true motion believed", ({ believed }) => believed && { believed: null }],
];

/** Changes of some observers' gains, if there are any. */
function withGains(gains, names, change) {
  const changed = names.map((name) => [name, { ...gains[name], ...change(gains[name]) }]);
  return names.length > 0 && { gains: { ...gains, ...Object.fromEntries(changed) } };
}

function scaled(factor) {
  return /** @param {Record<string, any>} settings */ ({ gains, observers }) => {
    const chosen = observers.filter((name) => gains[name].gain !== undefined);
    return withGains(gains, chosen, ({ gain }) => ({ gain: factor * gain }));
  };
}

/** Settings that differ by one cause each from those that are shown, with words for it. */
export function causesOf(settings, model) {
  if (settings.scenario in model.recordings) return [];
  return CAUSES.flatMap(([words, without]) => {
    const change = without(settings);
    return change ? [{ words, settings: { ...settings, ...change, kept: null } }] : [];
  });
}
