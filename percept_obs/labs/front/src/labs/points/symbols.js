// Glossary of the lab of many points; letters as MathML.

import { letter } from "../../ui/symbols.js";

export const SYMBOLS = [
  [letter("x"), "the state: the places of all points, in the camera's frame, in m"],
  [`${letter("r")}, ${letter("d", "k")}`, "the place of the first point, and the offset from it to point k"],
  [`${letter("A")}, ${letter("v")}`, "the motion, known: x' = A(t) x + v(t)"],
  [letter("ρ"), "the error of the estimate, x̂ − x"],
  [letter("P"), "the Lyapunov matrix: the larger, the smaller the correction"],
  [
    `${letter("B", "k")}, ${letter("e", "k")}`,
    "the weight of point k, and its innovation: what is seen less what is expected",
  ],
  [
    "Gramian (14)",
    "what the images in a window of time tell of the state; a smallest eigenvalue of 0 means that a direction of the " +
    "state is not seen",
  ],
  ["(15)", "the inequality that a given P must meet, so that the error never grows"],
  [
    `${letter("α")}, ${letter("β")}, ${letter("γ")}`,
    "how much the camera turns, the body turns, and of the input there is",
  ],
  ["input", "the known part of the camera's velocity; without it no image tells the scale"],
  ["hold", "what the observer takes for the images between two samples"],
];
