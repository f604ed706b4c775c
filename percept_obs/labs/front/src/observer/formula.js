// The observer lab's equations.

import { ObserverFormulas } from "../common/observer_formulas.js";
import { keyOf } from "./kernels.js";

/** Equations of the canonical form and of the observers. */
export class Formulas extends ObserverFormulas {
  systemOf(settings) {
    return { title: "What is measured and what is hidden", lines: this.model.forms[keyOf(settings)].formulas };
  }

  numbersOf({ A, b, normal }) {
    return Object.fromEntries([
      ...A.flatMap((row, i) => row.map((value, j) => [`a${i + 1}${j + 1}`, value])),
      ...b.map((value, i) => [`b${i + 1}`, value]),
      ...normal.map((value, i) => [`n${i + 1}`, value]),
    ]);
  }
}
