// Formulas as MathML: letters that a slider sets light up with it, and once more with the present numbers.

import { element } from "../common/controls.js";
import { readable } from "../common/scales.js";
import { keyOf, switchOf } from "./kernels.js";

/** The panel of equations: of the form, and of each observer. */
export class Formulas {
  constructor(model) {
    this.model = model;
    this.body = element("div", { class: "formulas" });
    this.shownFor = "";
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
    for (const place of this.numbers) {
      const value = (settings.gains[place.owner] ?? motion)[place.letter];
      const text = value === undefined ? "" : value < 0 ? `(${readable(value)})` : readable(value);
      if (place.node.textContent !== text) place.node.textContent = text;
    }
  }

  /** Light up a letter. */
  highlight(owner, letter) {
    for (const node of this.body.querySelectorAll("[data-letter]")) {
      const mine = node.closest("[data-owner]").dataset.owner === owner;
      node.classList.toggle("lit", mine && node.dataset.letter === letter);
    }
  }

  /** An observer's equations, without the terms of gains that are 0. */
  linesOf(settings, name) {
    const equations = this.model.observers[name].equations[switchOf(settings, name)];
    return equations.find(({ zero }) => zero.every((gain) => settings.gains[name][gain] === 0)).lines;
  }

  build(settings, chosen) {
    this.body.replaceChildren();
    this.numbers = [];
    this.section("What is measured and what is hidden", "motion", this.model.structures[keyOf(settings)].formulas);
    for (const [name, lines] of chosen) this.section(`The ${this.model.observers[name].title} observer`, name, lines);
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
    const space = "http://www.w3.org/1998/Math/MathML";
    for (const operator of line.querySelectorAll("mo")) {
      // Between numbers an invisible sign of multiplication would join them.
      if (operator.textContent === "\u2062") operator.textContent = "·";
    }
    for (const marked of line.querySelectorAll("[data-letter]")) {
      const node = document.createElementNS(space, "mn");
      const letter = marked.dataset.letter;
      marked.replaceChildren(node);
      this.numbers.push({ node, owner, letter });
    }
  }
}
