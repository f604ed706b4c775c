// Glossary of the structure lab; letters as MathML.

const indexed = (name, index) => `<math><msub><mi>${name}</mi><mi>${index}</mi></msub></math>`;

export const SYMBOLS = [
  [
    `${indexed("y", "1")}, ${indexed("y", "2")}`,
    "where the camera sees the point: image coordinates, in focal lengths",
  ],
  [
    "<math><msub><mover><mi>y</mi><mo>¯</mo></mover><mn>3</mn></msub></math>",
    "the scaled inverse depth: it is measured, but without metres",
  ],
  [indexed("d", "s"), "the scale, in 1/m: d_s ȳ3 is the inverse depth in 1/m"],
  [`${indexed("v", "c")}, ${indexed("v", "p")}`, "velocity of the camera and of the point (the object), in m/s"],
  [indexed("w", "c"), "angular velocity of the camera about its own axes, in rad/s; it is always known"],
  ["<math><mi>θ</mi></math>", "the unknowns in the form in which the equations hold them"],
  [
    "<math><msub><mi>Ω</mi><mi>g</mi></msub></math>",
    "the matrix that multiplies θ in the rate of ȳ; where its determinant is 0, θ cannot be found",
  ],
  ["<math><mi>Ω</mi></math>", "the known part of that rate"],
  ["ISMO", "integral sliding mode observer: it finds the rate of ȳ by switching, then divides by Ωg"],
  ["amplification", "how many times larger an error of the rate is in θ"],
  ["innovation", "what is measured less what the observer expects"],
  ["hold", "what the observer takes for the outputs between two samples"],
];
