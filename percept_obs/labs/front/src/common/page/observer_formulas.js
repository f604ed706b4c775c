// @ts-check
// The equations of a system and of the observers that are chosen for it.

import { switchOf } from "../model/settings.js";
import { FormulaSheet } from "./formulas.js";

/**
 * The panel of equations.  A lab of its own gives two functions:
 *   systemOf(settings, model)  {title, lines} of the system's equations, as MathML
 *   numbersOf(settings)        the present numbers of its letters
 */
export class ObserverFormulas extends FormulaSheet {
  constructor(model, systemOf, numbersOf) {
    super();
    this.shownFor = "";
    this.model = model;
    this.systemOf = systemOf;
    this.numbersOf = numbersOf;
  }

  /** Show the equations of these settings, with their numbers. */
  show(settings) {
    const chosen = settings.observers.map((name) => [name, this.linesOf(settings, name)]);
    const system = this.systemOf(settings, this.model);
    const key = JSON.stringify([system, chosen]);
    if (key !== this.shownFor) {
      this.shownFor = key;
      this.build(system, chosen);
    }
    const motion = this.numbersOf(settings);
    this.putIn((owner, letter) => (settings.gains[owner] ?? motion)[letter]);
  }

  /** An observer's equations, without the terms of gains that are 0. */
  linesOf(settings, name) {
    const equations = this.model.observers[name].equations[switchOf(settings, name)];
    return equations.find(({ zero }) => zero.every((gain) => settings.gains[name][gain] === 0)).lines;
  }

  build(system, chosen) {
    this.clear();
    this.section(system.title, "motion", system.lines);
    for (const [name, lines] of chosen) this.section(`The ${this.model.observers[name].title} observer`, name, lines);
  }
}
