// Glossary of the observer lab; letters as MathML.

import { HOLD, IMAGE, INNOVATION, letter } from "../../ui/symbols.js";

export const SYMBOLS = [
  IMAGE,
  [letter("y", "3"), "the inverse of the distance, in 1/m: what is sought"],
  ["<math><mover><mi>y</mi><mo>^</mo></mover></math>", "an estimate; the observer's y"],
  [`${letter("A")}, ${letter("b")}`, "the motion of the point against the camera: X' = A X + b"],
  [
    "FOE",
    "focus of expansion: where the translation b points in the image. A point seen there does not move in the image " +
    "because of b, however far it is",
  ],
  [letter("w"), "how fast the image moves for each 1/m of inverse distance; 0 at the FOE"],
  [
    "<math><mi>w</mi><msup><mi>w</mi><mi>T</mi></msup></math>",
    "what one instant tells of the hidden coordinates; its integral is what a window of time tells",
  ],
  [
    "excited",
    "in every window of time the image moves enough to tell what is hidden: the smallest eigenvalue of the integral " +
    "of w wᵀ stays above 0",
  ],
  INNOVATION,
  ["injection", "the innovation, put back into the equations with a weight"],
  ["gain", "how strongly the innovation corrects the estimate"],
  [
    "bound",
    "the Cramer-Rao bound: the least root mean square error that the noise of the samples leaves to any unbiased " +
    "observer, which is one that is right on average",
  ],
  HOLD,
];
