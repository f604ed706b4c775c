// Letters of the glossaries, as MathML.

/** A letter with an index, or without one. */
export function letter(name, index = "") {
  return `<math>${index ? `<msub><mi>${name}</mi><mi>${index}</mi></msub>` : `<mi>${name}</mi>`}</math>`;
}

/** What all labs of single points begin with. */
export const IMAGE = [
  `${letter("y", "1")}, ${letter("y", "2")}`,
  "where the camera sees the point: image coordinates, in focal lengths",
];
export const INNOVATION = ["innovation", "what is measured less what the observer expects"];
export const HOLD = ["hold", "what the observer takes for the outputs between two samples"];
