// The map of the first screen: worlds from above, one inside of the other, for all cameras begin at one place.

import { within } from "../../engine/between.js";
import { readable, roundStep } from "../../draw/scales.js";
import { speed } from "./sentences.js";
import { TRUE } from "./worlds.js";
import { cameraAbove, carAbove, metres, WIDE } from "./marks.js";

/** Which figure is drawn: the others are 0 and 2. */
const [SMALL, RIGHT, LARGE, ESTIMATE] = [0, 1, 2, 3];
/** Seconds of motion that the length of a velocity's arrow shows, and pixels from a camera's middle to its rim. */
const [AHEAD, RIM] = [1.5, 11];
/** Parts into which a way is divided. */
const PARTS = 40;
/** Pixels that a square of the ground is wide at least. */
const SQUARE = 45;

/** Middle and scale of the map in which all worlds lie. */
export function placeOfMap({ worlds, others, world: view }, { end }) {
  const box = [0, 0, 0, 0];
  const take = ([x, , z], room) => {
    [box[0], box[1]] = [Math.min(box[0], x - room), Math.max(box[1], x + room)];
    [box[2], box[3]] = [Math.min(box[2], z), Math.max(box[3], z + room)];
  };
  for (const world of [...others, TRUE]) {
    for (const part of [0, 0.5, 1]) {
      const { camera, object } = worlds.places(world, worlds.start + part * (end - worlds.start));
      take(camera, 0);
      take(object, (world.size * worlds.length) / 2);
    }
  }
  const { width, height } = view.size ?? { width: 400, height: 300 };
  const scale = Math.min((width - 60) / (box[1] - box[0] + 1e-6), (height - 76) / (box[3] - box[2] + 1e-6));
  return [(box[0] + box[1]) / 2, (box[2] + box[3]) / 2, Math.max(scale, 1 / (box[1] - box[0] + 1))];
}

/** Draw the map, and return the frame of its handles. */
export function drawMap(view, first, scene, note) {
  const { seen, worlds, others: [less, more], stories } = first;
  const { theme, now, why } = scene;
  view.begin(theme);
  const { width } = view;
  const { x, y, scale, frame } = view.mapped(6);
  const on = (place) => [x(place[0]), y(place[2])];
  if (first.moved && !first.questions.open) view.avoid(width - 56, 22, 56, 22);
  drawGround(view, { x, y }, theme);
  drawDirections(view, theme);
  if (seen.free) {
    const which = (value) => on(worlds.places({ ...less, [stories ? "share" : "size"]: value }, now).object);
    const [from, label, to] = (stories ? [0, 0.75, 1.3] : [0.15, 1.4, 2.5]).map(which);
    view.line([from, to], theme.warning, { dash: [2, 5] });
    const text = `any ${stories ? "story" : "size"} fits`;
    if (!why) view.tag({ id: "family", text, at: label, colour: theme.warning, rank: 4, gap: 5, towards: [-1, -0.3] });
  }
  const draw = (world, k, colour) => drawFigure(view, first, { world, k, colour, on, scale }, scene);
  draw(more, LARGE, theme.muted);
  draw(less, SMALL, theme.muted);
  for (const { run, ratio } of seen.known.size ? [] : seen.others) {
    if (Number.isFinite(ratio)) draw({ size: ratio, share: null }, ESTIMATE, theme.lines[run.order]);
  }
  if (Number.isFinite(seen.ratio)) {
    draw({ size: seen.known.size ? 1 : seen.ratio, share: null }, ESTIMATE, theme.lines[seen.run.order]);
  }
  draw(TRUE, RIGHT, theme.ink);
  if (note) {
    const [u, v] = on(worlds.places(TRUE, now).camera);
    view.note(u, v + RIM, note.text);
  }
  view.end();
  return frame;
}

/** Camera, way, cone and car of a world. */
function drawFigure(view, first, figure, scene) {
  const { world, k, colour, on, scale } = figure;
  const { worlds, seen } = first;
  const { now, why } = scene;
  const { camera, object } = worlds.places(world, now);
  const [[cx, cy], [px, py]] = [camera, object].map(on);
  const half = (world.size * worlds.length * scale) / 2;
  const alpha = k !== ESTIMATE && first.against(world)?.off ? 0.45 : 1;
  drawCone(view, [cx, cy], [px, py], half, colour, alpha);
  const past = Array.from({ length: PARTS + 1 }, (_, j) =>
    worlds.places(world, worlds.start + ((now - worlds.start) * j) / PARTS),
  );
  for (const part of ["camera", "object"]) {
    view.line(past.map((there) => on(there[part])), colour, { width: 2, alpha: 0.45 * alpha });
  }
  const look = { full: k === RIGHT, alpha };
  carAbove(view, [px, py], 2 * half, colour, { ...look, width: k === ESTIMATE ? 3 : 2 });
  const wide = within(view.height / 280, 0.6, 1);
  cameraAbove(view, [cx, cy], colour, { ...look, size: wide * within(world.size, 0.6, 1.4) });
  const top = [px, py - WIDE * half];
  const gap = WIDE * half + 7;
  const far = metres(Math.hypot(object[0] - camera[0], object[2] - camera[2]));
  if (why && k !== ESTIMATE) {
    view.tag({ id: `far ${k}`, text: `${far} away`, at: top, colour, rank: 1, gap, towards: [-0.2, -1] });
    const text = `${metres(Math.hypot(...camera))} driven`;
    const middle = on(past[PARTS / 2].camera);
    view.tag({ id: `way ${k}`, text, at: middle, colour, rank: 2, gap: 5, towards: [1, 1] });
  }
  if (why) return;
  drawSpeed(view, first, figure, [cx, cy], scene);
  if (k === ESTIMATE && seen.known.size) return;
  const name = k === ESTIMATE ? "estimate" : first.nameOf(world);
  const metric = k === ESTIMATE || (k === RIGHT && !first.stories);
  const towards = [[-1, -0.5], [0, -1], [0, -1], [1, -0.6]][k];
  const text = metric ? `${name} ${far}` : name;
  view.tag({ id: `world ${k}`, text, at: top, colour, rank: [3, 1, 2, 0][k], gap, towards });
}

