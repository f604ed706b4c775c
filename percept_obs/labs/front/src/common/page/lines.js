// How lines are told apart: by their dashes as well as by their colours.

import { BOUND, DASHES, FIT, KEPT, QUIET, SOLID } from "./looks.js";

export { BOUND, DASHES, FIT, KEPT, QUIET, SOLID };

/** Width of all lines, in pixels; thin ones while a hand moves, for a page draws wide dashes several times slower. */
export const LINE = 2;
export const MOVING_LINE = 1;

/** How much of a line is seen while the hand picks one out by its colour. */
export function fading({ picked }, colour) {
  return picked && picked !== colour ? 0.12 : 1;
}

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
