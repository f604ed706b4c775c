// The equations of the chosen system and observers.

import { FormulaSheet } from "../common/formulas.js";
import { keyOf, switchOf } from "./kernels.js";

/** The panel of equations: of the form, and of each observer. */
export class Formulas extends FormulaSheet {
  constructor(model) {
    super();
    this.model = model;
  }

  /** Show the equations of these settings, with their numbers. */
  show(settings) {
    const chosen = settings.observers.map((name) => [name, this.linesOf(settings, name)]);
    const key = JSON.stringify([keyOf(settings), chosen]);
    if (key !== this.shownFor) {
      this.shownFor = key;
      this.build(settings, chosen);
    }
    const motion = Object.fromEntries([
      ...settings.A.flatMap((row, i) => row.map((value, j) => [`a${i + 1}${j + 1}`, value])),
      ...settings.b.map((value, i) => [`b${i + 1}`, value]),
      ...settings.normal.map((value, i) => [`n${i + 1}`, value]),
    ]);
    this.putIn((owner, letter) => (settings.gains[owner] ?? motion)[letter]);
  }

  /** An observer's equations, without the terms of gains that are 0. */
  linesOf(settings, name) {
    const equations = this.model.observers[name].equations[switchOf(settings, name)];
    return equations.find(({ zero }) => zero.every((gain) => settings.gains[name][gain] === 0)).lines;
  }

  build(settings, chosen) {
    this.clear();
    this.section("What is measured and what is hidden", "motion", this.model.structures[keyOf(settings)].formulas);
    for (const [name, lines] of chosen) this.section(`The ${this.model.observers[name].title} observer`, name, lines);
  }
}
