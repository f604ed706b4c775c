// Formulas as MathML: letters that a slider sets are highlighted with it, and once more with the present numbers.

import { readable } from "../draw/scales.js";
import { switchOf } from "../state/settings.js";
import { element, formula, setText } from "../draw/dom.js";

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

  /** Set the present numbers, each by its owner and its letter. */
  setNumbers(valueOf) {
    for (const { node, owner, letter } of this.numbers) {
      const value = valueOf(owner, letter);
      setText(node, value === undefined ? "" : value < 0 ? `(${readable(value)})` : readable(value));
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
      const [letters, numbers] = ["in-letters", "with-numbers"].map((kind) =>
        formula("div", text, { class: `line ${kind}` }, true),
      );
      this.replaceLetters(numbers, owner);
      return numbers.querySelector("[data-letter]") ? [letters, numbers] : [letters];
    });
    // A wide line scrolls inside its section, which a keyboard must reach for that.
    const attributes = { "data-owner": owner, role: "group", "aria-label": title, tabindex: 0 };
    this.body.append(element("section", attributes, element("h4", {}, title), ...lines));
  }

  /** Make places for numbers of the letters in a line. */
  replaceLetters(line, owner) {
    for (const operator of line.querySelectorAll("mo")) {
      // Between numbers an invisible sign of multiplication would join them.
      if (operator.textContent === "\u2062") operator.textContent = "·";
    }
    for (const marked of line.querySelectorAll("[data-letter]")) {
      const node = document.createElementNS("http://www.w3.org/1998/Math/MathML", "mn");
      marked.replaceChildren(node);
      this.numbers.push({ node, owner, letter: marked.dataset.letter });
    }
  }
}

/** The numbers of rows by letter and place: a1, a2, a3 of {a: [...]}. */
export function lettered(rows) {
  const entries = Object.entries(rows);
  return Object.fromEntries(entries.flatMap(([letter, row]) => row.map((value, i) => [`${letter}${i + 1}`, value])));
}

/**
 * The panel of equations.  A lab of its own gives two functions:
 *   systemOf(settings)   title of the system's equations, and these as MathML
 *   numbersOf(settings)  the present numbers of its letters
 */
export class ObserverFormulas extends FormulaSheet {
  constructor(model, { systemOf, numbersOf }) {
    super();
    this.model = model;
    this.systemOf = systemOf;
    this.numbersOf = numbersOf;
    this.shownFor = "";
  }

  /** Show the equations of these settings, with their numbers. */
  show(settings) {
    const { observers } = this.model;
    const chosen = settings.observers.map((name) => [name, this.linesOf(settings, name)]);
    const [title, lines] = this.systemOf(settings);
    const key = JSON.stringify([title, lines, chosen]);
    if (key !== this.shownFor) {
      this.shownFor = key;
      this.clear();
      this.section(title, "motion", lines);
      for (const [name, own] of chosen) this.section(`The ${observers[name].title} observer`, name, own);
    }
    const motion = this.numbersOf(settings);
    this.setNumbers((owner, letter) => (settings.gains[owner] ?? motion)[letter]);
  }

  /** An observer's equations, without the terms of gains that are 0. */
  linesOf(settings, name) {
    const equations = this.model.observers[name].equations[switchOf(settings, name)];
    return equations.find(({ zero }) => zero.every((gain) => settings.gains[name][gain] === 0)).lines;
  }
}
