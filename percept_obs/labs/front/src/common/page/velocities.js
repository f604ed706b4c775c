// Velocities in the image, as arrows: of the point, and of copies elsewhere, which tell why its distance shows or not.

import { readable } from "../model/scales.js";
import { COPIES } from "../model/velocities.js";
import { SOLID } from "./looks.js";
import { arrowMark, disc, label } from "./marks.js";

/** Length of an arrow at the mean speed of the image, as a part of the picture's side. */
const USUAL = 0.16;
const [HEAD, SHORTEST] = [6, 2];
/** Part of an arrow by which others may differ from it and look the same. */
const ALIKE = 0.05;
/** Pixels that a letter is wide, and from one line of text to the next. */
const [LETTER, APART] = [8, 12];
export const NAMES = ["½×", "1×", "2×"];
const MOVING = "at ½×, 1×, 2× distance";
const STILL = "still at every distance";
const SAME = "the same at every distance";

/** @param {{place: number[], velocities: number[][], colour: string}[]} arrows */
export function drawVelocities(pen, frame, arrows, speed, theme) {
  if (!arrows.length) return;
  const seconds = secondsOf(frame, speed);
  arrows.forEach(({ place, velocities, colour }, first) => {
    const from = [frame.x(place[0]), frame.y(place[1])];
    const named = COPIES.flatMap((part, k) => {
      const to = tipOf(frame, place, velocities[k], seconds);
      // Of many points the first one's arrows have names, and all others are alike.
      if (!drawArrow(pen, from, to, part === 1 ? 1 : 0.5, colour) || first > 0) return [];
      const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
      return [{ name: NAMES[k], at: [0, 1].map((i) => to[i] + (11 * (to[i] - from[i])) / length) }];
    });
    for (const { name, x, y, align } of readApart(named.map(({ name, at }) => lettering(name, at, from, frame.box)))) {
      label(pen, name, x, y, colour, theme, align, "middle");
    }
  });
  const still = arrows.every(({ velocities }) => Math.hypot(...velocities.flat()) < 1e-9);
  const same = arrows.every(({ velocities: [near, , far] }) => {
    return Math.hypot(near[0] - far[0], near[1] - far[1]) < ALIKE * Math.hypot(...near);
  });
  caption(pen, frame, arrows, [still ? STILL : same ? SAME : MOVING], theme);
}

/** Where a name stands beside the tip of its arrow, or a joined one inside the picture. */
function lettering(name, at, from, box) {
  const single = name.length < 3;
  const right = !single && at[0] <= from[0] && at[0] >= box.left + 60;
  // What would leave the picture stands above the tip.
  const cut = !single && at[0] < from[0] && !right;
  const [x, y] = cut ? [box.left + 4, at[1] - APART] : at;
  const width = LETTER * name.length;
  const align = single ? "center" : right ? "right" : "left";
  const left = x - { center: width / 2, right: width, left: 0 }[align];
  const again = (more) => lettering(`${name}, ${more}`, at, from, box);
  return { name, at, x, y, ends: [left, left + width], align, again };
}

/** Join names that would cover each other. */
function readApart(named) {
  const covers = (one) => ({ ends, y }) =>
    Math.abs(y - one.y) < APART && ends[0] < one.ends[1] && one.ends[0] < ends[1];
  for (const [k, one] of named.entries()) {
    const other = named.slice(k + 1).find(covers(one));
    if (!other) continue;
    const others = named.filter((each) => each !== other);
    return readApart(others.map((each) => (each === one ? one.again(other.name) : each)));
  }
  return named;
}

/**
 * Points that one image coordinate cannot tell apart: the same value of it, and the same speed along it.
 *
 * @param {import("../../types.js").Alike} alike
 */
export function drawAlike(pen, frame, alike, speed, theme) {
  const { copies, measured, name } = alike;
  const seconds = secondsOf(frame, speed);
  const ends = copies.map(({ place, velocity }) => tipOf(frame, place, velocity, seconds));
  const starts = copies.map(({ place }) => [frame.x(place[0]), frame.y(place[1])]);
  pen.strokeStyle = theme.warning;
  for (const line of [starts, ends]) {
    pen.setLineDash([2, 3]);
    pen.beginPath();
    for (const at of line) pen.lineTo(at[0], at[1]);
    pen.stroke();
  }
  copies.forEach(({ distance, own }, k) => {
    const colour = own ? theme.ink : theme.warning;
    const [x, y] = starts[k];
    drawArrow(pen, starts[k], ends[k], own ? 1 : 0.6, colour);
    disc(pen, x, y, 3, colour);
    const isNear = (copy, i) => copy.own && i !== k && Math.hypot(starts[i][0] - x, starts[i][1] - y) < APART;
    if (copies.some(isNear)) return;
    const away = ends[k][measured] < starts[k][measured] ? 1 : -1;
    const text = `${readable(distance, 2)} m`;
    if (measured === 0) label(pen, text, x + 10 * away, y, colour, theme, away > 0 ? "left" : "right", "middle");
    else label(pen, text, x, y + 10 * away, colour, theme, "center", away > 0 ? "top" : "bottom");
  });
  caption(pen, frame, copies, [`look the same to ${name} now`], theme);
}

/** Seconds that an arrow stands for. */
function secondsOf({ box, scale }, speed) {
  return speed > 0 ? (USUAL * box.side) / (scale * speed) : 0;
}

function tipOf(frame, place, velocity, seconds) {
  return [frame.x(place[0] + seconds * velocity[0]), frame.y(place[1] + seconds * velocity[1])];
}

/** Caption, away from the points, and a line below the words on a copy that swings. */
function caption(pen, { box: { left, top, side }, y }, points, lines, theme) {
  const above = points.some(({ place }) => y(place[1]) > top + 0.7 * side);
  const first = above ? top + 28 : top + side - 6 - 13 * (lines.length - 1);
  lines.forEach((text, k) => label(pen, text, left + 4, first + 13 * k, theme.muted, theme));
}

/** Draw an arrow of a strength, if it is long enough to be seen; return true if it is. */
function drawArrow(pen, from, to, strength, colour) {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (!(length >= SHORTEST && length < Infinity)) return false;
  pen.globalAlpha = strength;
  arrowMark(pen, from, to, { colour, dash: SOLID, width: strength < 1 ? 1.5 : 2.5, head: HEAD });
  pen.globalAlpha = 1;
  return true;
}
