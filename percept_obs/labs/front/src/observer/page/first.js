// The first screen of the observer lab: the estimate slides along its ray until the motion that it expects is seen.

import { places, range } from "../../common/first/controls.js";
import { drawCamera, drawCone, drawGround } from "../../common/first/map.js";
import { FirstScreen } from "../../common/first/screen.js";
import { columnOf, derived } from "../../common/model/derived.js";
import { settled } from "../../common/model/errors.js";
import { between, valueBetween, within } from "../../common/model/playback.js";
import { changeAt, same } from "../../common/model/settings.js";
import { percent } from "../../common/model/words.js";
import { affine, COPIES, imageVelocities } from "../../common/model/velocities.js";
import { KEPT } from "../../common/page/looks.js";
import { shapeOf, varies } from "../model/camera.js";
import { translationTowards } from "../model/engine.js";
import { QUESTIONS } from "../model/questions.js";
import { apply, flow, isRigid, Standing, STANDING_THINGS } from "../model/standing.js";
import { coefficientsAt, placesOf } from "./scene.js";

const CAPTIONS = { image: "What the camera sees", world: "The world from above", axis: "Distance over time" };
const OUTPUTS = [
  { text: "y1", spoken: "y1 only", value: ["y1"] },
  { text: "both", spoken: "y1 and y2", value: ["y1", "y2"] },
  { text: "y2", spoken: "y2 only", value: ["y2"] },
];
/** Names of the copies at other distances. */
const HERE = ["half as far", "here", "twice as far"];
/** The estimate and the truth are written in metres up to this. */
const FAR = 999;
/** Pixels within which the focus of expansion clicks onto the point. */
const CLICK = 7;
/** Least distance of a point, in metres. */
const [NEAREST, FARTHEST] = [0.8, 200];
/** Part of the image that the path and what is around it take, at least, in a standing world. */
const USUAL = [[-0.8, 0.8], [-0.55, 0.55]];
const MOST = 3;

export class ObserverFirst extends FirstScreen {
  /** What is seen at the time that was drawn last, in metres before the camera. */
  seen = /** @type {any} */ (null);

  constructor(lab) {
    super(lab, CAPTIONS, controlsOf(lab), QUESTIONS);
    this.standing = new Standing();
    this.focus = this.handle(this.image, {
      ...{ name: "first foe", label: "Focus of expansion, where the camera heads" },
      onMove: (place) => this.steer(this.clicked(place)),
    });
    this.point = this.handle(this.image, {
      ...{ name: "first point", label: "The point, its direction" },
      onMove: (place) => this.aim(place),
    });
    this.far = this.handle(this.world, {
      ...{ name: "first distance", label: "The point, its distance", nudge: 0.25 },
      onMove: (place) => this.reach(place),
    });
  }

  renew() {
    this.standing.begin();
  }

  // What a hand does: it moves what it sees now, so the present picture stays, and the past swings.

  /** Settings of the same present with another motion, or with the point elsewhere. */
  moveTo(b, place) {
    const { settings } = this.lab;
    const { now } = /** @type {any} */ (this.scene);
    const motion = { A: settings.A, b };
    const X0 = apply(flow(motion, -now), place);
    if (!(X0[2] > 0.4) || X0.some((value) => !(Math.abs(value) < 1000))) return;
    this.standing.keep(settings, now);
    this.lab.change({ b, X0, start: this.startFor(X0) });
  }

  /** The start of the estimate at the same distance on the ray of another point. */
  startFor(X0) {
    const { settings } = this.lab;
    if (settings.start.mode !== "chosen") return settings.start;
    const { functions } = this.seen;
    const shape = shapeOf(settings);
    const lengthOf = (y1, y2) => Math.hypot(...functions.ray([y1, y2, ...shape], new Float64Array(3)));
    const [z1, z2, inverse] = settings.start.values;
    const [y1, y2] = functions.project([...X0, ...shape], new Float64Array(3));
    return { ...settings.start, values: [y1, y2, (inverse * lengthOf(y1, y2)) / lengthOf(z1, z2)] };
  }

  clicked(place) {
    const { y } = this.seen;
    const apart = /** @type {number[]} */ (this.image.at)[2] * Math.hypot(place[0] - y[0], place[1] - y[1]);
    return apart < CLICK ? y : place;
  }

