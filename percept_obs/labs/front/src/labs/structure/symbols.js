// Glossary of the structure lab; letters as MathML.

import { HOLD, IMAGE, INNOVATION, letter } from "../../ui/symbols.js";

export const SYMBOLS = [
  IMAGE,
  [
    "<math><msub><mover><mi>y</mi><mo>¯</mo></mover><mn>3</mn></msub></math>",
    "the scaled inverse depth: it is measured, but without metres",
  ],
  [letter("d", "s"), "the scale, in 1/m: d_s ȳ3 is the inverse depth in 1/m"],
  [`${letter("v", "c")}, ${letter("v", "p")}`, "velocity of the camera and of the point (the object), in m/s"],
  [letter("w", "c"), "angular velocity of the camera about its own axes, in rad/s; it is always known"],
  ["<math><mi>θ</mi></math>", "the unknowns in the form in which the equations hold them"],
  [
    "<math><msub><mi>Ω</mi><mi>g</mi></msub></math>",
    "the matrix that multiplies θ in the rate of ȳ; where its determinant is 0, θ cannot be found",
  ],
  ["<math><mi>Ω</mi></math>", "the known part of that rate"],
  ["ISMO", "integral sliding mode observer: it finds the rate of ȳ by switching, then divides by Ωg"],
  ["amplification", "how many times larger an error of the rate is in θ"],
  INNOVATION,
  HOLD,
];
