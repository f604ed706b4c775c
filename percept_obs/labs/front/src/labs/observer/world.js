// The world from above, it stands still, and the camera drives; the estimate is a bead on the ray.

import { Box } from "../../draw/box.js";
import { drawCamera, drawCone, drawGround } from "../../draw/map.js";
import { indicesIn } from "../../engine/tables.js";
import { between, valueBetween, within } from "../../engine/between.js";
import { same } from "../../state/settings.js";
import { COPIES } from "../../engine/velocities.js";
import { shapeOf } from "./camera.js";
import { apply, flow, STANDING_THINGS } from "./standing.js";
import { placesOf } from "./place.js";
import { HERE } from "./image.js";
import { metres } from "./told.js";

/** Parts of a run whose ends the map holds. */
const GOAL = 20;
/** Most samples at which the past of an estimate is drawn. */
const PAST = 100;

export function drawWorld(screen, scene, motion, note) {
  const { world: view, seen } = screen;
  const { shown, theme, now, why, ghost } = scene;
  const moving = view.glide(worldGoal(screen, scene, seen), motion);
  view.begin(theme);
  const { width, height } = view;
  const { x, y, scale, frame } = view.mapped(6);
  const [across, ahead] = screen.axes;
  const on = (place) => [x(place[across]), y(place[ahead])];
  drawGround(view, { x, y }, theme);
  if (!screen.resetButton.hidden) view.avoid(width - 62, 27, 62, 27);
  const camera = on(seen.camera);
  const reach = (1.2 * Math.hypot(width, height)) / scale;
  const along = (direction) => {
    const size = reach / Math.max(Math.hypot(direction[across], direction[ahead]), 1e-9);
    return on(seen.inWorld(direction.map((value) => size * value)));
  };
  drawSight(screen, view, camera, along, theme);
  if (seen.simulated) {
    for (const thing of STANDING_THINGS) view.speck(on(thing), 2.5, theme.muted);
  }
  const b = screen.bare ? [0, 0, 0] : seen.motion.b;
  const goal = along(b.map((value) => (seen.toWorld ? -value : value)));
  view.line([camera, goal], theme.warning, { dash: [6, 5] });
  view.avoidLine(camera, goal);
  const share = 60 / Math.max(Math.hypot(goal[0] - camera[0], goal[1] - camera[1]), 60);
  const named = [0, 1].map((c) => camera[c] + share * (goal[c] - camera[c]));
  const heading = { id: "heading", text: "heading", at: named, colour: theme.warning, rank: 7, gap: 4 };
  if (b.some(Boolean)) view.tag({ ...heading, towards: [1, 0] });
  const turn = Math.atan2(along([0, 0, 1])[0] - camera[0], camera[1] - along([0, 0, 1])[1]);
  const ray = along(seen.place);
  view.line([camera, ray], theme.ink, { alpha: 0.75 });
  view.avoidLine(camera, ray);
  drawTicks(view, seen, on, camera, ray, reach, theme, why);
  const samples = pastSamples(scene);
  const maps = samples.map((k) => seen.toWorld?.(shown.time[k]));
  const past = (rows) => pastOf(screen, shown, rows, samples, maps).map(on);
  const colour = theme.lines[seen.run.order];
  if (seen.toWorld) {
    const way = maps.map((map) => on(apply(map, [0, 0, 0])));
    view.line(way, theme.ink, { width: 2, alpha: 0.35 });
    drawBelieved(screen, view, scene, on, colour, way[0]);
  } else if (shown.truth?.length) view.line(past(shown.truth), theme.ink, { width: 1, alpha: 0.35 });
  for (const { run } of seen.beads) view.line(past(run.estimate), theme.lines[run.order], { alpha: 0.4 });
  const point = on(seen.point);
  if (why && seen.truth) drawCopies(view, seen, on, theme);
  drawCamera(view, camera, turn, theme);
  if (ghost && !why) {
    const placeOf = placesOf(screen.lab, ghost);
    const where = between(ghost.time, now);
    const kept = [0, 1, 2].map((c) => valueBetween(ghost.runs[0].estimate, 3, c, where));
    const at = kept[2] > 1e-4 ? on(seen.inWorld(placeOf(kept))) : null;
    if (at) view.ring(...at, 6, theme.kept, 1.5);
    if (at) view.tag({ id: "kept", text: scene.kept, at, colour: theme.kept, rank: 2, gap: 8 });
  }
  if (seen.truth) view.dot(point[0], point[1], 7, theme.ink);
  if (!why) for (const bead of seen.beads) drawBead(view, seen, bead, on, theme);
  if (seen.truth && !why) {
    const text = `true ${metres(Math.hypot(...seen.place))}`;
    view.tag({ id: "true", text, at: point, colour: theme.ink, rank: 1, gap: 11 });
  }
  if (note) view.note(point[0], point[1] + 8, note.text);
  view.end();
  screen.far.stand(seen.movable && seen.truth ? screen.axes.map((k) => seen.point[k]) : null, frame, screen.lab.late);
  return moving;
}

