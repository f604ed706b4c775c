// What the page calls the settings of the structure lab.

import { HOLD, NOISE } from "../common/model/schema.js";

export const WORDS = {
  v_c: { label: "camera {}" },
  v_p: { label: "object {}" },
  v_c_swing: { name: "swing {}", label: "swing of {}" },
  v_p_swing: { name: "swing {}", label: "swing of {}" },
  ybar: { name: "start {}", label: "start {}" },
  w: { label: "turning {}" },
  noise: NOISE,
  start: { choices: { own: "the first sample", zero: "zero" } },
  hold: HOLD,
  pictures: {
    choices: {
      unknowns: "the unknowns", error: "error", image: "image coordinates", depth: "scaled inverse depth",
      innovation: "innovation", determinant: "determinant", range: "range",
    },
  },
};
