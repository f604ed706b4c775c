// The frame of an image plane: a square with round numbers, axes, and paths in it.

import { fit } from "./canvas.js";
import { linearScale, tickLabel } from "../model/scales.js";

const EDGE = 34;

/** A square around ranges of both coordinates. */
export function squareAround(bounds) {
  const half = 0.58 * Math.max(...bounds.map(([low, high]) => high - low), 0.2);
  const centre = bounds.map(([low, high]) => (low + high) / 2);
  const ticks = centre.map((c) => linearScale(c - half, c + half, 4).ticks.filter((t) => Math.abs(t - c) <= half));
  return { centre, half, ticks };
}

/** Widen a range so that it holds another one. */
export function widen(range, other) {
  range[0] = Math.min(range[0], other[0]);
  range[1] = Math.max(range[1], other[1]);
}

/** Where a square lies on a picture's canvas, which is made to fit its place. */
export function placed(target, { centre, half }) {
  const { width, height } = fit(target);
  const side = Math.min(width, height) - 2 * EDGE;
  const scale = side / (2 * half);
  const far = 4 * Math.max(width, height);
  return {
    scale,
    far,
    centre,
    left: width / 2,
    top: height / 2,
    box: { left: width / 2 - side / 2, top: height / 2 - side / 2, side },
    x: (y1) => width / 2 + clamp((y1 - centre[0]) * scale, far),
    y: (y2) => height / 2 - clamp((y2 - centre[1]) * scale, far),
  };
}

/** Draw only inside the square. */
export function clipTo(pen, { left, top, side }) {
  pen.beginPath();
  pen.rect(left, top, side, side);
  pen.clip();
}

export function drawAxes(pen, { box, x, y }, ticks, theme) {
  const { left, top, side } = box;
  pen.font = theme.font;
  pen.setLineDash([]);
  pen.strokeStyle = theme.grid;
  pen.fillStyle = theme.muted;
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const tick of ticks[0]) {
    const at = Math.round(x(tick)) + 0.5;
    stroke(pen, [at, top], [at, top + side]);
    pen.fillText(tickLabel(tick, false), at, top + side + 6);
  }
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const tick of ticks[1]) {
    const at = Math.round(y(tick)) + 0.5;
    stroke(pen, [left, at], [left + side, at]);
    pen.fillText(tickLabel(tick, false), left - 6, at);
  }
  pen.strokeStyle = theme.line;
  pen.strokeRect(left + 0.5, top + 0.5, side, side);
  pen.fillStyle = theme.ink;
  pen.textBaseline = "alphabetic";
  pen.textAlign = "left";
  pen.fillText("y2", left - 2, top - 8);
  pen.textAlign = "right";
  pen.fillText("y1", left + side, top + side + 30);
}

function stroke(pen, from, to) {
  pen.beginPath();
  pen.moveTo(...from);
  pen.lineTo(...to);
  pen.stroke();
}

/** One path of rows of numbers, whose coordinates y1, y2 stand at `first`, with gaps where they are none. */
export function drawPath(pen, rows, { width, first = 0 }, { scale, centre, left, top, far }, colour, dash) {
  const [middle1, middle2] = centre;
  // Points closer than a pixel do not show.
  const near = 1.2 / scale;
  pen.beginPath();
  let begun = false;
  let before1 = 0;
  let before2 = 0;
  for (let k = first; k < rows.length; k += width) {
    const y1 = rows[k];
    const y2 = rows[k + 1];
    if (begun && Math.abs(y1 - before1) + Math.abs(y2 - before2) <= near) continue;
    const x = left + clamp((y1 - middle1) * scale, far);
    const y = top - clamp((y2 - middle2) * scale, far);
    if (Number.isNaN(x + y)) {
      begun = false;
      continue;
    }
    if (begun) pen.lineTo(x, y);
    else pen.moveTo(x, y);
    begun = true;
    before1 = y1;
    before2 = y2;
  }
  pen.strokeStyle = colour;
  pen.setLineDash(dash);
  pen.stroke();
}

function clamp(value, bound) {
  return Math.min(Math.max(value, -bound), bound);
}
