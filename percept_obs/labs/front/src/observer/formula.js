// The observer lab's equations.

import { Formulas } from "../common/formula.js";
import { keyOf } from "./kernels.js";

/** Equations of the canonical form and of the observers. */
export class ObserverFormulas extends Formulas {
  systemOf(settings) {
    return { title: "What is measured and what is hidden", lines: this.model.structures[keyOf(settings)].formulas };
  }

  numbersOf({ A, b, normal }) {
    return Object.fromEntries([
      ...A.flatMap((row, i) => row.map((value, j) => [`a${i + 1}${j + 1}`, value])),
      ...b.map((value, i) => [`b${i + 1}`, value]),
      ...normal.map((value, i) => [`n${i + 1}`, value]),
    ]);
  }
}
