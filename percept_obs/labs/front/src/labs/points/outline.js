// A body as it is drawn: an aeroplane whose nose and wing tips are its three marks, or a polygon through all marks.

import { meet } from "../../draw/labels.js";
import { isPlane } from "./sentences.js";

/** Names of the copies at other distances; the dashes of a copy. */
export const HERE = ["near, small", "here", "far, large"];
export const DASH = [5, 5];
/** Metres off below which the estimate has no handle, and its arrows no name. */
export const CLOSE = 0.4;
/** Depth before the camera, in metres, below which nothing is drawn. */
export const NEAREST = 0.2;

/**
 * Half of the outline of an aeroplane, from nose to tail: parts of the way from between its wing tips to the nose, and
 * of the way to the left wing tip.  The marks are at [1, 0] and [0, 1].
 */
const HALF = [
  [1, 0], [0.83, 0.08], [0.39, 0.1], [0.09, 1], [-0.13, 1], [0.03, 0.1], [-0.44, 0.06], [-0.58, 0.36], [-0.72, 0.36],
  [-0.65, 0],
];
const PLANE = [...HALF, ...HALF.slice(1, -1).reverse().map(([ahead, left]) => [ahead, -left])];

/** Places of the outline of points with their marks at these places; none for points without a body. */
export function outlineOf(places, settings) {
  if (settings.state === "independent" || places.length < 2) return [];
  if (!isPlane(settings)) return places;
  const [nose, left, right] = places;
  const middle = middleOf([left, right]);
  return PLANE.map(([ahead, aside]) =>
    middle.map((value, i) => value + ahead * (nose[i] - value) + (aside * (left[i] - right[i])) / 2),
  );
}

/** Draw a closed outline; labels keep away from it. */
export function drawOutline(view, corners, colour, { width = 1.5, fill = 0, dash = /** @type {number[]} */ ([]) }) {
  if (!corners.length || corners.some(([x, y]) => Number.isNaN(x + y))) return;
  const pen = view.context;
  const closed = [...corners, corners[0]];
  if (fill) {
    pen.beginPath();
    for (const [x, y] of corners) pen.lineTo(x, y);
    pen.fillStyle = colour;
    pen.globalAlpha = fill;
    pen.fill();
    pen.globalAlpha = 1;
  }
  view.line(closed, colour, { width, dash });
  corners.forEach((corner, k) => view.avoidLine(corner, closed[k + 1]));
}

/** Draw an arrow from which labels keep away along all of its length. */
export function drawPull(view, from, way, colour) {
  view.arrow(from, way, colour, 1.8);
  view.avoidLine(from, [from[0] + way[0], from[1] + way[1]]);
}

/** Draw a mark with its number, or one that is hidden. */
export function drawMark(view, [x, y], number, hidden, theme) {
  if (Number.isNaN(x + y)) return;
  const pen = view.context;
  const box = [x - 5, y - 7, x + 5, y + 7];
  view.dot(x, y, 8, hidden ? theme.warning : theme.ink);
  if (hidden) view.dot(x, y, 6, theme.raised, 0);
  if (view.cut(box, 1) || view.texts.some((other) => meet(box, other.box))) return;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillStyle = hidden ? theme.warning : theme.paper;
  pen.fillText(String(number), x, y + 0.5);
  view.report(String(number), box);
}

/** Middle of some places. */
export function middleOf(places) {
  return places[0].map((_, i) => places.reduce((sum, place) => sum + place[i], 0) / places.length);
}
