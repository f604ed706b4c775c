// The observer lab's equations: of the canonical form, with the numbers of their letters.

import { keyOf } from "../model/kernels.js";

export function systemOf(settings, model) {
  return { title: "What is measured and what is hidden", lines: model.forms[keyOf(settings)].formulas };
}

export function numbersOf({ A, b, normal }) {
  const named = Object.entries({ a1: A[0], a2: A[1], a3: A[2], b, n: normal });
  return Object.fromEntries(named.flatMap(([letter, values]) => values.map((value, i) => [`${letter}${i + 1}`, value])));
}