  steer(place) {
    const { settings } = this.lab;
    const aim = place.map((value) => within(value, -MOST, MOST));
    const b = translationTowards(aim, settings, this.seen.functions);
    const speed = Math.hypot(...settings.b) / Math.hypot(...b);
    this.moveTo(b.map((value) => speed * value), this.seen.place);
  }

  aim(place) {
    const { settings } = this.lab;
    const ray = Array.from(this.seen.functions.ray([...place, ...shapeOf(settings)], new Float64Array(3)));
    const length = Math.hypot(...this.seen.place) / Math.hypot(...ray);
    this.moveTo(settings.b, ray.map((value) => length * value));
  }

  /** Put the point at the place on its ray that is nearest to a place of the map. */
  reach([x, z]) {
    const { camera, point, place } = this.seen;
    const along = [point[0] - camera[0], point[2] - camera[2]];
    const part = ((x - camera[0]) * along[0] + (z - camera[2]) * along[1]) / Math.hypot(...along) ** 2;
    const distance = Math.hypot(...place);
    const wanted = within(part * distance, NEAREST, FARTHEST);
    this.moveTo(this.lab.settings.b, place.map((value) => (value * wanted) / distance));
  }

  // What is seen at a time.

  /** Places in metres before the camera: of the point, of the estimate, and functions of the settings. */
  look(scene) {
    const { lab } = this;
    const { shown, at, now } = scene;
    const { settings, truth, width } = shown;
    const [run] = shown.runs;
    const functions = lab.kernels.of(settings);
    const shape = shapeOf(settings);
    const placeOf = placesOf(lab, shown);
    const stateOf = (rows) => [0, 1, 2].map((c) => valueBetween(rows, width, c, at));
    const state = truth?.length ? stateOf(truth) : null;
    const estimate = stateOf(run.estimate);
    const y = state ?? estimate;
    const motion = coefficientsAt(lab, shown, functions, at);
    const image = (copy) => Array.from(functions.project([...copy, ...shape], new Float64Array(3)));
    const speedsOf = (place, { A, b }) => imageVelocities(place, (copy) => affine(A, b, copy), image);
    const place = placeOf(state ?? estimate);
    const guess = estimate[2] > 1e-4 ? placeOf(estimate) : null;
    const expected = guess && placeOf([y[0], y[1], estimate[2]]);
    const rigid = isRigid(settings.A) && !varies(settings, lab.model);
    const world = rigid ? this.standing.toWorld(settings, now) : null;
    const inWorld = (where) => (world ? apply(world, where) : where);
    this.seen = {
      ...{ state, estimate, y: y.slice(0, 2), motion, image, place, guess, rigid, run, inWorld, functions },
      ...{ camera: inWorld([0, 0, 0]), point: inWorld(place), truth: Boolean(state) },
      copies: state && speedsOf(place, motion),
      expects: expected && speedsOf(expected, settings.believed ?? motion)[1],
      movable: rigid || (state && !varies(settings, lab.model)),
      foe: shown.foe,
      radius: radiusOf(shown),
      single: shown.measured.length === 1 ? shown.measured[0] : null,
    };
    return this.seen;
  }

