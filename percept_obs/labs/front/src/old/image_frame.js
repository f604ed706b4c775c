// The frame of an image plane: a square with round numbers, axes, and paths in it.

import { linearScale, tickLabel } from "../draw/scales.js";
import { LINE } from "./line_styles.js";
import { endMark, startMark, stroke } from "../draw/marks.js";

/** Room around the square, of which what is written at its left takes more. */
const ROOM = { left: 14, right: 12, top: 12, bottom: 22 };

/** A square around ranges of both coordinates. */
export function squareAround(bounds) {
  const half = 0.58 * Math.max(...bounds.map(([low, high]) => high - low), 0.2);
  const centre = bounds.map(([low, high]) => (low + high) / 2);
  const ticks = centre.map((c) => linearScale(c - half, c + half, 4).ticks.filter((t) => Math.abs(t - c) <= half));
  return { centre, half, ticks };
}

/** Return true if a square shows what another one would: that is not lost in it, and leaves it by a little at most. */
export function showsToo({ centre, half }, wanted) {
  const apart = Math.max(...centre.map((value, i) => Math.abs(value - wanted.centre[i])));
  return apart + wanted.half <= 1.2 * half && wanted.half > 0.4 * half;
}

/** Where a square lies on a picture that has begun, with so much more room at its right. */
export function placed({ context, width, height }, { centre, half, ticks }, more = 0) {
  const widest = Math.max(...["y2", ...ticks[1].map(textOf)].map((text) => context.measureText(text).width));
  const before = ROOM.left + Math.ceil(widest);
  const [across, down] = [width - before - ROOM.right - more, height - ROOM.top - ROOM.bottom];
  const side = Math.min(across, down);
  const box = { left: before + (across - side) / 2, top: ROOM.top + (down - side) / 2, side };
  const [scale, left, top] = [side / (2 * half), box.left + side / 2, box.top + side / 2];
  // Nothing is drawn further off than this, for a canvas would cut it into dashes too.
  const far = 4 * Math.max(width, height);
  return {
    ...{ box, scale, centre, left, top, far },
    x: (y1) => left + clamp((y1 - centre[0]) * scale, far),
    y: (y2) => top - clamp((y2 - centre[1]) * scale, far),
  };
}

export function clipTo(pen, { left, top, side = 0, width = side, height = side }) {
  pen.beginPath();
  pen.rect(left, top, width, height);
  pen.clip();
}

/** Return true if a place lies in a box. */
export function holds({ left, top, side }, /** @type {number[]} */ [x, y]) {
  return x >= left && x <= left + side && y >= top && y <= top + side;
}

/** A box with round numbers at its left and below it, and the names of both axes among them. */
export function drawAxes(picture, frame, ticks, theme) {
  const { left, top, side } = frame.box;
  picture.write("y2", left - 6, top + 6, theme.ink, "right");
  picture.write("y1", left + side, top + side + 11, theme.ink, "right");
  drawTicks(picture, frame, ticks, theme);
}

/** A box with round numbers at its left and below it, as far as they have room beside what is written there. */
export function drawTicks(picture, { box, x, y }, ticks, theme) {
  const { pen } = picture;
  const { left, top, side, width = side, height = side } = box;
  const [right, bottom] = [left + width, top + height];
  const grid = (from, to) => {
    pen.setLineDash([]);
    pen.strokeStyle = theme.grid;
    stroke(pen, from, to);
  };
  for (const [tick, at] of within(ticks[0], x, left, right)) {
    grid([at, top], [at, bottom]);
    picture.write(textOf(tick), at, bottom + 11, theme.muted);
  }
  for (const [tick, at] of within(ticks[1], y, top, bottom)) {
    grid([left, at], [right, at]);
    picture.write(textOf(tick), left - 6, at, theme.muted, "right");
  }
  pen.strokeStyle = theme.line;
  pen.strokeRect(left + 0.5, top + 0.5, width, height);
}

function textOf(tick) {
  return tickLabel(tick, false);
}

/** Ticks with their places, as far as these lie inside. */
function within(ticks, place, low, high) {
  const placed = ticks.map((tick) => [tick, Math.round(place(tick)) + 0.5]);
  return placed.filter(([, at]) => at >= low && at <= high + 1);
}

/** The marks of a path's ends. */
export function drawEnds(pen, rows, width, { x, y }, theme) {
  const end = rows.length - width;
  startMark(pen, x(rows[0]), y(rows[1]), theme);
  endMark(pen, x(rows[end]), y(rows[end + 1]), theme);
}

/** One path of rows of numbers, whose coordinates y1, y2 stand at `first`, with gaps where they are none. */
export function drawPath(pen, rows, { width, first = 0 }, frame, colour, dash) {
  const { scale, centre: [middle1, middle2], left, top, far, lineWidth = LINE } = frame;
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
  pen.lineWidth = lineWidth;
  pen.stroke();
  pen.lineWidth = 1;
}

function clamp(value, bound) {
  return Math.min(Math.max(value, -bound), bound);
}
