// The first screen of the lab of many points: a body's estimate is pulled, mark by mark, on to the rays of the marks.

import { drawCamera, drawCone, drawGround } from "../../common/first/map.js";
import { FirstScreen } from "../../common/first/screen.js";
import { derived } from "../../common/model/derived.js";
import { between, valueBetween, within } from "../../common/model/playback.js";
import { imageVelocities } from "../../common/model/velocities.js";
import { Body } from "../model/body.js";
import { PointsEngine } from "../model/engine.js";
import { motionAt } from "../model/motion.js";
import { QUESTIONS } from "../model/questions.js";
import { chartOf, controlsOf, meanErrorOf, sentenceOf } from "./first_told.js";
import { drawMark, drawOutline, outlineOf } from "./outline.js";

const CAPTIONS = { image: "What the camera sees", world: "The world from above", axis: "How far the estimate is off" };
const HERE = ["near, small", "here", "far, large"];
const DASH = [5, 5];
/** Marks in sight that a hand may move and hide. */
const IN_HAND = 3;
/** Shares of the given error with which the estimate may start. */
const [LEAST_ERROR, MOST_ERROR] = [0.5, 4];
/** Metres off below which the estimate has no handle, and its arrows no name. */
const CLOSE = 0.4;
/** How much the copy of the first look grows and shrinks, and milliseconds of a swing. */
const [SWING, SWINGS] = [0.45, 2600];
/** Depth before the camera, in metres, below which nothing is drawn. */
const NEAREST = 0.2;
const MOST = 1.5;
/** What no picture shows may move no point, as an origin of its own does. */
const LEAST_REACH = 1e-6;

export class PointsFirst extends FirstScreen {
  /** Amounts of the directions that no picture shows, as a hand has dragged the copy. */
  amounts = /** @type {number[] | null} */ (null);
  looked = 0;

  constructor(lab) {
    super(lab, CAPTIONS, controlsOf(lab), QUESTIONS);
    this.clock.firstLook = SWINGS;
    this.engine = new PointsEngine(lab.model);
    this.marks = Array.from({ length: IN_HAND }, (_, k) =>
      this.handle(this.image, {
        ...{ name: `first mark ${k + 1}`, label: `Mark ${k + 1}; press it to hide it` },
        onMove: (place) => this.aim(k, place),
        onPress: () => this.hide(k),
      }),
    );
    this.begin = this.handle(this.world, {
      ...{ name: "first estimate", label: "The estimate's start", nudge: 0.1 },
      onMove: (place) => this.startAt(place),
    });
    this.twin = this.handle(this.world, {
      ...{ name: "first copy", label: "A copy with the same pictures", nudge: 0.25 },
      onMove: (place) => this.slide(place),
    });
  }

  renew() {
    this.amounts = null;
  }

  // What a hand does.

  /** Move a mark of the body to a direction, at the depth that it has now. */
  aim(k, [y1, y2]) {
    const { body, places } = this.seen;
    const depth = places[k][2];
    this.lab.change({ points: body.movedTo(k, [y1 * depth, y2 * depth, depth]) });
  }

  /** Hide a mark from now on, or show it; at both ends of the time, for all of it. */
  hide(k) {
    const { hidden, duration } = this.lab.settings;
    const now = this.clock.present();
    const whole = now <= this.clock.start || now >= this.clock.end;
    const from = whole ? 0 : now;
    const away = hidden[k] && hidden[k][0] <= now && now < hidden[k][1];
    const times = away ? (from > hidden[k][0] ? [hidden[k][0], from] : null) : [from, duration + 1];
    this.touch();
    this.renew();
    this.lab.change({ hidden: hidden.with(k, times) }, true);
  }

  /** Let the estimate start so that its first mark is as near to a place as its error's direction allows. */
  startAt([x, z]) {
    const [error] = [this.lab.settings.error];
    const [from, to] = [this.seen.inWorld[0], this.seen.foundInWorld[0]];
    const way = [to[0] - from[0], to[2] - from[2]];
    const part = ((x - from[0]) * way[0] + (z - from[2]) * way[1]) / Math.hypot(...way) ** 2;
    if (Number.isFinite(part)) this.lab.change({ error: within(part * error, LEAST_ERROR, MOST_ERROR) });
  }

