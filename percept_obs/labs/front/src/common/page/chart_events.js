// What happens on a time chart: levels, regions, resets, events, and what lies outside of the scale.

import { readable } from "../model/scales.js";
import { indicesIn } from "../model/timeline.js";
import { stroke } from "./image_frame.js";
import { fading } from "./lines.js";
import { label, RESET, rimMark } from "./marks.js";

/** Pixels of a letter, about; enough to know whether a word has room. */
const LETTER = 6;
const LINE_HEIGHT = 11;

/** A word where no other stands; it may move by a line or two, or stay unsaid. Whether it is said. */
function put(pen, place, text, x, y, align, baseline, colour, theme) {
  const width = LETTER * text.length;
  const left = align === "left" ? x : x - width;
  const away = baseline === "top" ? LINE_HEIGHT : -LINE_HEIGHT;
  for (let row = 0; row < 3; row++) {
    const at = y + row * away;
    const free = place.words.every((word) => left > word.right || left + width < word.left || Math.abs(at - word.y) >= LINE_HEIGHT);
    if (!free) continue;
    place.words.push({ left, right: left + width, y: at });
    pen.textAlign = align;
    pen.textBaseline = baseline;
    label(pen, text, x, at, colour, theme);
    return true;
  }
  return false;
}

export function horizontal(pen, place, value, colour, dash) {
  const y = Math.round(place.y(value)) + 0.5;
  pen.setLineDash(dash);
  pen.strokeStyle = colour;
  stroke(pen, [place.left, y], [place.left + place.width, y]);
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
  rimMark(pen, { at: [place.left + place.width - 12, y], angle: above ? -Math.PI / 2 : Math.PI / 2 }, "", theme.muted, theme);
  pen.textAlign = "right";
  pen.textBaseline = above ? "top" : "bottom";
  label(pen, `tolerance ${readable(level)}`, place.left + place.width - 22, above ? y + 1 : y - 1, theme.muted, theme);
}

/** A time in which something is missing, never thinner than a pixel; with words where they have room. */
export function shade(pen, place, { begin, end, text }, theme, named) {
  const left = Math.max(place.x(begin), place.left);
  const right = Math.min(place.x(end), place.left + place.width);
  if (right < place.left || left > place.left + place.width) return;
  pen.globalAlpha = 0.14;
  pen.fillStyle = theme.warning;
  pen.fillRect(left, place.top, Math.max(1, right - left), place.height);
  pen.globalAlpha = 1;
  if (!named) return;
  const room = left + 3 + LETTER * text.length < place.left + place.width;
  put(pen, place, text, room ? left + 3 : left - 3, place.bottom - 2, room ? "left" : "right", "bottom", theme.warning, theme);
}

/** Which of increasing times is the first that is not before one. */
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
  const right = place.left + place.width;
  marks.forEach(({ times, colour, text }, row) => {
    pen.fillStyle = colour;
    pen.globalAlpha = fading(theme, colour);
    let first = NaN;
    // From each tick on to the first reset of another column: there may be thousands in one.
    for (let k = firstFrom(times, place.timeAt(place.left - 0.5)); k < times.length; ) {
      const x = Math.round(place.x(times[k]));
      if (x > right) break;
      if (Number.isNaN(first)) first = x;
      pen.fillRect(x, place.top, 1, RESET);
      k = Math.max(k + 1, firstFrom(times, place.timeAt(x + 0.5), k));
    }
    pen.globalAlpha = 1;
    if (!named || Number.isNaN(first)) return;
    const room = first + 4 + LETTER * text.length < right;
    put(pen, place, text, room ? first + 4 : first - 4, place.top + RESET + 1 + 11 * row, room ? "left" : "right", "top", colour, theme);
  });
}

