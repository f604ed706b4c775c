// How lines are told apart: by their dashes as well as by their colours.

/** Dashes of the lines that are compared, in their order. */
export const DASHES = [
  [7, 4], [2, 3], [10, 3, 2, 3], [16, 4], [9, 3, 2, 3, 2, 3], [4, 2, 4, 7], [2, 7], [16, 3, 5, 3], [13, 3, 2, 3, 7, 3],
  [5, 2, 5, 8], [11, 2], [3, 6, 9, 6],
];

/** Width of all lines, in pixels; thin ones while a hand moves, for a page draws wide dashes several times slower. */
export const LINE = 2;
export const MOVING_LINE = 1;

/** How much of a line is seen while the hand picks one out by its colour. */
export function fading({ picked }, colour) {
  return picked && picked !== colour ? 0.12 : 1;
}

export const SOLID = [];
export const KEPT = [1, 3];
export const FIT = [5, 3];
export const BOUND = [1, 5];
export const QUIET = [4, 2];
const NAMED = { truth: SOLID, kept: KEPT, fit: FIT, bound: BOUND, limit: BOUND };

/** How a line looks by its place in the order; without one it is the truth. */
export function lookOf(theme) {
  return (order) => (order === null ? { colour: theme.ink, dash: SOLID } : { colour: theme.lines[order], dash: DASHES[order] });
}

/** A piece of a line, for legends: which is one of those above or the line's place in the order. */
export function swatch(which) {
  const space = "http://www.w3.org/2000/svg";
  const picture = document.createElementNS(space, "svg");
  const line = document.createElementNS(space, "line");
  const dash = NAMED[which] ?? DASHES[which];
  for (const [key, value] of Object.entries({ x1: 0, y1: 4, x2: 36, y2: 4, "stroke-dasharray": dash.join(" ") })) {
    line.setAttribute(key, value);
  }
  picture.setAttribute("class", `swatch swatch-${which}`);
  picture.setAttribute("aria-hidden", "true");
  picture.append(line);
  return picture;
}