/** The way that the camera has come, as an observer believes that believes another motion. */
function drawBelieved(screen, view, { shown, theme, now }, on, colour, start) {
  const { settings } = shown;
  if (!settings.believed || same(settings.believed, { A: settings.A, b: settings.b })) return;
  const { inWorld } = screen.seen;
  const placeAt = (time) => inWorld(apply(flow(settings.believed, now - time), [0, 0, 0]));
  // Beside the true way, or one would hide the other.
  const way = timesTo({ shown, now }).map((time) => on(placeAt(time)).map((value, c) => value + (c ? 0 : 7)));
  view.line(way, colour, { width: 2, dash: [5, 4] });
  view.tag({ id: "believed", text: "believed way", at: way[0], colour, rank: 2, gap: 5, towards: [1, 0] });
  view.tag({ id: "way", text: "true way", at: start, colour: theme.ink, rank: 2, gap: 5, towards: [-1, 0] });
}

/** Times from the start to the present at which the past is drawn. */
function timesTo({ shown, now }) {
  const [first] = shown.time;
  const count = 60;
  return Array.from({ length: count + 1 }, (_, k) => first + ((now - first) * k) / count);
}

/** Samples up to the present at which the past of states is drawn. */
function pastSamples({ shown: { time }, now }) {
  const [, last] = indicesIn(time, { low: time[0], high: now });
  const every = Math.ceil((last + 1) / PAST);
  return Array.from({ length: Math.floor(last / every) + 1 }, (_, j) => every * j);
}

/** Where rows of states were in the world at these samples. */
function pastOf(screen, { width }, rows, samples, maps) {
  const placeOf = placesOf(screen.lab, screen.lab.shown);
  return samples.map((k, j) => {
    if (!(rows[width * k + 2] > 1e-4)) return [NaN, NaN, NaN];
    const place = placeOf([rows[width * k], rows[width * k + 1], rows[width * k + 2]]);
    return maps[j] ? apply(maps[j], place) : place;
  });
}

function worldGoal(screen, scene, { toWorld, inWorld, place }) {
  const { shown, why, span, chosen } = scene;
  const { settings, truth, time, width } = shown;
  const [from, to] = indicesIn(time, span);
  const placeOf = placesOf(screen.lab, shown);
  const box = new Box();
  const take = (/** @type {number[]} */ place) => box.take(screen.axes.map((k) => place[k]));
  const rows = truth?.length ? truth : chosen.estimate;
  for (let k = 0; k <= GOAL; k++) {
    const sample = Math.round(from + (k * (to - from)) / GOAL);
    const map = toWorld?.(time[sample]);
    const there = (where) => (map ? apply(map, where) : where);
    const stateOf = (table) => [0, 1, 2].map((c) => table[width * sample + c]);
    take(there([0, 0, 0]));
    take(there(placeOf(stateOf(rows))));
    const first = stateOf(chosen.estimate);
    if ((k === 0 || k === GOAL) && first[2] > 0 && 1 / first[2] < 2.1 / stateOf(rows)[2]) take(there(placeOf(first)));
  }
  if (screen.room) take(screen.room);
  if (why) take(inWorld(place.map((value) => 2 * value)));
  if (settings.believed && toWorld) {
    const began = apply(flow(settings.believed, scene.end - time[0]), [0, 0, 0]);
    take(apply(toWorld(scene.end), began));
  }
  const size = screen.world.size ?? { width: 350, height: 300 };
  const [wide, high] = box.size;
  const upwards = Math.max(1.01 * high, 0.05 * wide);
  const scale = Math.min((size.width - 130) / (wide + 0.1 * high), (size.height - 90) / upwards);
  return [...box.middle, Math.max(scale, 1e-6)];
}