  drawImage(scene, motion, note) {
    const { image: view } = this;
    const seen = this.look(scene);
    const { theme, shown, why } = scene;
    const moving = view.glide(this.imageGoal(scene, seen), motion);
    view.begin(theme);
    const { width, height } = view;
    const [c1, c2, scale] = /** @type {number[]} */ (view.at);
    const x = (y1) => width / 2 + (y1 - c1) * scale;
    const y = (y2) => height / 2 - (y2 - c2) * scale;
    const on = (place) => /** @type {[number, number]} */ ([x(place[0]), y(place[1])]);
    view.avoid(width - 44, height - 24, 44, 24);
    this.drawDirections(view, seen, theme);
    const { foe, radius, single } = seen;
    if (foe && radius) view.hatched((pen) => hatchAround(pen, on(foe), radius * scale, single, width, height));
    if (seen.rigid) this.drawStandingThings(view, scene, seen, on);
    const rows = shown.truth?.length ? shown.truth : shown.runs[0].estimate;
    view.line(pathOf(rows, shown.width).map(on), theme.ink, { width: 1, alpha: seen.rigid ? 0.15 : 0.35 });
    const [px, py] = on(seen.y);
    if (single === 0) view.line([[px, 0], [px, height]], theme.ink, { width: 1, dash: [2, 5] });
    if (single === 1) view.line([[0, py], [width, py]], theme.ink, { width: 1, dash: [2, 5] });
    this.drawArrows(view, scene, seen, [px, py]);
    if (foe) {
      const [fx, fy] = on(foe);
      view.dot(fx, fy, 9, theme.raised, 0);
      view.ring(fx, fy, 10, theme.warning, 2.5);
      view.line([[fx - 5, fy], [fx + 5, fy]], theme.warning, { width: 2 });
      view.line([[fx, fy - 5], [fx, fy + 5]], theme.warning, { width: 2 });
      const text = seen.rigid ? "focus of expansion" : "FOE";
      view.tag({ id: "foe", text, at: [fx, fy], colour: theme.warning, rank: 2, gap: 14 });
    }
    const colour = theme.lines[seen.run.order];
    const [gx, gy] = on(seen.estimate);
    if (!why) view.ring(within(gx, 12, width - 12), within(gy, 12, height - 12), 11, colour);
    view.dot(px, py, 6, theme.ink);
    if (note) view.note(...(note.at === "estimate" ? [gx, gy + 13] : [px, py + 8]), note.text);
    view.end();
    const frame = { box: { left: 8, top: 8, width: width - 16, height: height - 16 }, scale, x, y };
    const { late } = this.lab;
    this.focus.stand(seen.movable ? foe : null, frame, late);
    this.point.stand(seen.movable ? seen.y : null, frame, late);
    return moving;
  }

  /** Middle and scale of the image in which the path lies. */
  imageGoal({ shown }, { rigid, foe }) {
    const rows = shown.truth?.length ? shown.truth : shown.runs[0].estimate;
    const around = (c) => (foe ? [foe[c], foe[c]] : [Infinity, -Infinity]);
    const bounds = rigid ? USUAL.map((pair) => [...pair]) : [0, 1].map(around);
    for (const place of pathOf(rows, shown.width)) {
      bounds.forEach((pair, c) => {
        const value = within(place[c], -MOST, MOST);
        if (Number.isNaN(value)) return;
        pair[0] = Math.min(pair[0], value - 0.18);
        pair[1] = Math.max(pair[1], value + 0.18);
      });
    }
    const { width, height } = this.image.size ?? { width: 400, height: 300 };
    const scales = bounds.map(([low, high], c) => [width, height][c] / (high - low));
    return [...bounds.map(([low, high]) => (low + high) / 2), Math.min(...scales) * (rigid ? 1 : 0.9)];
  }

  /** The two directions of the image; the one that is not measured is pale. */
  drawDirections(view, { single }, theme) {
    [[26, 0, "y1", 1], [0, -26, "y2", 0]].forEach(([dx, dy, text, other]) => {
      view.context.globalAlpha = single === other ? 0.3 : 1;
      view.arrow([16, 56], [dx, dy], theme.muted, 1.3);
      view.write(text, 16 + 1.5 * Number(dx), 56 + 1.5 * Number(dy), theme.muted);
    });
    view.context.globalAlpha = 1;
    view.avoid(36, 36, 36);
  }

