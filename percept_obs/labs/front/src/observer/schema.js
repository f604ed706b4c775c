// @ts-check
// The settings of the observer lab: their kinds, ranges, choices, units and labels.

import { amount, DROPOUT, HOLDS, listOf, noise, SEED } from "../common/model/schema.js";

const FARTHEST = { least: -1000, most: 1000 };
const SPEED = { unit: "m/s", low: -1, high: 1, step: 0.01, ...FARTHEST };
const MATRIX = { kind: "matrix", rows: 3, columns: 3, step: 0.05, ...FARTHEST };
const same = (name) => name;

export const SCHEMA = {
  scenario: { kind: "choice", label: "Scenario" },
  surface: { kind: "choice", label: "Imaging surface" },
  outputs: { kind: "choice", label: "Measured outputs", choices: { "y1+y2": "y1 and y2", y1: "y1 only", y2: "y2 only" } },
  b: listOf(["b1", "b2", "b3"], same, SPEED),
  A: { ...MATRIX, label: "Motion A" },
  X0: listOf(["X0 X", "X0 Y", "X0 Z"], (name) => name.replace("X0", "start"), {
    unit: "m", low: -5, high: 10, step: 0.05, ...FARTHEST,
  }),
  normal: {
    kind: "list",
    entries: ["n1", "n2", "n3"].map((name, k) => ({
      kind: "number", name, label: `normal ${name}`, low: -1, high: 1, step: 0.05, ...FARTHEST, nonzero: k === 2,
    })),
  },
  duration: { kind: "number", label: "duration", unit: "s", low: 2, high: 120, step: 1, least: 0.1, most: 200 },
  noise: noise("Noise", { size: amount("bound or σ", 0.05, 0.0005) }),
  seed: SEED,
  period: { kind: "number", label: "period", unit: "s", low: 0.002, high: 0.2, log: true, least: 0.001, most: 1 },
  dropout: DROPOUT,
  hold: { kind: "choice", label: "Hold", choices: HOLDS },
  start: {
    kind: "group",
    entries: {
      mode: {
        kind: "choice", name: "start", label: "x̂ starts at",
        choices: { own: "first sample and 0", zero: "zero", chosen: "chosen values" },
      },
      values: listOf(["start y1", "start y2", "start y3"], same, { low: -2, high: 2, step: 0.01, ...FARTHEST }),
    },
  },
  believed: {
    kind: "group",
    entries: { b: listOf(["believed b1", "believed b2", "believed b3"], same, SPEED), A: { ...MATRIX, label: "Believed A" } },
  },
  pictures: {
    kind: "names",
    label: "Time charts",
    choices: {
      outputs: "image coordinates",
      inverse: "inverse distance",
      distance: "distance",
      error: "error",
      excitation: "excitation",
    },
  },
  window: { kind: "number", label: "window", unit: "s", low: 0.5, high: 30, step: 0.5, least: 0.1, most: 200 },
  threshold: { kind: "number", label: "threshold of |w|", low: 0, high: 0.5, step: 0.005, least: 0, most: 10 },
};
