// A body as it is drawn: a dart whose nose and wing tips are its three marks, or a polygon through all marks.

import { meet } from "../../draw/labels.js";

/** Names of the copies at other distances; the dashes of a copy. */
export const HERE = ["near, small", "here", "far, large"];
export const DASH = [5, 5];
/** Metres off below which the estimate has no handle, and its arrows no name. */
export const CLOSE = 0.4;
/** Depth before the camera, in metres, below which nothing is drawn. */
export const NEAREST = 0.2;

/** How far the notch between the wings of a dart is from the nose, as a share of the way to each wing. */
const NOTCH = 0.4;

/** Places of the outline of a body with its marks at these places; none for points without a body. */
export function outlineOf(places, state) {
  if (state === "independent" || places.length < 2) return [];
  if (places.length !== 3) return places;
  const [nose, left, right] = places;
  const notch = nose.map((value, i) => value + NOTCH * (left[i] + right[i] - 2 * value));
  return [nose, left, notch, right];
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
  if (corners.length === 4) view.line([corners[0], corners[2]], colour, { dash, alpha: 0.5 });
  corners.forEach((corner, k) => view.avoidLine(corner, closed[k + 1]));
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
