// The structure lab's equations: of the choice of unknowns, with the numbers of their letters.

import { keyOf } from "../model/kernels.js";

export function systemOf(settings, model) {
  const { formulas } = model.unknowns[keyOf(settings)] ?? { formulas: [] };
  return { title: "What multiplies the unknowns, and what is known", lines: formulas };
}

export function numbersOf({ scale, v_c, v_p, w, ybar: [y1, y2, ybar3] }) {
  const named = Object.entries({ v_c, v_p, w }).flatMap(([letter, values]) => values.map((value, i) => [`${letter}${i + 1}`, value]));
  return { d_s: scale, y1, y2, ybar3, ...Object.fromEntries(named) };
}
