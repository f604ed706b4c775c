// What the page calls the settings of the lab of many points.

import { HOLD, NOISE } from "../common/model/schema.js";

export const WORDS = {
  state: {
    choices: {
      body: "one rigid body: first point and offsets",
      independent: "points of their own",
      origin: "a body with an unmarked origin",
    },
  },
  points: { depth: { label: "depth", unit: "m", low: 0.5, high: 6, step: 0.05, above: 0 } },
  hidden: { step: 0.5 },
  weight: { choices: { constant: "constant", scheduled: "scheduled", lyapunov: "Lyapunov", riccati: "Riccati" } },
  velocity: { name: "velocity {}", label: "added to v, {}" },
  start: { choices: { rays: "on the first rays", error: "with a given error", zero: "at zero" } },
  noise: NOISE,
  hold: HOLD,
  pictures: { choices: { error: "error", depth: "depths", points: "error of each point", gramian: "Gramian" } },
};
