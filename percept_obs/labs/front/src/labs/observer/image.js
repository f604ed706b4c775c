// What the camera sees, the point, how it moves and how it should, and standing things.

import { between, valueBetween, within } from "../../engine/between.js";
import { indicesIn } from "../../engine/tables.js";
import { affine } from "../../engine/velocities.js";
import { expectsAnother, isOut, metres, MOST } from "./sentences.js";
import { apply, STANDING_THINGS } from "./standing.js";
import { claimed } from "./told.js";

export { MOST };

/** Names of the copies at other distances. */
export const HERE = ["half as far", "here", "twice as far"];
/** Part of the image that the path and what is around it take, at least, in a standing world. */
const USUAL = [[-0.8, 0.8], [-0.55, 0.55]];
/** Pixels that the longer arrow of motion has at least where there is one, and from the rim to what points outside. */
const [LEAST, RIM] = [40, 18];

export function drawImage(screen, scene, motion, note) {
  const { image: view } = screen;
  const seen = screen.look(scene);
  const { theme, why } = scene;
  const moving = view.glide(imageGoal(screen, scene, seen), motion);
  view.begin(theme);
  const { width, height } = view;
  const { x, y, scale, frame } = view.mapped(0, seen.up);
  const on = (place) => /** @type {[number, number]} */ ([x(place[0]), y(place[1])]);
  view.avoid(width - 44, height - 27, 44, 27);
  view.plated = view.figure.classList.toggle("filmed", Boolean(seen.film));
  if (seen.film) drawFilm(screen, view, scene, seen, on);
  drawDirections(view, seen, theme);
  const { foe, radius, single } = seen;
  // It would give the answer away.
  if (foe && radius && !screen.questions.asking) {
    view.hatched((pen) => hatchAround(pen, on(foe), radius * scale, single, width, height));
  }
  if (seen.simulated) drawStandingThings(view, scene, seen, on);
  view.line(pathOf(scene).map(on), theme.ink, { width: 1, alpha: seen.simulated ? 0.15 : 0.35 });
  const [px, py] = on(seen.y);
  if (single === 0) view.line([[px, 0], [px, height]], theme.ink, { width: 1, dash: [2, 5] });
  if (single === 1) view.line([[0, py], [width, py]], theme.ink, { width: 1, dash: [2, 5] });
  if (isOut(seen)) drawOut(view, [px, py], theme);
  else if (scene.why || !seen.film) drawArrows(view, scene, seen, [px, py]);
  if (foe && !screen.bare) {
    const [fx, fy] = on(foe);
    view.dot(fx, fy, 9, theme.raised, 0);
    view.ring(fx, fy, 10, theme.warning, 2.5);
    view.line([[fx - 5, fy], [fx + 5, fy]], theme.warning, { width: 2 });
    view.line([[fx, fy - 5], [fx, fy + 5]], theme.warning, { width: 2 });
    view.tag({ id: "foe", text: "focus of expansion", at: [fx, fy], colour: theme.warning, rank: 2, gap: 14 });
  }
  const colour = theme.lines[seen.run.order];
  const [gx, gy] = on(seen.estimate);
  for (const { run, state, ring, chosen } of why ? [] : seen.beads) {
    const at = on(state).map((value, c) => within(value, ring + 1, (c ? height : width) - ring - 1));
    if (seen.film) view.ring(at[0], at[1], ring, theme.raised, 6);
    view.ring(at[0], at[1], ring, theme.lines[run.order], chosen ? 3 : 1.8);
  }
  if (seen.size) view.ring(px, py, seen.size * scale, theme.ink, 2);
  view.dot(px, py, seen.film ? 3 : 6, theme.ink);
  if (seen.film && !why) drawDistances(view, scene, seen, [px, py], colour);
  if (note) view.note(...(note.at === "estimate" ? [gx, gy + 13] : [px, py + 8]), note.text);
  view.end();
  const { late } = screen.lab;
  screen.focus.stand(seen.movable ? foe : null, frame, late);
  screen.point.stand(seen.movable ? seen.y : null, frame, late);
  return moving;
}