  slide(place) {
    this.amounts = this.seen.body.amountsTo(this.seen.held, place);
    this.lab.redraw();
  }

  // What is seen at a time.

  look(scene) {
    const { lab } = this;
    const { shown, at, now, secret, why } = scene;
    const body = new Body(this.engine, lab.model, shown, lab.kernels.of(shown.settings), at);
    const places = body.places(body.state(shown.truth));
    const found = body.places(body.state(shown.estimate));
    const world = (list) => list.map((place) => body.toWorld(place));
    const hidden = places.map((_, k) => Number.isNaN(shown.outputs[2 * (at.sample * shown.points + k)]));
    const untouched = !this.questions.open && !this.moved && !this.clock.playing;
    const prelude = secret && !this.left && now <= this.clock.start && untouched;
    if (!prelude) this.left = true;
    const reach = (k) => body.movable(k).reduce((sum, [x, z]) => sum + x * x + z * z, 0);
    const held = places.map((_, k) => k).sort((one, other) => reach(other) - reach(one))[0];
    let copy = /** @type {number[][] | null} */ (null);
    if (prelude) {
      // Nothing moves before somebody looks.
      if (!this.clock.begun) this.looked = performance.now();
      this.looked ||= performance.now();
      const size = Math.exp(SWING * Math.sin((2 * Math.PI * (performance.now() - this.looked)) / SWINGS));
      copy = places.map((place) => place.map((value) => size * value));
    } else if (reach(held) > LEAST_REACH && !secret && !why) {
      if (this.amounts?.length !== body.unseen.length) this.amounts = body.larger();
      copy = body.copy(this.amounts);
    }
    this.seen = {
      ...{ body, places, found, hidden, prelude, copy, held },
      ...{ inWorld: world(places), foundInWorld: world(found), copyInWorld: copy && world(copy) },
      off: valueBetween(meanErrorOf(shown), 1, 0, at),
      sees: !prelude && !why,
    };
    scene.body = body;
    return this.seen;
  }

  seen = /** @type {any} */ (null);
  /** True once the copy of the first look was left behind. */
  left = false;

  drawImage(scene, motion, note) {
    const { image: view } = this;
    const { theme, shown, why } = scene;
    const seen = this.look(scene);
    const { state } = shown.settings;
    const moving = view.glide(this.imageGoal(scene), motion);
    view.begin(theme);
    const { width, height } = view;
    const [c1, c2, scale] = /** @type {number[]} */ (view.at);
    const x = (y1) => width / 2 + (y1 - c1) * scale;
    const y = (y2) => height / 2 - 8 - (y2 - c2) * scale;
    const on = ([X, Y, Z]) => (Z > NEAREST ? [x(X / Z), y(Y / Z)] : [NaN, NaN]);
    view.avoid(width - 44, height - 24, 44, 24);
    const blue = theme.lines[0];
    const draw = (places, colour, look) => drawOutline(view, outlineOf(places, state).map(on), colour, look);
    const at = seen.places.map(on);
    draw(seen.places, theme.ink, { fill: why ? 0.06 : 0.14 });
    if (seen.copy) draw(seen.copy, theme.muted, { width: 2, dash: DASH });
    if (seen.sees) {
      draw(seen.found, blue, { width: 2.5, fill: 0.1 });
      const tips = seen.found.map(on);
      tips.forEach(([u, v], k) => {
        if (Number.isNaN(u + v)) return;
        view.ring(u, v, 4.5, blue, 2);
        const way = [at[k][0] - u, at[k][1] - v];
        const part = 1 - 10 / Math.hypot(...way);
        if (seen.hidden[k] || !(part > 0)) return;
        view.arrow([u, v], way.map((value) => value * part), blue, 1.8);
        const middle = [u + 0.5 * way[0], v + 0.5 * way[1]];
        if (k === 0 && part > 0.6) view.tag({ id: "pull", text: "pull", at: middle, colour: blue, rank: 4, gap: 5 });
      });
      if (seen.off > CLOSE)
        view.tag({ id: "estimate", text: "estimate", at: middleOf(tips), colour: blue, rank: 1, gap: 14 });
    }
    if (why) this.drawWhy(view, scene, at[0]);
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
    const frame = { box: { left: 8, top: 8, width: width - 16, height: height - 16 }, scale, x, y };
    this.marks.forEach((mark, k) => {
      const place = seen.places[k];
      const there = place && place[2] > NEAREST;
      mark.stand(there ? [place[0] / place[2], place[1] / place[2]] : null, frame, this.lab.late);
    });
    return moving || (seen.prelude && this.clock.begun);
  }

