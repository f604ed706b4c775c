// @ts-check
// The settings of the structure lab: their kinds, ranges, choices, units and labels.

import { amount, HOLDS, listOf, noise, SEED } from "../common/model/schema.js";

const FARTHEST = { least: -1000, most: 1000 };
const SPEED = { unit: "m/s", low: -1, high: 1, step: 0.01, ...FARTHEST };
const SWING = { ...SPEED, low: -0.5, high: 0.5 };
const IMAGE = { low: -1, high: 1, step: 0.01, ...FARTHEST };
const named = (which) => [1, 2, 3].map((axis) => `${which}${axis}`);
const swing = (name) => name.replace("swing", "swing of");

export const SCHEMA = {
  scale: { kind: "number", label: "true d_s", unit: "1/m", low: 0.5, high: 50, log: true, least: 1e-3, most: 1e3 },
  v_c: listOf(named("v_c"), (name) => `camera ${name}`, SPEED),
  v_p: listOf(named("v_p"), (name) => `object ${name}`, SPEED),
  rate: { kind: "number", label: "at a rate of", unit: "rad/s", low: 0, high: 1, step: 0.01, least: 0, most: 10 },
  v_c_swing: listOf(named("swing v_c"), swing, SWING),
  v_p_swing: listOf(named("swing v_p"), swing, SWING),
  ybar: {
    kind: "list",
    entries: [
      { kind: "number", name: "start y1", label: "start y1", ...IMAGE },
      { kind: "number", name: "start y2", label: "start y2", ...IMAGE },
      { kind: "number", name: "start ybar3", label: "start ȳ3", low: 0.005, high: 1, log: true, above: 0, most: 1000 },
    ],
  },
  w: listOf(named("w"), (name) => `turning ${name}`, { unit: "rad/s", low: -0.5, high: 0.5, step: 0.01, ...FARTHEST }),
  noise: noise("Noise", { size: amount("in y1, y2", 1e-3, 5e-6), depth: amount("in ȳ3", 1e-4, 5e-7) }),
  bias: { kind: "number", label: "bias of ȳ3", low: -0.01, high: 0.01, step: 1e-4, least: -1, most: 1 },
  drift: { kind: "number", label: "drift of ȳ3", unit: "1/s", low: -0.001, high: 0.001, step: 1e-5, least: -1, most: 1 },
  seed: SEED,
  period: { kind: "number", label: "period", unit: "s", low: 1e-4, high: 0.1, log: true, least: 1e-4, most: 1 },
  duration: { kind: "number", label: "duration", unit: "s", low: 1, high: 60, step: 0.5, least: 0.1, most: 100 },
  start: { kind: "choice", label: "ŷ starts at", choices: { own: "the first sample", zero: "zero" } },
  hold: { kind: "choice", label: "Hold", choices: HOLDS },
  step: { kind: "number", label: "longest step", unit: "s", low: 1e-4, high: 0.01, log: true, least: 1e-5, most: 0.1 },
  tolerance: { kind: "number", label: "tolerance", low: 1e-4, high: 1, log: true, least: 1e-6, most: 10 },
  pictures: {
    kind: "names",
    label: "Time charts",
    choices: {
      unknowns: "the unknowns",
      error: "error",
      image: "image coordinates",
      depth: "scaled inverse depth",
      innovation: "innovation",
      determinant: "determinant",
      range: "range",
    },
  },
};
