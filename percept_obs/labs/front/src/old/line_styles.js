// How lines are told apart: by their dashes as well as by their colours.

import { svg } from "../ui/dom.js";
import { BOUND, DASHES, FIT, KEPT, SOLID } from "../draw/looks.js";

/** Width of all lines in pixels; thinner while a hand moves, for a page draws wide dashes several times slower. */
export const LINE = 2;
export const MOVING_LINE = 1;

const NAMED = { truth: SOLID, kept: KEPT, fit: FIT, bound: BOUND, limit: BOUND };

/** Opacity of a line: faint while another one is picked. */
export function opacityOf({ picked }, colour) {
  return picked && picked !== colour ? 0.12 : 1;
}

/** Return the style of a line by its observer's place in the order; null is the truth. */
export function styleOf(theme) {
  return (order) =>
    order === null ? { colour: theme.ink, dash: SOLID } : { colour: theme.lines[order], dash: DASHES[order] };
}

/** Sample of a line for a legend, by its name or its observer's place in the order. */
export function swatch(which) {
  const dash = (NAMED[which] ?? DASHES[which]).join(" ");
  const line = svg("line", { x1: 0, y1: 4, x2: 36, y2: 4, "stroke-dasharray": dash });
  return svg("svg", { class: `swatch swatch-${which}`, "aria-hidden": "true" }, line);
}