/** Something that begins at a time: a short line on the level, with words; an arrow at the rim says that it is later than what is in sight. */
export function drawEvent(pen, place, { time, text, colour }, level, theme) {
  const x = Math.round(place.x(time));
  const right = place.left + place.width;
  const y = Math.min(Math.max(place.y(level), place.top + 6), place.bottom - 6);
  if (x > right) {
    rimMark(pen, { at: [right, y], angle: 0 }, "", colour, theme);
    put(pen, place, `later, at ${text}`, right - 14, y - 1, "right", "bottom", colour, theme);
  }
  if (x < place.left || x > right) return;
  pen.fillStyle = colour;
  pen.fillRect(x - 1, y - 6, 2, 12);
  const room = x + 4 + LETTER * text.length < right;
  put(pen, place, text, room ? x + 4 : x - 4, y - 1, room ? "left" : "right", "bottom", colour, theme);
}

/** An arrow at the rim where a line goes furthest out of the scale, with the value that it reaches there. */
export function drawOutside(pen, place, { time, values, colour }, theme) {
  const { low, high, log } = place.scale;
  const [from, to] = indicesIn(time, place.span);
  let [most, least] = [-1, -1];
  for (let k = from; k <= to; k++) {
    const value = values[k];
    if (value > high && value < Infinity && (most < 0 || value > values[most])) most = k;
    if (value < low && value > -Infinity && !log && (least < 0 || value < values[least])) least = k;
  }
  if (fading(theme, colour) < 1) return;
  for (const [k, y, angle] of [[most, place.top, -Math.PI / 2], [least, place.bottom, Math.PI / 2]]) {
    if (k < 0) continue;
    const x = Math.min(Math.max(place.x(time[k]), place.left + 6), place.left + place.width - 6);
    rimMark(pen, { at: [x, y], angle }, "", colour, theme);
    const text = readable(values[k]);
    const room = x + 10 + LETTER * text.length < place.left + place.width;
    put(pen, place, text, room ? x + 8 : x - 8, angle < 0 ? y + 1 : y - 1, room ? "left" : "right", angle < 0 ? "top" : "bottom", colour, theme);
  }
}

/** The name of a line, where it has one: beside its end in sight, or before that where others stand there. */
export function nameLine(pen, place, { time, values, colour, text }, theme) {
  if (!text || fading(theme, colour) < 1) return;
  const { low, high } = place.scale;
  const [from, to] = indicesIn(time, place.span);
  const right = place.left + place.width - 4;
  let before = Infinity;
  for (let k = to; k >= from; k--) {
    const x = place.x(time[k]);
    if (x > right || before - x < LETTER || !(values[k] > low && values[k] < high)) continue;
    before = x;
    const align = x - LETTER * text.length > place.left ? "right" : "left";
    const y = place.y(values[k]);
    const above = y - LINE_HEIGHT - 4 > place.top;
    if (put(pen, place, text, x, above ? y - 4 : y + 4, align, above ? "bottom" : "top", colour, theme)) return;
  }
}

/** Whether a line has a value in sight that the scale can have. */
export function shows({ time, values }, { span, scale }) {
  const [from, to] = indicesIn(time, span);
  for (let k = from; k <= to; k++) {
    if (time[k] <= span.high && values[k] > (scale.log ? 0 : -Infinity) && values[k] < Infinity) return true;
  }
  return false;
}

/** Why a chart is empty. */
export function sayNothing(pen, place, theme) {
  const text = place.scale.log ? "nothing above 0 in this time" : "no value in this time";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  label(pen, text, place.left + place.width / 2, place.top + place.height / 2, theme.muted, theme);
}

/** A row of thin bars for each colour, from the top on. */
export function drawBars(pen, place, bars) {
  const rows = [...new Set(bars.map(({ colour }) => colour))];
  for (const { begin, end, colour } of bars) {
    pen.fillStyle = colour;
    pen.fillRect(place.x(begin), place.top + 1 + 5 * rows.indexOf(colour), Math.max(1, place.x(end) - place.x(begin)), 3);
  }
}