  /** Standing things, each with its way of the last second; of one size, which says nothing of their distance. */
  drawStandingThings(view, scene, { motion, image }, on) {
    const { theme, now } = scene;
    const toCamera = this.standing.toCamera(scene.shown.settings, now);
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
      view.context.globalAlpha = 0.7;
      view.context.fillStyle = theme.muted;
      view.context.beginPath();
      view.context.arc(at[0], at[1], 3, 0, 7);
      view.context.fill();
      view.context.globalAlpha = 1;
    }
  }

  /** How the point moves in the image, and how it would if the estimate were right; or copies at other distances. */
  drawArrows(view, { theme, why }, { copies, expects, single, run }, at) {
    const [px, py] = at;
    if (!copies) return;
    const scale = view.at[2];
    const flip = (/** @type {number[]} */ [u, v]) => [u, -v];
    const shown = (why ? copies : [copies[1], expects]).filter(Boolean).map(flip);
    // One scale, whether the copies are shown or not.
    const all = [...copies, expects].filter(Boolean).map(flip);
    const longest = Math.max(...all.map((v) => Math.hypot(...v)), 1e-9) * scale;
    let size = Math.min(4, (Math.min(view.width, view.height) * 0.6) / longest) * scale;
    for (const velocity of all) {
      const [u, v] = velocity;
      const [across, down] = [u < 0 ? px : view.width - px, v < 0 ? py : view.height - py];
      size = Math.min(size, (across - 14) / Math.abs(u), (down - 14) / Math.abs(v));
    }
    // The names of the directions stand in the corner.
    const inCorner = (/** @type {number[]} */ [u, v]) => px + size * u < 78 && py + size * v < 72;
    while (all.some(inCorner) && size > 1) size *= 0.9;
    size = Math.max(size, 0);
    const tip = (/** @type {number[]} */ [u, v]) => [size * u, size * v];
    if (why) {
      shown.forEach((velocity, k) => {
        const [u, v] = tip(velocity);
        const length = Math.hypot(u, v);
        const aside = length > 3 ? ((k - 1) * 11) / length : 0;
        const from = [px - v * aside, py + u * aside];
        view.arrow(from, [u, v], theme.ink, 2.5);
        const end = [from[0] + u, from[1] + v];
        const text = HERE[k];
        if (length <= 8 && k === 1)
          view.tag({ id: "still", text: "no motion at any distance", at: from, colour: theme.ink, rank: 0, gap: 16 });
        if (length > 8) view.tag({ id: text, text, at: end, colour: theme.ink, rank: k, gap: 5, towards: velocity });
      });
      return;
    }
    const colour = theme.lines[run.order];
    const [own, guess] = shown;
    const parts = (/** @type {number[]} */ [u, v]) => (single === null ? [u, v] : single === 0 ? [u, 0] : [0, v]);
    const apart = guess ? Math.hypot(own[0] - guess[0], own[1] - guess[1]) * size > 6 : false;
    const draw = (velocity, tint, width, id, text, towards) => {
      const [u, v] = tip(velocity);
      if (single !== null) view.line([[px, py], [px + u, py + v]], tint, { width, alpha: 0.3 });
      view.arrow([px, py], tip(parts(velocity)), tint, width);
      if (apart) view.tag({ id, text, at: [px + u, py + v], colour: tint, rank: 3, gap: 8, towards });
    };
    if (guess) draw(guess, colour, 5, "expected", "expected", guess);
    const length = Math.hypot(...own) * size;
    if (guess && !apart && length > 20) {
      const at = [px + size * own[0], py + size * own[1]];
      view.tag({ id: "agree", text: "seen as expected", at, colour, rank: 3, gap: 8, towards: [own[1], -own[0]] });
    }
    draw(own, theme.ink, 1.8, "seen", "seen", [own[1], -own[0]]);
  }

  drawWorld(scene, motion, note) {
    const { world: view, seen } = this;
    const { shown, theme, now, why, ghost } = scene;
    const { settings } = shown;
    const moving = view.glide(this.worldGoal(scene, seen), motion);
    view.begin(theme);
    const { width, height } = view;
    const [cx, cz, scale] = /** @type {number[]} */ (view.at);
    const x = (value) => width / 2 + (value - cx) * scale;
    const y = (value) => height / 2 - 6 - (value - cz) * scale;
    const on = (place) => [x(place[0]), y(place[2])];
    drawGround(view, [cx, cz, scale], { x, y }, theme);
    if (!this.resetButton.hidden) view.avoid(width - 60, 24, 60, 24);
    const camera = on(seen.camera);
    const reach = (1.2 * Math.hypot(width, height)) / scale;
    const along = (direction) => {
      const size = reach / Math.max(Math.hypot(direction[0], direction[2]), 1e-9);
      return on(seen.inWorld(direction.map((value) => size * value)));
    };
    this.drawCone(view, camera, along, theme);
    if (seen.rigid) {
      for (const thing of STANDING_THINGS) {
        const [u, v] = on(thing);
        view.context.globalAlpha = 0.7;
        view.context.fillStyle = theme.muted;
        view.context.beginPath();
        view.context.arc(u, v, 2.5, 0, 7);
        view.context.fill();
        view.context.globalAlpha = 1;
      }
    }
    const { b } = seen.motion;
    const ahead = along(b.map((value) => (seen.rigid ? -value : value)));
    view.line([camera, ahead], theme.warning, { dash: [6, 5] });
    view.avoidLine(camera, ahead);
    const share = 60 / Math.max(Math.hypot(ahead[0] - camera[0], ahead[1] - camera[1]), 60);
    const named = [0, 1].map((c) => camera[c] + share * (ahead[c] - camera[c]));
    view.tag({ id: "heading", text: "heading", at: named, colour: theme.warning, rank: 7, gap: 4, towards: [1, 0] });
    const turn = Math.atan2(along([0, 0, 1])[0] - camera[0], camera[1] - along([0, 0, 1])[1]);
    const ray = along(seen.place);
    view.line([camera, ray], theme.ink, { alpha: 0.75 });
    view.avoidLine(camera, ray);
    this.drawTicks(view, seen, on, camera, ray, reach, theme, why);
    const past = (rows) => this.pastOf(scene, rows).map(on);
    const colour = theme.lines[seen.run.order];
    if (seen.rigid) {
      const way = this.timesTo(scene).map((time) => on(apply(this.standing.toWorld(settings, time), [0, 0, 0])));
      view.line(way, theme.ink, { width: 2, alpha: 0.35 });
      this.drawBelieved(view, scene, on, colour, way[0]);
    } else if (shown.truth?.length) view.line(past(shown.truth), theme.ink, { width: 1, alpha: 0.35 });
    view.line(past(seen.run.estimate), colour, { alpha: 0.4 });
    const point = on(seen.point);
    if (why && seen.truth) this.drawCopies(view, seen, on, theme);
    drawCamera(view, camera, turn, theme);
    if (ghost && !why) {
      const placeOf = placesOf(this.lab, ghost);
      const where = between(ghost.time, now);
      const kept = [0, 1, 2].map((c) => valueBetween(ghost.runs[0].estimate, 3, c, where));
      if (kept[2] > 1e-4) view.ring(...on(seen.inWorld(placeOf(kept))), 6, theme.kept, 1.5);
    }
    if (seen.truth) view.dot(point[0], point[1], 7, theme.ink);
    if (!why) this.drawEstimate(view, seen, on, colour);
    if (seen.truth && !why) {
      const text = `true ${metres(Math.hypot(...seen.place))}`;
      view.tag({ id: "true", text, at: point, colour: theme.ink, rank: 1, gap: 11 });
    }
    if (note) view.note(point[0], point[1] + 8, note.text);
    view.end();
    const frame = { box: { left: 8, top: 8, width: width - 16, height: height - 16 }, scale, x, y };
    this.far.stand(seen.movable && seen.truth ? [seen.point[0], seen.point[2]] : null, frame, this.lab.late);
    return moving;
  }

  /** The way that the camera has come, as an observer believes that believes another motion. */
  drawBelieved(view, { shown, theme, now }, on, colour, start) {
    const { settings } = shown;
    if (!settings.believed || same(settings.believed, { A: settings.A, b: settings.b })) return;
    const { inWorld } = this.seen;
    const placeAt = (time) => inWorld(apply(flow(settings.believed, now - time), [0, 0, 0]));
    // Beside the true way, or one would hide the other.
    const way = this.timesTo({ shown, now }).map((time) => on(placeAt(time)).map((value, c) => value + (c ? 0 : 7)));
    view.line(way, colour, { width: 2, dash: [5, 4] });
    view.tag({ id: "believed", text: "believed way", at: way[0], colour, rank: 2, gap: 5, towards: [1, 0] });
    view.tag({ id: "way", text: "true way", at: start, colour: theme.ink, rank: 2, gap: 5, towards: [-1, 0] });
  }

  /** Times from the start to the present at which the past is drawn. */
  timesTo({ shown, now }) {
    const [first] = shown.time;
    const count = 60;
    return Array.from({ length: count + 1 }, (_, k) => first + ((now - first) * k) / count);
  }

  /** Where rows of states were in the world, up to the present. */
  pastOf({ shown, now }, rows) {
    const { settings, time, width } = shown;
    const placeOf = placesOf(this.lab, shown);
    const every = Math.max(1, Math.floor(time.length / 300));
    const found = [];
    for (let k = 0; k < time.length && time[k] <= now; k += every) {
      const state = [0, 1, 2].map((c) => rows[width * k + c]);
      const place = state[2] > 1e-4 ? placeOf(state) : [NaN, NaN, NaN];
      found.push(this.seen.rigid ? apply(this.standing.toWorld(settings, time[k]), place) : place);
    }
    return found;
  }

  worldGoal(scene, { rigid, inWorld, place }) {
    const { shown, why } = scene;
    const { settings, truth, time, width } = shown;
    const placeOf = placesOf(this.lab, shown);
    const box = [Infinity, -Infinity, Infinity, -Infinity];
    const take = (/** @type {number[]} */ [x, , z]) => {
      if (!Number.isFinite(x + z)) return;
      [box[0], box[1]] = [Math.min(box[0], x), Math.max(box[1], x)];
      [box[2], box[3]] = [Math.min(box[2], z), Math.max(box[3], z)];
    };
    const rows = truth?.length ? truth : shown.runs[0].estimate;
    for (let k = 0; k <= 40; k++) {
      const sample = Math.round((k * (time.length - 1)) / 40);
      const map = rigid ? this.standing.toWorld(settings, time[sample]) : null;
      const there = (where) => (map ? apply(map, where) : where);
      const stateOf = (table) => [0, 1, 2].map((c) => table[width * sample + c]);
      take(there([0, 0, 0]));
      take(there(placeOf(stateOf(rows))));
      const first = stateOf(shown.runs[0].estimate);
      if ((k === 0 || k === 40) && first[2] > 0 && 1 / first[2] < 1.6 / stateOf(rows)[2]) take(there(placeOf(first)));
    }
    if (why) take(inWorld(place.map((value) => 2 * value)));
    if (settings.believed && rigid) {
      const began = apply(flow(settings.believed, scene.end - time[0]), [0, 0, 0]);
      take(apply(this.standing.toWorld(settings, scene.end), began));
    }
    const size = this.world.size ?? { width: 350, height: 300 };
    const scale = Math.min((size.width - 130) / (box[1] - box[0] + 1), (size.height - 90) / (box[3] - box[2] + 0.1));
    return [(box[0] + box[1]) / 2, (box[2] + box[3]) / 2, Math.max(scale, 1e-6)];
  }

  /** What the image holds. */
  drawCone(view, camera, along, theme) {
    const { at, width } = this.image;
    const [c1, , scale] = /** @type {number[]} */ (at);
    const { settings } = this.lab.shown;
    const { ray } = this.seen.functions;
    const edges = [-1, 1].map((side) =>
      Array.from(ray([c1 + (side * width) / 2 / scale, 0, ...shapeOf(settings)], new Float64Array(3))),
    );
    if (edges.some((edge) => edge.some(Number.isNaN))) return;
    drawCone(view, camera, edges.map(along), theme);
  }

  /** The ray is the ruler of the distance: a tick a metre, or for more where these would be too near. */
  drawTicks(view, { place, inWorld }, on, camera, end, reach, theme, why) {
    const length = Math.hypot(...place);
    const far = Math.hypot(end[0] - camera[0], end[1] - camera[1]);
    const [nx, ny] = [-(end[1] - camera[1]) / far, (end[0] - camera[0]) / far];
    const step = [1, 5, 10, 50, 100, 1000].find((metre) => (metre * far) / reach >= 6) ?? 1e4;
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
  drawCopies(view, { place, inWorld }, on, theme) {
    COPIES.forEach((part, k) => {
      const [u, v] = on(inWorld(place.map((value) => part * value)));
      view.dot(u, v, 5, theme.raised);
      view.ring(u, v, 5, theme.ink, 2);
      const text = HERE[k];
      view.tag({ id: `copy ${k}`, text, at: [u, v], colour: theme.ink, rank: 1, gap: 9, towards: [-1, 0] });
    });
  }

  /** The estimate, a bead on the ray; an arrow at the rim where it is out of the picture. */
  drawEstimate(view, { guess, inWorld, place }, on, colour) {
    const { width, height } = view;
    const where = on(inWorld(guess ?? place.map((value) => 1e5 * value)));
    const [u, v] = [within(where[0], 18, width - 18), within(where[1], 18, height - 18)];
    const text = `estimate ${guess ? metres(Math.hypot(...guess)) : "∞"}`;
    const inside = Math.hypot(u - where[0], v - where[1]) < 1;
    if (inside) view.ring(u, v, 11, colour, 3.5);
    else {
      const length = Math.hypot(where[0] - u, where[1] - v);
      const [dx, dy] = [(10 * (where[0] - u)) / length, (10 * (where[1] - v)) / length];
      view.arrow([u - dx, v - dy], [2 * dx, 2 * dy], colour, 3);
    }
    view.tag({ id: "estimate", text, at: [u, v], colour, rank: 0, gap: 13 });
  }

  chartOf(scene) {
    const { shown, ghost, theme, secret, now } = scene;
    const { time, truth, settings } = shown;
    const [run] = shown.runs;
    const distances = (result, rows) => this.distancesOf(result, rows);
    const actual = truth?.length ? distances(shown, truth) : null;
    const found = distances(shown, run.estimate);
    const most = actual ? Math.max(...actual.filter(Number.isFinite)) : median(found) * 2;
    const near = found.filter((value) => value < 1.5 * most);
    const colour = theme.lines[run.order];
    const since = actual && isSettled(shown) && run.settling > 0 ? time[0] + run.settling : Infinity;
    const told = secret ? since <= now : since < Infinity;
    const at = told ? between(time, since) : null;
    const within10 = `within ${percent(shown.tolerance, 6)} from ${since.toFixed(1)} s`;
    return {
      end: Math.max(settings.scenario in this.lab.model.recordings ? 0 : settings.duration, time[time.length - 1]),
      high: 1.2 * Math.max(most, ...near),
      unit: "m",
      lines: [
        ...(ghost ? [keptLine(scene.kept, ghost.time, distances(ghost, ghost.runs[0].estimate), theme)] : []),
        { id: "estimate", text: "estimate", time, values: found, colour, width: 3, secret },
        ...(actual ? [{ id: "true", text: "true", time, values: actual, colour: theme.ink, width: 1.6 }] : []),
      ],
      spans: this.unseenSpans(shown),
      found: at ? { time: since, value: found[at.sample], text: within10, colour } : null,
    };
  }

  /** Distances along the ray of rows of states; as good as infinite where the inverse is not positive. */
  distancesOf(result, rows) {
    return derived(rows, "along the ray", () => {
      const { ray } = this.lab.kernels.of(result.settings);
      const out = new Float64Array(3);
      const seen = [0, 0, ...shapeOf(result.settings)];
      const inverse = columnOf(rows, 3, 2);
      return inverse.map((value, k) => {
        [seen[0], seen[1]] = [rows[3 * k], rows[3 * k + 1]];
        ray(seen, out);
        return value > 1e-4 ? Math.hypot(...out) / value : Number.isNaN(value) ? NaN : 1e5;
      });
    });
  }

  /** Times in which what is measured moves too little with the distance. */
  unseenSpans(shown) {
    const { time, truth, foe, measured } = shown;
    const radius = radiusOf(shown);
    if (!truth?.length || !foe || !radius) return [];
    const text = `${measured.length > 1 ? "" : measured[0] ? "row " : "column "}too near the focus`;
    const spans = spansOf(time, (k) => measuredApart(truth, k, foe, measured) < radius);
    return spans.map(([begin, end]) => ({ begin, end, text }));
  }

  sentence(scene) {
    const { shown, now, end, why } = scene;
    const { settings, time } = shown;
    const { seen } = this;
    const [run] = shown.runs;
    if (!seen.truth) return "A recording without a truth: the estimate alone is shown.";
    const near = this.unseenSpans(shown).some(({ begin, end: last }) => begin <= now && now <= last);
    if (why) {
      if (near) return "One ray, three distances: here all of them move alike.";
      return "One ray, three distances: the nearer a point is, the faster it moves.";
    }
    const found = isSettled(shown) && run.settling <= now - time[0];
    const distance = metres(Math.hypot(...seen.place));
    const ratio = seen.guess ? Math.hypot(...seen.guess) / Math.hypot(...seen.place) : Infinity;
    if (run.divergedAt !== null) return `The estimate left every bound after ${run.divergedAt.toFixed(1)} s.`;
    if (settings.believed && !same(settings.believed, { A: settings.A, b: settings.b }) && now > (time[0] + end) / 2)
      return `The observer believes another motion: its distance is ${ratio.toFixed(2)} times the true one.`;
    if (near && !found) return "Too near the focus of expansion: near and far move alike, so there is little to learn.";
    if (found) {
      if (now < end || this.moved) return `Found: the estimate is on the point, ${distance} away.`;
      return `Found: ${distance}. Now drag the focus of expansion onto the point.`;
    }
    if (now - time[0] < 0.15 * (end - time[0])) return "One image shows the direction of a point, never its distance.";
    const seconds = (end - time[0]).toFixed(0);
    if (now >= end) return `Not found in ${seconds} s: the estimate is too ${ratio < 1 ? "near" : "far"}.`;
    return "The estimate expects another motion than is seen, so it slides along its ray.";
  }
}

