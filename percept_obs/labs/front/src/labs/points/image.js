// What the camera sees, on the first screen: a body, and its estimate pulled on to the rays of the marks.

import { Box } from "../../draw/box.js";
import { derived } from "../../engine/derived.js";
import { within } from "../../engine/between.js";
import { imageVelocities } from "../../engine/velocities.js";
import { motionAt } from "./motion.js";
import { CLOSE, DASH, drawMark, drawOutline, drawPull, HERE, middleOf, NEAREST, outlineOf } from "./outline.js";

/** Image coordinates of more than this are not looked at. */
const MOST = 1.5;

export function drawImage(screen, scene, motion, note) {
  const { image: view } = screen;
  const { theme, shown, why } = scene;
  const seen = screen.look(scene);
  const moving = view.glide(imageGoal(view, scene), motion);
  view.begin(theme);
  const { width, height } = view;
  const { x, y, frame } = view.mapped(8);
  const on = ([X, Y, Z]) => (Z > NEAREST ? [x(X / Z), y(Y / Z)] : [NaN, NaN]);
  view.avoid(width - 44, height - 27, 44, 27);
  const blue = theme.lines[0];
  const draw = (places, colour, look) => drawOutline(view, outlineOf(places, shown.settings).map(on), colour, look);
  const at = seen.places.map(on);
  draw(seen.places, theme.ink, { fill: why ? 0.06 : 0.14 });
  if (seen.copy) draw(seen.copy, theme.muted, { width: 2, dash: DASH });
  if (seen.sees) {
    draw(seen.found, blue, { width: 2.5, fill: 0.1 });
    const tips = seen.found.map(on);
    const ways = tips.map((tip, k) => tip.map((value, c) => at[k][c] - value));
    const lengths = ways.map((way, k) => (seen.hidden[k] ? 0 : Math.hypot(...way) || 0));
    tips.forEach(([u, v], k) => {
      if (Number.isNaN(u + v)) return;
      view.ring(u, v, 4.5, blue, 2);
      const part = 1 - 10 / lengths[k];
      if (!(part > 0)) return;
      drawPull(view, [u, v], ways[k].map((value) => value * part), blue);
      const middle = [u + 0.5 * ways[k][0], v + 0.5 * ways[k][1]];
      const pull = { id: "pull", text: "pull to its ray", at: middle, colour: blue, rank: 4, gap: 5 };
      if (part > 0.6 && lengths[k] === Math.max(...lengths)) view.tag(pull);
    });
    if (seen.off > CLOSE)
      view.tag({ id: "estimate", text: "estimate", at: middleOf(tips), colour: blue, rank: 1, gap: 14 });
  }
  if (why) drawWhy(view, scene, screen.lab, at[0]);
  at.forEach((place, k) => {
    drawMark(view, place, k + 1, seen.hidden[k], theme);
    const named = { id: `mark ${k}`, text: "hidden", at: place };
    if (seen.hidden[k]) view.tag({ ...named, colour: theme.warning, rank: 2, gap: 10 });
  });
  const middle = { at: middleOf(at), gap: 14 };
  if (seen.prelude) {
    view.tag({ id: "still", text: "this picture stands still", ...middle, colour: theme.muted, rank: 2 });
  } else if (!why) {
    view.tag({ id: "body", text: "body", ...middle, colour: theme.ink, rank: 3 });
  }
  if (note) view.note(at[0][0], at[0][1] + 8, note.text);
  view.end();
  screen.marks.forEach((mark, k) => {
    const place = seen.places[k];
    const there = place && place[2] > NEAREST;
    mark.stand(there ? [place[0] / place[2], place[1] / place[2]] : null, frame, screen.lab.late);
  });
  return moving || (seen.prelude && screen.clock.begun);
}

/** How the first mark moves in the image, and how it would if all were half or twice as far and as large. */
function drawWhy(view, { shown, at }, lab, from) {
  const { place, velocityAt } = motionAt(lab, shown, at)(0);
  const speeds = imageVelocities(place, velocityAt, ([X, Y, Z]) => [X / Z, Y / Z]).map(([u, v]) => [u, -v]);
  const longest = Math.max(...speeds.map((v) => Math.hypot(...v)), 1e-9);
  const [u0, v0] = speeds[0];
  const room = Math.min(
    (u0 < 0 ? from[0] : view.width - from[0]) / (Math.abs(u0) + 1e-9),
    (v0 < 0 ? from[1] : view.height - from[1]) / (Math.abs(v0) + 1e-9),
  );
  const size = Math.min((0.4 * view.width) / longest, 0.8 * room);
  view.copies(from, speeds.map((velocity) => velocity.map((value) => size * value)), HERE);
}

/** Middle and scale of the image in which the body and the first of the estimate lie. */
function imageGoal(view, { shown }) {
  const box = derived(shown.estimate, "image box", () => {
    const found = new Box();
    const { time, points } = shown;
    const take = (images, sample) => {
      for (let k = 0; k < points; k++) {
        found.take([0, 1].map((c) => within(images[2 * (sample * points + k) + c], -MOST, MOST)));
      }
    };
    for (let part = 0; part <= 1; part += 0.025) take(shown.images, Math.round(part * (time.length - 1)));
    for (const part of [0, 0.1, 0.2]) take(shown.estimated.images, Math.round(part * (time.length - 1)));
    return found;
  });
  const { width, height } = view.size ?? { width: 400, height: 300 };
  const [wide, high] = box.size;
  return [...box.middle, Math.min((width - 70) / (wide + 0.02), (height - 90) / (high + 0.02))];
}
