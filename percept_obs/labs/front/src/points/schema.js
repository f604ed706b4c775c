// @ts-check
// The settings of the lab of many points: their kinds, ranges, choices, units and labels.

import { amount, DROPOUT, HOLDS, listOf, noise, SEED } from "../common/model/schema.js";

const share = (label) => ({ kind: "number", label, low: -2, high: 2, step: 0.05, least: -10, most: 10 });
const P = { kind: "number", log: true, low: 0.001, high: 100, least: 1e-4, most: 1e4 };
const perSecond = { kind: "number", unit: "1/s", low: 0, least: 0, most: 100 };

export const SCHEMA = {
  state: {
    kind: "choice",
    label: "State",
    choices: {
      body: "one rigid body: first point and offsets",
      independent: "points of their own",
      origin: "a body with an unmarked origin",
    },
  },
  points: {
    kind: "points",
    depth: { label: "depth", unit: "m", low: 0.5, high: 6, step: 0.05, above: 0, most: 1000 },
    most: 1000,
  },
  hidden: { kind: "spans", step: 0.5, most: 1000 },
  weight: {
    kind: "choice",
    label: "P is",
    choices: { constant: "constant", scheduled: "scheduled", lyapunov: "Lyapunov", riccati: "Riccati" },
  },
  size: { ...P, label: "P" },
  final: { ...P, label: "P at the end" },
  decrease: { ...perSecond, label: "decrease", high: 0.5, step: 0.005 },
  forgetting: { ...perSecond, label: "forgetting", high: 2, step: 0.02 },
  step: { kind: "number", label: "longest step", unit: "s", log: true, low: 0.002, high: 0.1, least: 1e-3, most: 0.1 },
  turning: share("camera turns"),
  spin: share("body turns"),
  input: share("input"),
  velocity: listOf(["velocity X", "velocity Y", "velocity Z"], (name) => name.replace("velocity", "added to v,"), {
    unit: "m/s", low: -1, high: 1, step: 0.02, least: -1000, most: 1000,
  }),
  start: {
    kind: "choice",
    label: "it starts",
    choices: { rays: "on the first rays", error: "with a given error", zero: "at zero" },
  },
  depth: { kind: "number", label: "at the depth", unit: "m", low: 0.5, high: 6, step: 0.05, least: 0.01, most: 100 },
  error: { kind: "number", label: "error, times the given", low: -3, high: 3, step: 0.05, least: -100, most: 100 },
  noise: noise("noise", { size: amount("bound or σ", 0.05, 0.0005) }),
  seed: SEED,
  period: { kind: "number", label: "period", unit: "s", low: 0.01, high: 0.2, log: true, least: 0.005, most: 1 },
  dropout: DROPOUT,
  view: { kind: "number", label: "sees |y| up to", low: 0.2, high: 4, step: 0.05, least: 0.1, most: 100 },
  hold: { kind: "choice", label: "Hold", choices: HOLDS },
  pictures: {
    kind: "names",
    label: "Time charts",
    choices: { error: "error", depth: "depths", points: "error of each point", gramian: "Gramian" },
  },
  duration: { kind: "number", label: "duration", unit: "s", low: 4, high: 60, step: 1, least: 1, most: 120 },
  window: { kind: "number", label: "window T", unit: "s", low: 0.5, high: 20, step: 0.5, least: 0.1, most: 120 },
};
