// What happens on a time chart: levels, regions, resets, events, and what lies outside of the scale.

import { within } from "../model/playback.js";
import { readable } from "../model/scales.js";
import { indicesIn } from "../model/timeline.js";
import { opacityOf } from "./line_styles.js";
import { label, RESET, rimMark, stroke } from "./marks.js";

/** Width of a letter and height of a line in pixels, about; enough to know whether a word has room. */
const LETTER = 6;
const LINE_HEIGHT = 11;
const [UP, DOWN] = [-Math.PI / 2, Math.PI / 2];

/** Write a word where no other stands: it may move by a line or two, or is left out.  Return true if it is written. */
function write(pen, place, text, { x, y, align, baseline }, colour, theme) {
  const width = LETTER * text.length;
  const left = align === "left" ? x : x - width;
  const away = baseline === "top" ? LINE_HEIGHT : -LINE_HEIGHT;
  const isFree = (at) => (word) =>
    left > word.right || left + width < word.left || Math.abs(at - word.y) >= LINE_HEIGHT;
  const at = [y, y + away, y + 2 * away].find((height) => place.words.every(isFree(height)));
  if (at === undefined) return false;
  place.words.push({ left, right: left + width, y: at });
  label(pen, text, x, at, colour, theme, align, baseline);
  return true;
}

/** Write a word right of a place, some pixels away from it, or left of it where there is no room. */
function writeBeside(pen, place, text, { x, y, gap = 4, baseline = "bottom" }, colour, theme) {
  const room = x + gap + LETTER * text.length < place.right;
  const at = { x: room ? x + gap : x - gap, y, align: room ? "left" : "right", baseline };
  return write(pen, place, text, at, colour, theme);
}

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
  rimMark(pen, { at: [place.right - 12, y], angle: above ? UP : DOWN }, "", theme.muted, theme);
  const words = `tolerance ${readable(level)}`;
  label(pen, words, place.right - 22, above ? y + 1 : y - 1, theme.muted, theme, "right", above ? "top" : "bottom");
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
  if (named) writeBeside(pen, place, text, { x: left, y: place.bottom - 2, gap: 3 }, theme.warning, theme);
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
    writeBeside(pen, place, text, { x: first, y, baseline: "top" }, colour, theme);
  });
}

/** A short line on the level at a time, with words; an arrow at the rim where that is later than what is in sight. */
export function drawEvent(pen, place, { time, text, colour }, level, theme) {
  const x = Math.round(place.x(time));
  const y = within(place.y(level), place.top + 6, place.bottom - 6);
  if (x > place.right) {
    rimMark(pen, { at: [place.right, y], angle: 0 }, "", colour, theme);
    const at = { x: place.right - 14, y: y - 1, align: "right", baseline: "bottom" };
    write(pen, place, `later, at ${text}`, at, colour, theme);
  }
  if (x < place.left || x > place.right) return;
  pen.fillStyle = colour;
  pen.fillRect(x - 1, y - 6, 2, 12);
  writeBeside(pen, place, text, { x, y: y - 1 }, colour, theme);
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
    rimMark(pen, { at: [x, y], angle }, "", colour, theme);
    const at = angle === UP ? { y: y + 1, baseline: "top" } : { y: y - 1, baseline: "bottom" };
    writeBeside(pen, place, readable(values[k]), { x, gap: 8, ...at }, colour, theme);
  }
}

/** The name of a line, where it has one: beside its end in sight, or before that where others stand there. */
export function nameLine(pen, place, { time, values, colour, text }, theme) {
  if (!text || opacityOf(theme, colour) < 1) return;
  const { low, high } = place.scale;
  const [from, to] = indicesIn(time, place.span);
  let before = Infinity;
  for (let k = to; k >= from; k--) {
    const x = place.x(time[k]);
    if (x > place.right - 4 || before - x < LETTER || !(values[k] > low && values[k] < high)) continue;
    before = x;
    const align = x - LETTER * text.length > place.left ? "right" : "left";
    const y = place.y(values[k]);
    const above = y - LINE_HEIGHT - 4 > place.top;
    const at = { x, y: above ? y - 4 : y + 4, align, baseline: above ? "bottom" : "top" };
    if (write(pen, place, text, at, colour, theme)) return;
  }
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
export function sayNothing(pen, place, lines, theme) {
  const unbounded = lines.some(({ values }) => values.some((/** @type {number} */ value) => value === Infinity));
  const empty = place.scale.log ? "nothing above 0 in this time" : "no value in this time";
  const text = unbounded ? "infinite in all of this time: no distance was found" : empty;
  const [x, y] = [(place.left + place.right) / 2, (place.top + place.bottom) / 2];
  label(pen, text, x, y, theme.muted, theme, "center", "middle");
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
