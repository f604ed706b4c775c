// What happens on a time chart: levels, regions, resets, events, and what lies outside of the scale.

import { within } from "../engine/between.js";
import { readable } from "../draw/scales.js";
import { indicesIn } from "./timeline.js";
import { opacityOf } from "./line_styles.js";
import { RESET, rimMark, stroke } from "../draw/marks.js";

const [UP, DOWN] = [-Math.PI / 2, Math.PI / 2];
/** How many places of a line may bear its name, from its end on. */
const NAMED = 24;
/** Height of a line of letters in pixels, about. */
const LINE_HEIGHT = 11;

export function horizontal(pen, place, value, colour, dash) {
  const y = Math.round(place.y(value)) + 0.5;
  pen.setLineDash(dash);
  pen.strokeStyle = colour;
  stroke(pen, [place.left, y], [place.right, y]);
}

/** A level such as the tolerance; where the scale does not reach it, an arrow says on which side it lies. */
export function drawLevel(pen, place, level, theme) {
  const { low, high } = place.scale;
  if (level >= low && level <= high) {
    horizontal(pen, place, level, theme.muted, [2, 4]);
    return;
  }
  const above = level > high;
  const y = above ? place.top : place.bottom;
  rimMark(pen, { at: [place.right - 12, y], angle: above ? UP : DOWN }, theme.muted);
  const at = [place.right - 12, above ? y + 7 : y - 7];
  const text = `tolerance ${readable(level)}`;
  place.picture.tag({ id: "tolerance", text, at, towards: [-1, 0], gap: 7, colour: theme.muted, rank: 3 });
}

/** A time in which something is missing, never thinner than a pixel; with words where they have room. */
export function shade(pen, place, { begin, end, text }, theme, named) {
  const left = Math.max(place.x(begin), place.left);
  const right = Math.min(place.x(end), place.right);
  if (right < place.left || left > place.right) return;
  pen.globalAlpha = 0.14;
  pen.fillStyle = theme.warning;
  pen.fillRect(left, place.top, Math.max(1, right - left), place.height);
  pen.globalAlpha = 1;
  if (!named) return;
  const at = [left, place.bottom - 8];
  place.picture.tag({ id: `shade ${begin}`, text, at, towards: [1, 0], gap: 1, colour: theme.warning, rank: 4 });
}

/** Return which of increasing times is the first that is not before one. */
function firstFrom(times, when, low = 0) {
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < when) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Ticks from the top down, one for each column of pixels in which there are resets; how many, once a lab. */
export function drawResets(pen, place, marks, theme, named) {
  marks.forEach(({ times, colour, text }, row) => {
    pen.fillStyle = colour;
    pen.globalAlpha = opacityOf(theme, colour);
    let first = NaN;
    // From each tick on to the first reset of another column: there may be thousands in one.
    for (let k = firstFrom(times, place.timeAt(place.left - 0.5)); k < times.length; ) {
      const x = Math.round(place.x(times[k]));
      if (x > place.right) break;
      if (Number.isNaN(first)) first = x;
      pen.fillRect(x, place.top, 1, RESET);
      k = Math.max(k + 1, firstFrom(times, place.timeAt(x + 0.5), k));
    }
    pen.globalAlpha = 1;
    if (!named || Number.isNaN(first)) return;
    const y = place.top + RESET + 1 + LINE_HEIGHT * row;
    const at = [first, y + LINE_HEIGHT / 2];
    place.picture.tag({ id: `resets ${row}`, text, at, towards: [1, 0], gap: 2, colour, rank: 3 });
  });
}

/** A short line on the level at a time, with words; an arrow at the rim where that is later than what is in sight. */
export function drawEvent(pen, place, { time, text, colour }, level) {
  const x = Math.round(place.x(time));
  const y = within(place.y(level), place.top + 6, place.bottom - 6);
  if (x > place.right) {
    rimMark(pen, { at: [place.right, y], angle: 0 }, colour);
    const label = { id: `event ${colour}`, text: `later, at ${text}`, towards: [-1, 0], gap: 8, colour, rank: 0 };
    place.picture.tag({ ...label, at: [place.right - 6, y] });
  }
  if (x < place.left || x > place.right) return;
  pen.fillStyle = colour;
  pen.fillRect(x - 1, y - 6, 2, 12);
  place.picture.tag({ id: `event ${colour}`, text, at: [x, y], towards: [1, -1], gap: 3, colour, rank: 0 });
}

/** An arrow at the rim where a line goes furthest out of the scale, with the value that it reaches there. */
export function drawOutside(pen, place, { time, values, colour }, theme) {
  if (opacityOf(theme, colour) < 1) return;
  const { low, high, log } = place.scale;
  const [from, to] = indicesIn(time, place.span);
  let [most, least] = [-1, -1];
  for (let k = from; k <= to; k++) {
    const value = values[k];
    if (value > high && value < Infinity && (most < 0 || value > values[most])) most = k;
    if (value < low && value > -Infinity && !log && (least < 0 || value < values[least])) least = k;
  }
  for (const [k, y, angle] of [[most, place.top, UP], [least, place.bottom, DOWN]]) {
    if (k < 0) continue;
    const x = within(place.x(time[k]), place.left + 6, place.right - 6);
    rimMark(pen, { at: [x, y], angle }, colour);
    const label = { id: `outside ${colour} ${angle}`, text: readable(values[k]), towards: [1, 0], gap: 6, colour };
    place.picture.tag({ ...label, at: [x, angle === UP ? y + 7 : y - 7], rank: 1 });
  }
}

/** The name of a line, where it has one: beside its end in sight, or before that where others stand there. */
export function nameLine(place, { time, values, colour, text }, theme) {
  if (!text || opacityOf(theme, colour) < 1) return;
  const { low, high } = place.scale;
  const [from, to] = indicesIn(time, place.span);
  const each = place.width / NAMED;
  const places = /** @type {number[][]} */ ([]);
  let before = Infinity;
  for (let k = to; k >= from; k--) {
    const x = place.x(time[k]);
    if (x > place.right - 4 || before - x < each || !(values[k] > low && values[k] < high)) continue;
    before = x;
    places.push([x, place.y(values[k])]);
  }
  const [at, ...along] = places;
  if (at) place.picture.tag({ id: `line ${text}`, text, at, along, towards: [-1, -1], gap: 4, colour, rank: 1 });
}

/** Return true if a line has a value in sight that the scale can have. */
export function shows({ time, values }, { span, scale }) {
  const [from, to] = indicesIn(time, span);
  for (let k = from; k <= to; k++) {
    if (time[k] <= span.high && values[k] > (scale.log ? 0 : -Infinity) && values[k] < Infinity) return true;
  }
  return false;
}

/** Say why a chart is empty. */
export function sayNothing({ picture, scale, left, right, top, bottom }, lines, theme) {
  const unbounded = lines.some(({ values }) => values.some((/** @type {number} */ value) => value === Infinity));
  const empty = scale.log ? "nothing above 0 in this time" : "no value in this time";
  const text = unbounded ? "infinite in all of this time: no distance was found" : empty;
  picture.write(picture.shortened(text, right - left), (left + right) / 2, (top + bottom) / 2, theme.muted);
}

/** A row of thin bars for each colour, from the top on. */
export function drawBars(pen, place, bars) {
  const rows = [...new Set(bars.map(({ colour }) => colour))];
  for (const { begin, end, colour } of bars) {
    const [left, right] = [begin, end].map((time) => place.x(time));
    pen.fillStyle = colour;
    pen.fillRect(left, place.top + 1 + 5 * rows.indexOf(colour), Math.max(1, right - left), 3);
  }
}
