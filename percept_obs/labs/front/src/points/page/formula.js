// The equations of the observer and of the motion, with the numbers that sliders set.

import { FormulaSheet } from "../../common/page/formulas.js";

export class Formulas extends FormulaSheet {
  constructor({ equations }) {
    super();
    for (const { title, lines } of equations) this.section(title, "", lines);
  }

  show(settings) {
    this.putIn((_, letter) => valueOf(settings, letter));
  }
}

function valueOf(settings, letter) {
  const k = ["v1", "v2", "v3"].indexOf(letter);
  return k < 0 ? settings[letter] : settings.velocity[k];
}
