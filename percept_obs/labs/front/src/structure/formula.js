// The structure lab's equations.

import { ObserverFormulas } from "../common/observer_formulas.js";
import { keyOf } from "./kernels.js";

/** Equations of the choice of unknowns and of the observers. */
export class StructureFormulas extends ObserverFormulas {
  systemOf(settings) {
    const { formulas } = this.model.unknowns[keyOf(settings)] ?? { formulas: [] };
    return { title: "What multiplies the unknowns, and what is known", lines: formulas };
  }

  numbersOf({ scale, v_c, v_p, w, ybar }) {
    const named = (letter, values) => values.map((value, i) => [`${letter}${i + 1}`, value]);
    const start = Object.fromEntries([["y1", ybar[0]], ["y2", ybar[1]], ["ybar3", ybar[2]]]);
    return { d_s: scale, ...start, ...Object.fromEntries([...named("v_c", v_c), ...named("v_p", v_p), ...named("w", w)]) };
  }
}
