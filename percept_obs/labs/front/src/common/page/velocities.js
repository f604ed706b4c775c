// Velocities in the image, as arrows: of the point, and of copies elsewhere, which tell why its distance shows or not.

import { readable } from "../model/scales.js";
import { COPIES } from "../model/velocities.js";
import { SOLID } from "./lines.js";
import { arrowMark, label } from "./marks.js";

/** Length of an arrow at the mean speed of the image, as a part of the picture's side. */
const USUAL = 0.16;
const [HEAD, SHORTEST] = [6, 2];
/** Part of an arrow by which others may differ from it and look the same. */
const ALIKE = 0.05;
/** Pixels from one name to the next, across and down, from which on they can be read apart. */
const [WIDE, APART] = [20, 12];
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
    /** @type {{at: number[], name: string}[]} */
    const named = [];
    COPIES.forEach((part, k) => {
      const to = tipOf(frame, place, velocities[k], seconds);
      // Of many points the first one's arrows have names, and all others are alike.
      if (!drawArrow(pen, from, to, part === 1 ? 1 : 0.5, colour) || first > 0) return;
      const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
      const at = [0, 1].map((i) => to[i] + (11 * (to[i] - from[i])) / length);
      const near = named.find((other) => Math.abs(other.at[0] - at[0]) < WIDE && Math.abs(other.at[1] - at[1]) < APART);
      if (near) near.name += `, ${NAMES[k]}`;
      else named.push({ at, name: NAMES[k] });
    });
    for (const { at: [x, y], name } of named) {
      const left = name.length < 3 || x > from[0] || x < frame.box.left + 60;
      pen.textBaseline = "middle";
      pen.textAlign = name.length < 3 ? "center" : left ? "left" : "right";
      // What would leave the picture stands above the tip.
      const cut = name.length > 3 && x < from[0] && left;
      label(pen, name, cut ? frame.box.left + 4 : x, cut ? y - 12 : y, colour, theme);
    }
  });
  const still = arrows.every(({ velocities }) => Math.hypot(...velocities.flat()) < 1e-9);
  const same = arrows.every(({ velocities: [near, , far] }) => Math.hypot(near[0] - far[0], near[1] - far[1]) < ALIKE * Math.hypot(...near));
  caption(pen, frame, arrows.map(({ place }) => place), [still ? STILL : same ? SAME : MOVING], theme);
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
    drawArrow(pen, starts[k], ends[k], own ? 1 : 0.6, own ? theme.ink : theme.warning);
    pen.fillStyle = own ? theme.ink : theme.warning;
    pen.beginPath();
    pen.arc(starts[k][0], starts[k][1], 3, 0, 2 * Math.PI);
    pen.fill();
    const away = ends[k][measured] < starts[k][measured] ? 1 : -1;
    pen.textBaseline = measured === 0 ? "middle" : away > 0 ? "top" : "bottom";
    pen.textAlign = measured === 1 ? "center" : away > 0 ? "left" : "right";
    const beside = [0, 1].map((c) => starts[k][c] + (c === measured ? 10 * away : 0));
    const crowded = copies.some((copy, i) => copy.own && i !== k && Math.hypot(starts[i][0] - starts[k][0], starts[i][1] - starts[k][1]) < APART);
    if (!crowded) label(pen, `${readable(distance, 2)} m`, beside[0], beside[1], own ? theme.ink : theme.warning, theme);
  });
  caption(pen, frame, copies.map(({ place }) => place), [`alike to ${name} alone:`, `same ${name}, same speed along it`], theme);
}

/** Seconds that an arrow stands for. */
function secondsOf({ box, scale }, speed) {
  return speed > 0 ? (USUAL * box.side) / (scale * speed) : 0;
}

function tipOf(frame, place, velocity, seconds) {
  return [frame.x(place[0] + seconds * velocity[0]), frame.y(place[1] + seconds * velocity[1])];
}

/** What is drawn, in words: away from the points, and a line below what is said of a copy that swings. */
function caption(pen, { box: { left, top, side }, y }, places, lines, theme) {
  pen.textAlign = "left";
  pen.textBaseline = "alphabetic";
  const above = places.some((place) => y(place[1]) > top + 0.7 * side);
  const first = above ? top + 28 : top + side - 6 - 13 * (lines.length - 1);
  lines.forEach((text, k) => label(pen, text, left + 4, first + 13 * k, theme.muted, theme));
}

/** An arrow of a strength, if it is long enough to be seen; whether it is. */
function drawArrow(pen, from, to, strength, colour) {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (!(length >= SHORTEST && length < Infinity)) return false;
  pen.globalAlpha = strength;
  arrowMark(pen, from, to, { colour, dash: SOLID, width: strength < 1 ? 1.5 : 2.5, head: HEAD });
  pen.globalAlpha = 1;
  return true;
}