  /** How the first mark moves in the image, and how it would if all were half or twice as far and as large. */
  drawWhy(view, { shown, at, theme }, from) {
    const { place, velocityAt } = motionAt(this.lab, shown, at)(0);
    const speeds = imageVelocities(place, velocityAt, ([X, Y, Z]) => [X / Z, Y / Z]).map(([u, v]) => [u, -v]);
    const longest = Math.max(...speeds.map((v) => Math.hypot(...v)), 1e-9);
    const [u0, v0] = speeds[0];
    const room = Math.min(
      (u0 < 0 ? from[0] : view.width - from[0]) / (Math.abs(u0) + 1e-9),
      (v0 < 0 ? from[1] : view.height - from[1]) / (Math.abs(v0) + 1e-9),
    );
    const size = Math.min((0.4 * view.width) / longest, 0.8 * room);
    speeds.forEach((velocity, k) => {
      const [u, v] = velocity.map((value) => size * value);
      const length = Math.hypot(u, v);
      const aside = length > 3 ? ((k - 1) * 12) / length : 0;
      const [x, y] = [from[0] - v * aside, from[1] + u * aside];
      view.arrow([x, y], [u, v], theme.ink, 2.5);
      const tip = { at: [x + u, y + v], towards: velocity };
      if (length > 8) view.tag({ id: HERE[k], text: HERE[k], ...tip, colour: theme.ink, rank: k, gap: 5 });
    });
  }

  /** Middle and scale of the image in which the body and the first of the estimate lie. */
  imageGoal({ shown }) {
    const box = derived(shown.estimate, "image box", () => {
      const found = [Infinity, -Infinity, Infinity, -Infinity];
      const { time, points } = shown;
      const take = (images, sample) => {
        for (let k = 0; k < points; k++) {
          const [y1, y2] = [0, 1].map((c) => within(images[2 * (sample * points + k) + c], -MOST, MOST));
          if (Number.isNaN(y1 + y2)) continue;
          [found[0], found[1]] = [Math.min(found[0], y1), Math.max(found[1], y1)];
          [found[2], found[3]] = [Math.min(found[2], y2), Math.max(found[3], y2)];
        }
      };
      for (let part = 0; part <= 1; part += 0.025) take(shown.images, Math.round(part * (time.length - 1)));
      for (const part of [0, 0.1, 0.2]) take(shown.estimated.images, Math.round(part * (time.length - 1)));
      return found;
    });
    const { width, height } = this.image.size ?? { width: 400, height: 300 };
    const scale = Math.min((width - 70) / (box[1] - box[0] + 0.02), (height - 90) / (box[3] - box[2] + 0.02));
    return [(box[0] + box[1]) / 2, (box[2] + box[3]) / 2, scale];
  }