/** What the image holds. */
function drawSight(screen, view, camera, along, theme) {
  const { at, width } = screen.image;
  const [c1, , scale] = /** @type {number[]} */ (at);
  const { settings } = screen.lab.shown;
  const { ray } = screen.seen.functions;
  const edges = [-1, 1].map((side) =>
    Array.from(ray([c1 + (side * width) / 2 / scale, 0, ...shapeOf(settings)], new Float64Array(3))),
  );
  if (edges.some((edge) => edge.some(Number.isNaN))) return;
  drawCone(view, camera, edges.map(along), theme);
}

/** The ray is the ruler of the distance: a tick a decimetre or metre, or for more where these would be too near. */
function drawTicks(view, { place, inWorld }, on, camera, end, reach, theme, why) {
  const length = Math.hypot(...place);
  const far = Math.hypot(end[0] - camera[0], end[1] - camera[1]);
  const [nx, ny] = [-(end[1] - camera[1]) / far, (end[0] - camera[0]) / far];
  const step = [0.1, 1, 5, 10, 50, 100, 1000].find((metre) => (metre * far) / reach >= 9) ?? 1e4;
  for (let k = 1; k < 60; k++) {
    const [u, v] = on(inWorld(place.map((value) => (value * k * step) / length)));
    if (u < 0 || v < 0 || u > view.width || v > view.height) continue;
    const half = k % 5 ? 2.5 : 5;
    view.line([[u - nx * half, v - ny * half], [u + nx * half, v + ny * half]], theme.ink, { width: 1, alpha: 0.75 });
    if (!why && (k === 5 || k === 10))
      view.tag({ id: `tick ${k}`, text: `${k * step} m`, at: [u, v], colour: theme.muted, rank: 6, gap: 5 });
  }
}

/** Copies on the ray at other distances. */
function drawCopies(view, { place, inWorld }, on, theme) {
  COPIES.forEach((part, k) => {
    const [u, v] = on(inWorld(place.map((value) => part * value)));
    view.dot(u, v, 5, theme.raised);
    view.ring(u, v, 5, theme.ink, 2);
    const text = HERE[k];
    view.tag({ id: `copy ${k}`, text, at: [u, v], colour: theme.ink, rank: 1, gap: 9, towards: [-1, 0] });
  });
}

/** An estimate, a bead on the ray; an arrow at the rim where it is out of the picture. */
function drawBead(view, { inWorld, place, beads }, { run, guess, ring, chosen }, on, theme) {
  const { width, height } = view;
  const colour = theme.lines[run.order];
  const where = on(inWorld(guess ?? place.map((value) => 1e5 * value)));
  const [u, v] = [within(where[0], 18, width - 18), within(where[1], 18, height - 18)];
  const name = beads.length > 1 ? run.title : "estimate";
  const text = `${name} ${guess ? metres(Math.hypot(...guess)) : "∞"}`;
  const inside = Math.hypot(u - where[0], v - where[1]) < 1;
  if (inside) view.ring(u, v, ring, colour, chosen ? 3.5 : 1.8);
  else {
    const length = Math.hypot(where[0] - u, where[1] - v);
    const [dx, dy] = [(10 * (where[0] - u)) / length, (10 * (where[1] - v)) / length];
    view.arrow([u - dx, v - dy], [2 * dx, 2 * dy], colour, 3);
  }
  const rank = chosen ? 0 : 2;
  view.tag({ id: chosen ? "estimate" : run.name, text, at: [u, v], colour, rank, gap: ring + 2 });
}
