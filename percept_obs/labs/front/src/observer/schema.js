// What the page calls the settings of the observer lab.

import { HOLD, NOISE } from "../common/model/schema.js";

export const WORDS = {
  outputs: { kind: "choice", choices: { "y1+y2": "y1 and y2", y1: "y1 only", y2: "y2 only" } },
  X0: { name: "X0 {}", label: "start {}" },
  normal: { label: "normal {}" },
  noise: NOISE,
  hold: HOLD,
  start: {
    mode: { name: "start", choices: { own: "first sample and 0", zero: "zero", chosen: "chosen values" } },
    values: { name: "start {}", label: "start {}" },
  },
  believed: { A: { label: "Believed A" }, b: { name: "believed {}", label: "believed {}" } },
  pictures: {
    choices: {
      outputs: "image coordinates", inverse: "inverse distance", distance: "distance", error: "error", excitation: "excitation",
    },
  },
};
