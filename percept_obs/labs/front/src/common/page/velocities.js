// Velocities in the image, as arrows: of the point, and of copies nearer and farther, which tell why its distance shows.

import { COPIES } from "../model/velocities.js";
import { SOLID } from "./lines.js";
import { arrowMark, label } from "./marks.js";

/** Length of an arrow at the mean speed of the image, as a part of the picture's side. */
const USUAL = 0.16;
const [HEAD, SHORTEST] = [6, 2];
/** Part of an arrow by which others may differ from it and look the same. */
const ALIKE = 0.05;
const NAMES = ["½", "", "2"];
const MOVING = "arrows: at ½, 1, 2 × distance";
const STILL = "still at every distance: no arrow";
const SAME = "the same arrow at every distance";

/** @param {{place: number[], velocities: number[][], colour: string}[]} arrows */
export function drawVelocities(pen, frame, arrows, speed, theme) {
  if (!arrows.length) return;
  const seconds = speed > 0 ? (USUAL * frame.box.side) / (frame.scale * speed) : 0;
  for (const { place, velocities, colour } of arrows) {
    const from = [frame.x(place[0]), frame.y(place[1])];
    COPIES.forEach((part, k) => {
      const to = [frame.x(place[0] + seconds * velocities[k][0]), frame.y(place[1] + seconds * velocities[k][1])];
      if (Number.isFinite(from[0] + from[1] + to[0] + to[1])) arrow(pen, from, to, part === 1 ? 1 : 0.5, colour, NAMES[k], theme);
    });
  }
  pen.textAlign = "left";
  pen.textBaseline = "alphabetic";
  const still = arrows.every(({ velocities }) => Math.hypot(...velocities.flat()) < 1e-9);
  const same = arrows.every(({ velocities: [near, , far] }) => Math.hypot(near[0] - far[0], near[1] - far[1]) < ALIKE * Math.hypot(...near));
  // Away from the point and its handle, and a line below what is said of a copy that swings.
  const { left, top, side } = frame.box;
  const above = arrows.some(({ place }) => frame.y(place[1]) > top + 0.7 * side);
  label(pen, still ? STILL : same ? SAME : MOVING, left + 4, above ? top + 28 : top + side - 6, theme.muted, theme);
}

function arrow(pen, from, to, strength, colour, name, theme) {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (length < SHORTEST) return;
  pen.globalAlpha = strength;
  arrowMark(pen, from, to, { colour, dash: SOLID, width: strength < 1 ? 1.5 : 2.5, head: HEAD });
  pen.globalAlpha = 1;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  const beyond = [0, 1].map((i) => to[i] + (7 * (to[i] - from[i])) / length);
  label(pen, name, beyond[0], beyond[1], colour, theme);
}
