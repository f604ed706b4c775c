// Formulas as MathML: letters that a slider sets light up with it, and once more with the present numbers.

import { element } from "./controls.js";
import { switchOf } from "./observer_list.js";
import { readable } from "./scales.js";

/**
 * The panel of equations: those of the system, and of each observer. A lab of its own says in methods of its own:
 *   systemOf(settings)   {title, lines} of the system's equations, as MathML
 *   numbersOf(settings)  the present numbers of its letters
 */
export class Formulas {
  constructor(model) {
    this.model = model;
    this.body = element("div", { class: "formulas" });
    this.shownFor = "";
  }

  /** Show the equations of these settings, with their numbers. */
  show(settings) {
    const chosen = settings.observers.map((name) => [name, this.linesOf(settings, name)]);
    const system = this.systemOf(settings);
    const key = JSON.stringify([system, chosen]);
    if (key !== this.shownFor) {
      this.shownFor = key;
      this.build(system, chosen);
    }
    const motion = this.numbersOf(settings);
    fillNumbers(this.numbers, (place) => (settings.gains[place.owner] ?? motion)[place.letter]);
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

  build(system, chosen) {
    this.body.replaceChildren();
    this.numbers = [];
    this.section(system.title, "motion", system.lines);
    for (const [name, lines] of chosen) this.section(`The ${this.model.observers[name].title} observer`, name, lines);
  }

  section(title, owner, formulas) {
    const lines = formulas.flatMap((text) => {
      const [inLetters, withNumbers] = ["in-letters", "with-numbers"].map((kind) => element("div", { class: `line ${kind}` }));
      inLetters.innerHTML = withNumbers.innerHTML = `<math displaystyle="true">${text}</math>`;
      this.numbers.push(...putNumbers(withNumbers, owner));
      return withNumbers.querySelector("[data-letter]") ? [inLetters, withNumbers] : [inLetters];
    });
    // A wide line scrolls inside its section, which a keyboard must reach for that.
    const attributes = { "data-owner": owner, role: "group", "aria-label": title, tabindex: 0 };
    this.body.append(element("section", attributes, element("h4", {}, title), ...lines));
  }
}

/** Put places for numbers where letters are; fillNumbers() fills them. */
export function putNumbers(line, owner) {
  const space = "http://www.w3.org/1998/Math/MathML";
  for (const operator of line.querySelectorAll("mo")) {
    // Between numbers an invisible sign of multiplication would join them.
    if (operator.textContent === "\u2062") operator.textContent = "·";
  }
  return [...line.querySelectorAll("[data-letter]")].map((marked) => {
    const node = document.createElementNS(space, "mn");
    marked.replaceChildren(node);
    return { node, owner, letter: marked.dataset.letter };
  });
}

/** Fill in the present numbers; what is negative stands in brackets. */
export function fillNumbers(places, valueOf) {
  for (const place of places) {
    const value = valueOf(place);
    const text = value === undefined ? "" : value < 0 ? `(${readable(value)})` : readable(value);
    if (place.node.textContent !== text) place.node.textContent = text;
  }
}