function controlsOf(lab) {
  const allowed = () => lab.model.surfaces[lab.settings.surface].outputs;
  const observer = () => lab.settings.observers[0];
  const gain = () => lab.model.observers[observer()].gains[0];
  const change = (changes) => {
    lab.first.touch();
    lab.change(changes);
  };
  const rest = () => lab.rest();
  const { low, high } = gain();
  return [
    places({
      ...{ name: "first outputs", label: "Measured", choices: OUTPUTS },
      get: () => (allowed().length < 2 ? -1 : OUTPUTS.findIndex(({ value }) => same(value, lab.settings.outputs))),
      set: (outputs) => {
        if (!allowed().some((names) => same(names, outputs))) return;
        lab.first.touch();
        lab.change({ outputs }, true);
      },
    }),
    range({
      ...{ name: "first gain", label: "Gain", low: Math.max(low, 1), high, log: true, rest },
      get: () => lab.settings.gains[observer()][gain().name],
      set: (value) => change(changeAt(lab.settings, `gains.${observer()}.${gain().name}`, value)),
    }),
    range({
      ...{ name: "first noise", label: "Noise", low: 0, high: 0.01, step: 0.0005, rest },
      get: () => (lab.settings.scenario in lab.model.recordings ? null : lab.settings.noise.size),
      set: (size) => change({ noise: { ...lab.settings.noise, size } }),
    }),
  ];
}

