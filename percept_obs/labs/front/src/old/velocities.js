// Velocities in the image, as arrows: of the point, and of copies elsewhere, which tell why its distance shows or not.

import { readable } from "../draw/scales.js";
import { COPIES } from "../engine/velocities.js";
import { holds } from "./image_frame.js";
import { SOLID } from "../draw/looks.js";
import { arrowMark, disc } from "../draw/marks.js";

/** Length of an arrow at the mean speed of the image, as a part of the picture's side. */
const USUAL = 0.16;
const [HEAD, SHORTEST] = [6, 2];
/** Part of an arrow by which others may differ from it and look the same. */
const ALIKE = 0.05;
/** Pixels within which tips of arrows have one name, and a copy is at the point itself. */
const APART = 12;
export const NAMES = ["½×", "1×", "2×"];
const MOVING = "at ½×, 1×, 2× distance";
const STILL = "still at every distance";
const SAME = "the same at every distance";

/** @param {{place: number[], velocities: number[][], colour: string}[]} arrows */
export function drawVelocities(frame, arrows, speed, theme) {
  if (!arrows.length) return;
  const seconds = secondsOf(frame, speed);
  arrows.forEach(({ place, velocities, colour }, first) => {
    const from = [frame.x(place[0]), frame.y(place[1])];
    const named = COPIES.flatMap((part, k) => {
      const to = tipOf(frame, place, velocities[k], seconds);
      // Of many points the first one's arrows have names, and all others are alike.
      if (!drawArrow(frame.picture, from, to, part === 1 ? 1 : 0.5, colour) || first > 0) return [];
      return holds(frame.box, to) ? [{ name: NAMES[k], at: to }] : [];
    });
    for (const { name, at } of joined(named)) {
      const towards = [0, 1].map((i) => at[i] - from[i]);
      frame.picture.tag({ id: `arrow ${name.slice(0, 2)}`, text: name, at, towards, gap: 2, colour, rank: 2 });
    }
  });
  const still = arrows.every(({ velocities }) => Math.hypot(...velocities.flat()) < 1e-9);
  const same = arrows.every(({ velocities: [near, , far] }) => {
    return Math.hypot(near[0] - far[0], near[1] - far[1]) < ALIKE * Math.hypot(...near);
  });
  frame.picture.caption("arrows", still ? STILL : same ? SAME : MOVING, frame.box, theme.muted, 3);
}

/** Names of arrows whose tips lie together, as one. */
function joined(named) {
  const groups = /** @type {{name: string, at: number[]}[]} */ ([]);
  for (const { name, at } of named) {
    const near = groups.find((group) => Math.hypot(group.at[0] - at[0], group.at[1] - at[1]) < APART);
    if (near) Object.assign(near, { name: `${near.name}, ${name}`, at });
    else groups.push({ name, at });
  }
  return groups;
}

/**
 * Points that one image coordinate cannot tell apart: the same value of it, and the same speed along it.
 *
 * @param {import("../types.js").Alike} alike
 */
export function drawAlike(frame, alike, speed, theme) {
  const { picture, picture: { context: pen } } = frame;
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
    drawArrow(picture, starts[k], ends[k], own ? 1 : 0.6, colour);
    disc(pen, x, y, 3, colour);
    const isNear = (copy, i) => copy.own && i !== k && Math.hypot(starts[i][0] - x, starts[i][1] - y) < APART;
    if (copies.some(isNear)) return;
    const away = ends[k][measured] < starts[k][measured] ? 1 : -1;
    const towards = measured === 0 ? [away, 0] : [0, away];
    picture.avoid(x, y, 4);
    picture.tag({ id: `copy ${k}`, text: `${readable(distance, 2)} m`, at: [x, y], towards, gap: 6, colour, rank: 2 });
  });
  picture.caption("alike", `look the same to ${name} now`, frame.box, theme.muted, 3);
}

/** Seconds that an arrow stands for. */
function secondsOf({ box, scale }, speed) {
  return speed > 0 ? (USUAL * box.side) / (scale * speed) : 0;
}

function tipOf(frame, place, velocity, seconds) {
  return [frame.x(place[0] + seconds * velocity[0]), frame.y(place[1] + seconds * velocity[1])];
}

/** Draw an arrow of a strength, if it is long enough to be seen; return true if it is. */
function drawArrow(picture, from, to, strength, colour) {
  const { context: pen } = picture;
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (!(length >= SHORTEST && length < Infinity)) return false;
  pen.globalAlpha = strength;
  arrowMark(pen, from, to, { colour, dash: SOLID, width: strength < 1 ? 1.5 : 2.5, head: HEAD });
  pen.globalAlpha = 1;
  picture.avoidLine(from, to, picture.busy);
  return true;
}