/** Where the point is that has left the picture: an arrow at the rim. */
function drawOut(view, [px, py], theme) {
  const [x, y] = [within(px, RIM, view.width - RIM), within(py, RIM, view.height - RIM)];
  const far = Math.hypot(px - x, py - y);
  if (!far) return;
  const [dx, dy] = [(RIM * (px - x)) / far, (RIM * (py - y)) / far];
  view.arrow([x - dx, y - dy], [1.7 * dx, 1.7 * dy], theme.ink, 3);
  view.tag({ id: "out", text: "the point", at: [x - dx, y - dy], colour: theme.ink, rank: 0, gap: 8 });
}

/** Middle and scale of the image in which the path lies. */
function imageGoal(screen, scene, { simulated, film, foe }) {
  const { width, height } = screen.image.size ?? { width: 400, height: 300 };
  if (film) {
    const [left, right, lower, upper] = film.extent;
    const scale = Math.min(width / Math.abs(right - left), height / Math.abs(upper - lower));
    return [(left + right) / 2, (lower + upper) / 2, scale];
  }
  const around = (c) => (foe ? [foe[c], foe[c]] : [Infinity, -Infinity]);
  const bounds = simulated ? USUAL.map((pair) => [...pair]) : [0, 1].map(around);
  for (const place of pathOf(scene)) {
    bounds.forEach((pair, c) => {
      const value = within(place[c], -MOST, MOST);
      if (Number.isNaN(value)) return;
      pair[0] = Math.min(pair[0], value - 0.18);
      pair[1] = Math.max(pair[1], value + 0.18);
    });
  }
  const scales = bounds.map(([low, high], c) => [width, height][c] / (high - low));
  return [...bounds.map(([low, high]) => (low + high) / 2), Math.min(...scales) * (simulated ? 1 : 0.9)];
}

/** The film, and the other tracks that it shows. */
function drawFilm(screen, view, { shown, now, theme }, seen, on) {
  const { recorded: { film, begin }, film: { extent: [left, right, lower, upper] } } = seen;
  const [[west, south], [east, north]] = [on([left, lower]), on([right, upper])];
  screen.film.draw(view.context, film, begin + now, [west, east, south, north]);
  seen.tracks = screen.others(shown.settings, now).map(({ name, y }) => ({ name, at: on(y) }));
  for (const { at } of seen.tracks) view.dot(...at, 3, theme.ink);
}

/** How far the point is, by the estimate and in truth, or as it was measured otherwise. */
function drawDistances(view, { shown, theme, now, at: when }, seen, at, colour) {
  const { other, run, estimate, place, ray, truth } = seen;
  const deviation = run.deviation && valueBetween(run.deviation, shown.width, 2, when);
  const text = claimed(ray, estimate[2], deviation);
  view.tag({ id: "estimate", text, at, colour, rank: 0, gap: 13, towards: [1, -1] });
  const measured = other && `${other.name} ${metres(valueBetween(other.values, 1, 0, between(other.time, now)))}`;
  const second = truth ? `true ${metres(Math.hypot(...place))}` : measured;
  view.tag({ id: "true", text: second, at, colour: theme.ink, rank: 1, gap: 13, towards: [1, 1] });
}

/** The two directions of the image; the one that is not measured is pale. */
function drawDirections(view, { single, up }, theme) {
  const [x, y] = [16, up > 0 ? 56 : 18];
  [[26, 0, "y1", 1], [0, -26 * up, "y2", 0]].forEach(([dx, dy, text, other]) => {
    view.context.globalAlpha = single === other ? 0.3 : 1;
    view.arrow([x, y], [dx, dy], theme.muted, 1.3);
    view.write(text, x + 1.5 * Number(dx), y + 1.5 * Number(dy), theme.muted);
  });
  view.context.globalAlpha = 1;
  view.avoid(36, 36, 36);
}

/** Standing things, each with its way of the last second; of one size, which says nothing of their distance. */
function drawStandingThings(view, { theme }, { motion, image, toCamera }, on) {
  for (const thing of STANDING_THINGS) {
    const place = apply(toCamera, thing);
    if (place[2] < 0.6) continue;
    const there = image(place);
    const at = on(there);
    const inside = at[0] > 3 && at[0] < view.width - 3 && at[1] > 3 && at[1] < view.height - 3;
    if (!inside || (at[0] < 66 && at[1] < 66)) continue;
    const before = on(image(place.map((value, i) => value - affine(motion.A, motion.b, place)[i])));
    const length = Math.hypot(before[0] - at[0], before[1] - at[1]);
    const part = Math.min(1, 50 / length);
    const from = at.map((value, c) => value + part * (before[c] - value));
    view.line([from, at], theme.muted, { alpha: 0.4 });
    view.speck(at, 3, theme.muted);
  }
}

