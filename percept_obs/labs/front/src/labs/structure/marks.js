// What the first screen of the structure lab draws of things: a car from the side and from above, a camera.

import { readable } from "../../draw/scales.js";

/** Outline of a car from the side, in parts of its length: forwards to the left, down. */
const CAR = [
  [-0.5, 0.1], [-0.5, -0.02], [-0.44, -0.06], [-0.27, -0.09], [-0.15, -0.23], [0.2, -0.23], [0.35, -0.08],
  [0.5, -0.05], [0.5, 0.1],
];
const WINDOWS = [
  [[-0.22, -0.1], [-0.13, -0.19], [0, -0.19], [0, -0.1]],
  [[0.04, -0.1], [0.04, -0.19], [0.17, -0.19], [0.25, -0.1]],
];
const [WHEELS, WHEEL] = [[-0.29, 0.29], 0.095];
/** Parts of a car's length that it is wide, and that it is high in the picture. */
export const [WIDE, HIGH] = [0.45, 0.43];

/** A car from the side, of a length in pixels: filled, or as an outline. */
export function carAside(view, /** @type {number[]} */ [x, y], length, colour, { full = true, alpha = 1 } = {}) {
  const pen = view.context;
  const path = (points) => points.forEach(([u, v], k) => (k ? pen.lineTo(u, v) : pen.moveTo(u, v)));
  pen.save();
  pen.globalAlpha = alpha;
  pen.translate(x, y);
  pen.scale(length, length);
  pen.beginPath();
  path(CAR);
  pen.closePath();
  for (const wheel of WHEELS) {
    pen.moveTo(wheel + WHEEL, 0.1);
    pen.arc(wheel, 0.1, WHEEL, 0, 2 * Math.PI);
  }
  if (full) {
    pen.fillStyle = colour;
    pen.fill();
    pen.fillStyle = view.ground();
    for (const glass of WINDOWS) {
      pen.beginPath();
      path(glass);
      pen.fill();
    }
  } else {
    pen.strokeStyle = colour;
    pen.lineWidth = 1 / length;
    pen.stroke();
  }
  pen.restore();
}

/** A car from above, seen by its side from below; labels keep away from it. */
export function carAbove(view, [x, y], length, colour, { full = false, alpha = 1, width = 2 } = {}) {
  const pen = view.context;
  const depth = WIDE * length;
  pen.save();
  pen.globalAlpha = alpha;
  for (const [across, down, fill, line, stroke] of [
    [length, depth, full ? colour : view.ground(), colour, width],
    [0.4 * length, 0.72 * depth, "transparent", full ? view.ground() : colour, 1],
  ]) {
    pen.beginPath();
    pen.roundRect(x - across / 2, y - depth / 2 - down / 2, across, down, 0.2 * Math.abs(down));
    pen.fillStyle = fill;
    pen.fill();
    pen.strokeStyle = line;
    pen.lineWidth = stroke;
    pen.stroke();
  }
  pen.restore();
  view.avoid(x, y - depth / 2, length / 2 + 2, depth / 2 + 2);
}

/** A camera from above that looks up the picture. */
export function cameraAbove(view, [x, y], colour, { full = false, alpha = 1, size = 1 } = {}) {
  const pen = view.context;
  pen.save();
  pen.globalAlpha = alpha;
  pen.translate(x, y);
  pen.scale(size, size);
  pen.fillStyle = full ? colour : view.ground();
  pen.strokeStyle = colour;
  pen.lineWidth = 2 / size;
  pen.beginPath();
  for (const [u, v] of [[-4, 2], [-6, -6], [6, -6], [4, 2]]) pen.lineTo(u, v);
  pen.closePath();
  pen.fill();
  pen.stroke();
  pen.beginPath();
  pen.roundRect(-9, 0, 18, 11, 3);
  pen.fill();
  pen.stroke();
  pen.restore();
  view.avoid(x, y + 3 * size, 11 * size);
}

/** Lengths as they are written. */
export const metres = (value) => `${readable(Number(value.toPrecision(2)))} m`;
