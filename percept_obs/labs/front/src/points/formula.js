// The equations of the observer and of the motion, with the numbers that sliders set.

import { FormulaSheet } from "../common/formulas.js";

export class Formulas extends FormulaSheet {
  constructor({ equations }) {
    super();
    for (const { title, lines } of equations) this.section(title, title, lines);
  }

  show(settings) {
    this.putIn((_, letter) => settings[letter]);
  }

  /** Light up a letter wherever it stands. */
  light(letter) {
    for (const node of this.body.querySelectorAll("[data-letter]")) {
      node.classList.toggle("lit", node.dataset.letter === letter);
    }
  }
}