/** How the point moves in the image, and how it would if the estimate were right; or copies at other distances. */
function drawArrows(view, { theme, why, shown: { tolerance } }, seen, at) {
  const { copies, expects, single, run, up } = seen;
  const [px, py] = at;
  if (!copies) return;
  const scale = view.at[2];
  const flip = (/** @type {number[]} */ [u, v]) => [u, -up * v];
  const shown = (why ? copies : [copies[1], expects]).filter(Boolean).map(flip);
  // One scale, whether the copies are shown or not.
  const all = [...copies, expects].filter(Boolean).map(flip);
  const longest = Math.max(...all.map((v) => Math.hypot(...v)), 1e-9) * scale;
  const most = Math.min(4, (Math.min(view.width, view.height) * 0.6) / longest) * scale;
  let size = most;
  for (const velocity of all) {
    const [u, v] = velocity;
    const [across, down] = [u < 0 ? px : view.width - px, v < 0 ? py : view.height - py];
    size = Math.min(size, (across - 14) / Math.abs(u), (down - 14) / Math.abs(v));
  }
  // The names of the directions stand in the corner.
  const inCorner = (/** @type {number[]} */ [u, v]) => px + size * u < 78 && py + size * v < 72;
  while (all.some(inCorner) && size > 1) size *= 0.9;
  const longer = Math.max(...shown.map((v) => Math.hypot(...v)), 1e-9);
  size = Math.max(size, Math.min(most, LEAST / longer));
  const tip = (/** @type {number[]} */ [u, v]) => [size * u, size * v];
  if (why) {
    view.copies(at, shown.map(tip), HERE);
    if (Math.hypot(...tip(shown[1])) <= 8)
      view.tag({ id: "still", text: "no motion at any distance", at, colour: theme.ink, rank: 0, gap: 16 });
    return;
  }
  const colour = theme.lines[run.order];
  const [own, guess] = shown;
  const parts = (/** @type {number[]} */ [u, v]) => (single === null ? [u, v] : single === 0 ? [u, 0] : [0, v]);
  const agree = guess && !expectsAnother(seen, tolerance);
  const inside = (/** @type {number[]} */ [x, y]) => x > 0 && x < view.width && y > 0 && y < view.height;
  const endOf = (velocity) => [tip(velocity).map((value, c) => at[c] + value)].find(inside) ?? at;
  const draw = (velocity, tint, width, id, text, towards) => {
    const [u, v] = tip(velocity);
    if (single !== null) view.line([[px, py], [px + u, py + v]], tint, { width, alpha: 0.3 });
    view.arrow([px, py], tip(parts(velocity)), tint, width);
    const label = { id, text, at: endOf(velocity), colour: tint, rank: 3, gap: 8, towards };
    if (guess && !agree && Math.hypot(u, v) > 8) view.tag(label);
  };
  if (guess) draw(guess, colour, 5, "expected", "expected", guess);
  const length = Math.hypot(...own) * size;
  if (agree && length > 20) {
    const label = { id: "agree", text: "seen as expected", at: endOf(own), colour, rank: 3, gap: 8 };
    view.tag({ ...label, towards: [own[1], -own[0]] });
  }
  draw(own, theme.ink, 1.8, "seen", "seen", [own[1], -own[0]]);
}

function hatchAround(pen, [x, y], radius, single, width, height) {
  if (single === 0) pen.rect(x - radius, 0, 2 * radius, height);
  else if (single === 1) pen.rect(0, y - radius, width, 2 * radius);
  else pen.arc(x, y, radius, 0, 2 * Math.PI);
}

/** A few hundred image points of the truth in sight, or where there is none of the estimate. */
function pathOf({ shown, chosen, span }) {
  const rows = shown.truth?.length ? shown.truth : chosen.estimate;
  const [from, to] = indicesIn(shown.time, span);
  const every = Math.max(1, Math.floor((to - from) / 300));
  const found = [];
  for (let k = from; k <= to; k += every) found.push([rows[shown.width * k], rows[shown.width * k + 1]]);
  return found;
}