function keptLine(text, time, values, theme) {
  return { id: "kept", text, time, values, colour: theme.kept, dash: KEPT };
}

/** True if the first observer's error stays in the tolerance for long enough to be sure. */
function isSettled({ runs: [{ settling }], time, settledPart }) {
  return settled(settling, time.at(-1) - time[0], settledPart);
}

/** Radius in the image of the circle in which an instant tells too little. */
function radiusOf({ circle, settings }) {
  if (circle) return Math.abs(circle[2]);
  return settings.surface === "pinhole" && settings.b[2] ? settings.threshold / Math.abs(settings.b[2]) : null;
}

/** Distance in the image from the focus of expansion, as far as it is measured. */
function measuredApart(truth, k, foe, measured) {
  return Math.hypot(...measured.map((c) => truth[3 * k + c] - foe[c]));
}

/** First and last time of each part in which a condition holds. */
function spansOf(time, holds) {
  const found = [];
  for (let k = 0; k < time.length; k++) {
    if (!holds(k)) continue;
    if (k > 0 && holds(k - 1)) found.at(-1)[1] = time[k];
    else found.push([time[k], time[k]]);
  }
  return found;
}

function hatchAround(pen, [x, y], radius, single, width, height) {
  if (single === 0) pen.rect(x - radius, 0, 2 * radius, height);
  else if (single === 1) pen.rect(0, y - radius, width, 2 * radius);
  else pen.arc(x, y, radius, 0, 2 * Math.PI);
}

/** A few hundred image points of rows of states. */
function pathOf(rows, width) {
  const every = Math.max(1, Math.floor(rows.length / width / 300));
  const found = [];
  for (let k = 0; k < rows.length; k += width * every) found.push([rows[k], rows[k + 1]]);
  return found;
}

function metres(distance) {
  return distance > FAR ? "∞" : `${distance.toFixed(1)} m`;
}

function median(values) {
  const sorted = values.filter(Number.isFinite).sort();
  return sorted[Math.floor(sorted.length / 2)] ?? 1;
}