  drawWorld(scene, motion, note) {
    const { world: view, seen } = this;
    const { shown, theme, why, now } = scene;
    const { body } = seen;
    const { state } = shown.settings;
    const moving = view.glide(this.worldGoal(scene), motion);
    view.begin(theme);
    const { width, height } = view;
    const [cx, cz, scale] = /** @type {number[]} */ (view.at);
    const x = (value) => width / 2 + (value - cx) * scale;
    const y = (value) => height / 2 - 4 - (value - cz) * scale;
    const on = (place) => /** @type {[number, number]} */ ([x(place[0]), y(place[2])]);
    const seenFrom = (place) => on(body.toWorld(place));
    drawGround(view, [cx, cz, scale], { x, y }, theme);
    if (!this.resetButton.hidden) view.avoid(width - 60, 24, 60, 24);
    const camera = seenFrom([0, 0, 0]);
    const [c1, , zoom] = /** @type {number[]} */ (this.image.at);
    const edges = [-1, 1].map((side) => seenFrom([(c1 + (side * this.image.width) / 2 / zoom) * 60, 0, 60]));
    drawCone(view, camera, edges, theme);
    const path = this.pathOf(scene);
    const past = path.filter(({ time }) => time <= now);
    view.line([...past.map(({ camera: place }) => on(place)), camera], theme.ink, { width: 2, alpha: 0.3 });
    const draw = (places, colour, look) => drawOutline(view, outlineOf(places, state).map(on), colour, look);
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
        view.arrow(at, [foot[0] - at[0], foot[1] - at[1]], blue, 1.8);
      });
      const text = `estimate, ${seen.off.toFixed(1)} m off`;
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
    const frame = { box: { left: 8, top: 8, width: width - 16, height: height - 16 }, scale, x, y };
    const first = seen.foundInWorld[0];
    const apart = Math.hypot(first[0] - seen.inWorld[0][0], first[2] - seen.inWorld[0][2]);
    const movable = seen.sees && shown.settings.start === "error" && (apart > CLOSE || this.lab.held);
    this.begin.stand(movable ? [first[0], first[2]] : null, frame, this.lab.late);
    const copy = !seen.prelude && seen.copyInWorld?.[seen.held];
    this.twin.stand(copy ? [copy[0], copy[2]] : null, frame, this.lab.late);
    return moving;
  }

  /** Places in the world of the camera and of the estimate's middle, at some times. */
  pathOf({ shown }) {
    return derived(shown.estimate, "way", () => {
      const { time } = shown;
      const functions = this.lab.kernels.of(shown.settings);
      return Array.from({ length: 61 }, (_, k) => {
        const when = (k / 60) * (time.at(-1) - time[0]) + time[0];
        const body = new Body(this.engine, this.lab.model, shown, functions, between(time, when));
        const [places, found] = [shown.truth, shown.estimate].map((rows) => body.places(body.state(rows)));
        const [there, middle] = [places.map((place) => body.toWorld(place)), body.toWorld(middleOf(found))];
        return { time: when, camera: body.toWorld([0, 0, 0]), places: there, found: middle };
      });
    });
  }

  worldGoal(scene) {
    const box = [Infinity, -Infinity, Infinity, -Infinity];
    const take = ([x, , z]) => {
      [box[0], box[1]] = [Math.min(box[0], x), Math.max(box[1], x)];
      [box[2], box[3]] = [Math.min(box[2], z), Math.max(box[3], z)];
    };
    for (const { camera, places } of this.pathOf(scene)) [camera, ...places].forEach(take);
    if (scene.why) this.seen.places.forEach((place) => take(this.seen.body.toWorld(place.map((value) => 2 * value))));
    const { copyInWorld, prelude } = this.seen;
    if (copyInWorld && !prelude && !this.twin.grip) copyInWorld.forEach(take);
    const { width, height } = this.world.size ?? { width: 350, height: 300 };
    const scale = Math.min((width - 50) / (box[1] - box[0] + 0.5), (height - 60) / (box[3] - box[2] + 0.5));
    return [(box[0] + box[1]) / 2, (box[2] + box[3]) / 2, scale];
  }

  chartOf(scene) {
    return chartOf(scene);
  }

  sentence(scene) {
    return sentenceOf(scene, this.seen, this.moved);
  }
}

function middleOf(places) {
  return places[0].map((_, i) => places.reduce((sum, place) => sum + place[i], 0) / places.length);
}
