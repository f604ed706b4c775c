// Formulas as MathML: letters that a slider sets light up with it, and once more with the present numbers.

import { switchOf } from "../model/settings.js";
import { element } from "./controls.js";
import { readable } from "../model/scales.js";

/** Sections of formulas, each with an owner whose letters it has. */
export class FormulaSheet {
  constructor() {
    this.body = element("div", { class: "formulas" });
    /** @type {{node: Element, owner: string, letter: string}[]} */
    this.numbers = [];
  }

  clear() {
    this.body.replaceChildren();
    this.numbers = [];
  }

  /** Put the present numbers in, each by its owner and its letter. */
  putIn(valueOf) {
    for (const place of this.numbers) {
      const value = valueOf(place.owner, place.letter);
      const text = value === undefined ? "" : value < 0 ? `(${readable(value)})` : readable(value);
      if (place.node.textContent !== text) place.node.textContent = text;
    }
  }

  highlight(owner, letter) {
    for (const node of this.body.querySelectorAll("[data-letter]")) {
      const mine = node.closest("[data-owner]").dataset.owner === owner;
      node.classList.toggle("lit", mine && node.dataset.letter === letter);
    }
  }

  section(title, owner, formulas) {
    const lines = formulas.flatMap((text) => {
      const [inLetters, withNumbers] = ["in-letters", "with-numbers"].map((kind) => element("div", { class: `line ${kind}` }));
      inLetters.innerHTML = withNumbers.innerHTML = `<math displaystyle="true">${text}</math>`;
      this.putNumbers(withNumbers, owner);
      return withNumbers.querySelector("[data-letter]") ? [inLetters, withNumbers] : [inLetters];
    });
    // A wide line scrolls inside its section, which a keyboard must reach for that.
    const attributes = { "data-owner": owner, role: "group", "aria-label": title, tabindex: 0 };
    this.body.append(element("section", attributes, element("h4", {}, title), ...lines));
  }

  putNumbers(line, owner) {
    for (const operator of line.querySelectorAll("mo")) {
      // Between numbers an invisible sign of multiplication would join them.
      if (operator.textContent === "\u2062") operator.textContent = "·";
    }
    for (const marked of line.querySelectorAll("[data-letter]")) {
      const node = document.createElementNS("http://www.w3.org/1998/Math/MathML", "mn");
      const letter = marked.dataset.letter;
      marked.replaceChildren(node);
      this.numbers.push({ node, owner, letter });
    }
  }
}

/** The numbers of rows by letter and place: a1, a2, a3 of {a: [...]}. */
export function lettered(rows) {
  return Object.fromEntries(Object.entries(rows).flatMap(([letter, row]) => row.map((value, i) => [`${letter}${i + 1}`, value])));
}

/**
 * The panel of equations.  A lab of its own gives two functions:
 *   systemOf(settings)   title of the system's equations, and these as MathML
 *   numbersOf(settings)  the present numbers of its letters
 */
export class ObserverFormulas extends FormulaSheet {
  constructor(model, { systemOf, numbersOf }) {
    super();
    this.shownFor = "";
    this.model = model;
    this.systemOf = systemOf;
    this.numbersOf = numbersOf;
  }

  /** Show the equations of these settings, with their numbers. */
  show(settings) {
    const chosen = settings.observers.map((name) => [name, this.linesOf(settings, name)]);
    const system = this.systemOf(settings);
    const key = JSON.stringify([system, chosen]);
    if (key !== this.shownFor) {
      this.shownFor = key;
      this.clear();
      this.section(system[0], "motion", system[1]);
      for (const [name, lines] of chosen) this.section(`The ${this.model.observers[name].title} observer`, name, lines);
    }
    const motion = this.numbersOf(settings);
    this.putIn((owner, letter) => (settings.gains[owner] ?? motion)[letter]);
  }

  /** An observer's equations, without the terms of gains that are 0. */
  linesOf(settings, name) {
    const equations = this.model.observers[name].equations[switchOf(settings, name)];
    return equations.find(({ zero }) => zero.every((gain) => settings.gains[name][gain] === 0)).lines;
  }
}
