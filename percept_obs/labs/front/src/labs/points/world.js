// The world from above, on the first screen: a body, its estimate, and the rays on which its marks are seen.

import { Box } from "../../draw/box.js";
import { drawCamera, drawCone, drawGround } from "../../draw/map.js";
import { derived } from "../../engine/derived.js";
import { between, within } from "../../engine/between.js";
import { Body } from "./body.js";
import { metres } from "./sentences.js";
import { CLOSE, DASH, drawMark, drawOutline, drawPull, HERE, middleOf, NEAREST, outlineOf } from "./outline.js";

export function drawWorld(screen, scene, motion, note) {
  const { world: view, seen } = screen;
  const { shown, theme, why, now } = scene;
  const { body } = seen;
  const moving = view.glide(worldGoal(screen, scene), motion);
  view.begin(theme);
  const { width, height } = view;
  const { x, y, frame } = view.mapped(4);
  const on = (place) => /** @type {[number, number]} */ ([x(place[0]), y(place[2])]);
  const seenFrom = (place) => on(body.toWorld(place));
  drawGround(view, { x, y }, theme);
  if (!screen.resetButton.hidden) view.avoid(width - 62, 27, 62, 27);
  const camera = seenFrom([0, 0, 0]);
  const [c1, , zoom] = /** @type {number[]} */ (screen.image.at);
  const edges = [-1, 1].map((side) => seenFrom([(c1 + (side * screen.image.width) / 2 / zoom) * 60, 0, 60]));
  drawCone(view, camera, edges, theme);
  const path = pathOf(screen, scene);
  const past = path.filter(({ time }) => time <= now);
  view.line([...past.map(({ camera: place }) => on(place)), camera], theme.ink, { width: 2, alpha: 0.3 });
  const draw = (places, colour, look) => drawOutline(view, outlineOf(places, shown.settings).map(on), colour, look);
  seen.places.forEach((place, k) => {
    if (seen.hidden[k]) return;
    view.line([camera, seenFrom(place.map((value) => 1.7 * value))], theme.ink, { width: 1, alpha: 0.5 });
    const end = seenFrom(place.map((value) => 1.55 * value));
    if (k === 0) view.tag({ id: "ray", text: "ray 1", at: end, colour: theme.muted, rank: 5, gap: 5 });
  });
  draw(seen.inWorld, theme.ink, { fill: why ? 0.06 : 0.14 });
  const blue = theme.lines[0];
  if (why) {
    for (const [part, text] of [[0.5, HERE[0]], [2, HERE[2]]]) {
      const places = seen.places.map((place) => body.toWorld(place.map((value) => Number(part) * value)));
      draw(places, theme.muted, { dash: DASH });
      const middle = middleOf(places.map(on));
      view.tag({ id: String(text), text: String(text), at: middle, colour: theme.ink, rank: 1, gap: 14 });
    }
  }
  if (seen.copyInWorld) {
    draw(seen.copyInWorld, theme.muted, { width: 2, dash: DASH });
    const [one, other] = [seen.copy, seen.places].map((places) => places[0][2]);
    const text = !seen.prelude ? "same pictures" : one < other ? "nearer and smaller" : "farther and larger";
    const at = on(seen.copyInWorld[seen.held]);
    if (!note) view.tag({ id: "copy", text, at, colour: theme.muted, rank: 1, gap: 12 });
    if (!seen.prelude) view.ring(at[0], at[1], 6, theme.muted, 2);
  }
  if (seen.sees) {
    view.line(past.map(({ found }) => on(found)), blue, { alpha: 0.45 });
    draw(seen.foundInWorld, blue, { width: 2.5, fill: 0.12 });
    seen.found.forEach((place, k) => {
      const at = on(seen.foundInWorld[k]);
      view.ring(at[0], at[1], 4.5, blue, 2);
      const [X, , Z] = seen.places[k];
      // The pull is y Z - (X, Y) of the estimate, in metres: straight across to the ray at its own depth.
      if (seen.hidden[k] || !(place[2] > NEAREST)) return;
      const foot = seenFrom([(X / Z) * place[2], place[1], place[2]]);
      drawPull(view, at, [foot[0] - at[0], foot[1] - at[1]], blue);
    });
    const text = `estimate, ${metres(seen.off)} off`;
    view.tag({ id: "estimate", text, at: middleOf(seen.foundInWorld.map(on)), colour: blue, rank: 0, gap: 16 });
  }
  seen.inWorld.forEach((place, k) => drawMark(view, on(place), k + 1, seen.hidden[k], theme));
  view.tag({ id: "body", text: "body", at: middleOf(seen.inWorld.map(on)), colour: theme.ink, rank: 3, gap: 12 });
  const ahead = seenFrom([0, 0, 1]);
  drawCamera(view, camera, Math.atan2(ahead[0] - camera[0], camera[1] - ahead[1]), theme);
  view.tag({ id: "camera", text: "camera", at: camera, colour: theme.ink, rank: 4, gap: 16 });
  if (note && seen.copyInWorld) {
    const [u, v] = on(seen.copyInWorld[seen.held]);
    view.note(within(u, 10, width - 10), within(v, 10, height - 50) + 8, note.text);
  }
  view.end();
  const first = seen.foundInWorld[0];
  const apart = Math.hypot(first[0] - seen.inWorld[0][0], first[2] - seen.inWorld[0][2]);
  const movable = seen.sees && shown.settings.start === "error" && (apart > CLOSE || screen.lab.held);
  screen.begin.stand(movable ? [first[0], first[2]] : null, frame, screen.lab.late);
  const copy = !seen.prelude && seen.copyInWorld?.[seen.held];
  screen.twin.stand(copy ? [copy[0], copy[2]] : null, frame, screen.lab.late);
  return moving;
}

/** Places in the world of the camera and of the estimate's middle, at some times. */
function pathOf(screen, { shown }) {
  return derived(shown.estimate, "way", () => {
    const { time } = shown;
    const functions = screen.lab.kernels.of(shown.settings);
    return Array.from({ length: 61 }, (_, k) => {
      const when = (k / 60) * (time.at(-1) - time[0]) + time[0];
      const body = new Body(screen.engine, screen.lab.model, shown, functions, between(time, when));
      const [places, found] = [shown.truth, shown.estimate].map((rows) => body.places(body.state(rows)));
      const [there, middle] = [places.map((place) => body.toWorld(place)), body.toWorld(middleOf(found))];
      return { time: when, camera: body.toWorld([0, 0, 0]), places: there, found: middle };
    });
  });
}

function worldGoal(screen, scene) {
  const box = new Box();
  const take = ([x, , z]) => box.take([x, z]);
  for (const { camera, places } of pathOf(screen, scene)) [camera, ...places].forEach(take);
  if (scene.why) screen.seen.places.forEach((place) => take(screen.seen.body.toWorld(place.map((value) => 2 * value))));
  const { copyInWorld, prelude } = screen.seen;
  if (copyInWorld && !prelude && !screen.twin.grip) copyInWorld.forEach(take);
  const { width, height } = screen.world.size ?? { width: 350, height: 300 };
  const [wide, high] = box.size;
  return [...box.middle, Math.min((width - 50) / (wide + 0.5), (height - 60) / (high + 0.5))];
}