function drawCone(view, camera, [px, py], half, colour, alpha) {
  const pen = view.context;
  const edges = [[px - half, py], [px + half, py]];
  pen.beginPath();
  for (const [u, v] of [camera, ...edges]) pen.lineTo(u, v);
  pen.fillStyle = colour;
  pen.globalAlpha = 0.08 * alpha;
  pen.fill();
  pen.globalAlpha = 1;
  for (const edge of edges) view.line([camera, edge], colour, { width: 1, alpha: 0.5 * alpha });
  for (let part = 0.2; part < 1; part += 0.2) {
    view.avoid(camera[0] + part * (px - camera[0]), camera[1] + part * (py - camera[1]), 3 + half * part, 5);
  }
}

/** The camera's velocity; where a part of it is known only that, with what another world would need. */
function drawSpeed(view, first, { world, k, colour, scale }, camera, { now, theme }) {
  const { worlds, seen } = first;
  const { reading, known, told, estimate } = seen;
  const needs = told && !known.size && reading;
  if (k === ESTIMATE && !estimate) return;
  const own = k === ESTIMATE ? estimate.camera : worlds.speeds(world, now).camera;
  const vector = needs ? reading.vector.map((value) => world.size * value) : own;
  const arrow = [AHEAD * scale * vector[0], -AHEAD * scale * vector[2]];
  const length = Math.hypot(...arrow);
  const from = camera.map((value, c) => value + (length > 3 ? (RIM * arrow[c]) / length : 0));
  const off = k !== RIGHT && k !== ESTIMATE && first.against(world)?.off;
  const tint = off && needs ? theme.warning : colour;
  view.arrow(from, arrow, tint, k === ESTIMATE ? 5 : 2);
  const tip = { at: from.map((value, c) => value + arrow[c]), colour: tint, gap: 6, towards: [1, -0.2] };
  const total = speed(Math.hypot(...own));
  if (off && needs) view.tag({ ...tip, id: `need ${k}`, text: first.against(world).text, rank: 4 });
  if (k === RIGHT) {
    const text = needs ? `reads ${speed(reading.value)}` : `camera ${total} m/s`;
    if (told) view.tag({ ...tip, id: "speed", text, rank: 4 });
  }
  if (k === ESTIMATE) view.tag({ ...tip, id: "estimated speed", text: `estimate ${total} m/s`, rank: 1 });
}

/** What ahead and sideways are: all cameras look up the map. */
function drawDirections(view, theme) {
  const [x, y] = [14, view.height - 14];
  view.arrow([x, y], [0, -28], theme.muted, 1.3);
  view.arrow([x, y], [28, 0], theme.muted, 1.3);
  view.write("ahead", x + 8, y - 28, theme.muted, "left");
  view.write("sideways", x + 36, y, theme.muted, "left");
  view.avoid(x + 14, y - 14, 18);
}

/** Lines, and the length of one of their squares. */
function drawGround(view, { x, y }, theme) {
  const { width, height, at: [cx, cz, scale] } = view;
  const step = roundStep(SQUARE / scale);
  const thin = { width: 1, alpha: 0.35 };
  for (let k = Math.ceil((cx - width / scale) / step); k * step < cx + width / scale; k++) {
    view.line([[x(k * step), 0], [x(k * step), height]], theme.line, thin);
  }
  for (let k = Math.ceil((cz - height / scale) / step); k * step < cz + height / scale; k++) {
    view.line([[0, y(k * step)], [width, y(k * step)]], theme.line, thin);
  }
  view.line([[10, 26], [10 + step * scale, 26]], theme.muted, { width: 2 });
  view.write(`${readable(step)} m`, 10 + (step * scale) / 2, 15, theme.muted);
  view.avoid(10 + (step * scale) / 2, 20, (step * scale) / 2, 10);
}
