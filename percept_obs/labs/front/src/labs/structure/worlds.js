// Worlds that make one film: the true one, scaled, or with another share of the motion for the camera.

import { derived } from "../../engine/derived.js";
import { between, valueBetween } from "../../engine/between.js";
import { quantityOf, rangeOf } from "./quantities.js";

/** Parts into which a run is divided to sum up a way. */
const PARTS = 400;
const AXES = [0, 1, 2];
const UP = 1;

/**
 * @typedef {object} World
 * @property {number} size     how many times as large as the true one it is
 * @property {number | null} share  of the motion along what is free that is the camera's; null for the true one
 */

/** @type {World} */
export const TRUE = { size: 1, share: null };

/** What is known, where these are not, and what the film leaves open. */
export function knowledgeOf(unknown) {
  const open = (name) => unknown.includes(name);
  const either = AXES.map((k) => open(`v_c${k + 1}`) || open(`v_p${k + 1}`));
  return {
    rests: !AXES.some((k) => open(`v_p${k + 1}`)),
    size: !open("d_s"),
    ahead: !open("v_c3"),
    sideways: !open("v_c1"),
    nothing: unknown.length === 0,
    /** Axes along which camera and object act by their difference only. */
    story: AXES.map((k) => open(`v_c${k + 1}`) && open(`v_p${k + 1}`)),
    /** Axes along which the camera's velocity is known, and the object's is not. */
    held: AXES.map((k) => !open(`v_c${k + 1}`) && open(`v_p${k + 1}`)),
    /** Axes along which a known velocity would tell the scale. */
    telling: either.map((one) => !one),
  };
}

/** Unknowns of what is ticked; how the camera rises is known where all the rest of its velocity is. */
export function unknownOf({ rests, size, ahead, sideways }, quantities) {
  const known = {
    ...{ d_s: size, v_c1: sideways, v_c2: ahead && sideways, v_c3: ahead },
    ...{ v_p1: rests, v_p2: rests, v_p3: rests },
  };
  return quantities.filter((name) => !known[name]);
}

/** The worlds that make the film of a result. */
export class Worlds {
  /** @param {(times: ArrayLike<number>) => {rows: Float64Array, varying: boolean}} velocities  rows of w_c, v_c, v_p */
  constructor(shown, velocities) {
    const { time, settings } = shown;
    this.shown = shown;
    this.known = knowledgeOf(settings.unknown);
    this.velocities = velocities;
    this.start = time[0];
    this.step = (time[time.length - 1] - time[0]) / PARTS;
    const { rows, varying } = velocities(Array.from({ length: PARTS + 1 }, (_, k) => time[0] + k * this.step));
    // Where the camera turns it is the world that is drawn before it.
    const turns = rows.subarray(0, 3).some((value) => value !== 0);
    const speed = (k, axis) => (turns ? 0 : rows[(varying ? 9 * k : 0) + 3 + axis]);
    this.ways = new Float64Array(3 * (PARTS + 1));
    for (let k = 1; k <= PARTS; k++) {
      for (const axis of AXES) {
        const passed = (this.step * (speed(k - 1, axis) + speed(k, axis))) / 2;
        this.ways[3 * k + axis] = this.ways[3 * k - 3 + axis] + passed;
      }
    }
    this.turns = turns;
  }

  /** The object's length in metres: d_s is one over it, as the measured length in the image is that over the depth. */
  get length() {
    return 1 / this.shown.scale;
  }

  /** The object before the true camera at a time, in metres. */
  before(time) {
    const { image, scale, time: samples } = this.shown;
    const at = between(samples, time);
    const [y1, y2, ybar3] = AXES.map((c) => valueBetween(image, 3, c, at));
    return [y1, y2, 1].map((value) => value / (scale * ybar3));
  }

  /** The true camera's way since the start. */
  way(time) {
    const part = this.step > 0 ? Math.min((time - this.start) / this.step, PARTS) : 0;
    const sample = Math.min(Math.floor(part), PARTS - 1);
    return AXES.map((axis) => valueBetween(this.ways, 3, axis, { sample, part: part - sample }));
  }

  /** Places of camera and object of a world, in metres from where its camera was at the start. */
  places(/** @type {World} */ world, time) {
    const [there, first, way] = [this.before(time), this.before(this.start), this.way(time)];
    const camera = this.ofCamera(world, way, AXES.map((k) => first[k] - there[k]));
    return { camera, object: camera.map((value, k) => value + world.size * there[k]) };
  }

  /** Velocities of camera and object of a world. */
  speeds(/** @type {World} */ world, time) {
    const [v_c, v_p] = this.truth(time);
    const apart = AXES.map((k) => v_c[k] - v_p[k]);
    const camera = this.ofCamera(world, v_c, apart);
    return { camera, object: camera.map((value, k) => value - world.size * apart[k]) };
  }

  truth(time) {
    const row = Array.from(this.velocities([time]).rows);
    return [row.slice(3, 6), row.slice(6, 9)];
  }

  /** Of a true way, or velocity, of the camera, and of that against the object: what it is in a world. */
  ofCamera({ size, share }, own, apart) {
    const { story, held } = this.known;
    return AXES.map((k) => {
      if (story[k] && share !== null) return size * share * apart[k];
      return held[k] ? own[k] : size * own[k];
    });
  }

  /** What the camera of a world sees, from that world's metres: y1, y2, and the object's length. */
  image(/** @type {World} */ world, time) {
    const { camera, object } = this.places(world, time);
    const [x, y, z] = object.map((value, k) => value - camera[k]);
    return [x / z, y / z, (world.size * this.length) / z];
  }

  /** Largest difference between the films of a world and of the result. */
  difference(/** @type {World} */ world) {
    const { time, image } = this.shown;
    let most = 0;
    for (let k = 0; k < time.length; k += Math.ceil(time.length / PARTS)) {
      this.image(world, time[k]).forEach((value, c) => (most = Math.max(most, Math.abs(value - image[3 * k + c]))));
    }
    return most;
  }

  /** What is known in metres a second and would tell the scale: of the true world, and in words. */
  reading(time) {
    const [v_c, v_p] = this.truth(time);
    const axes = AXES.filter((k) => this.known.telling[k] && (k !== UP || v_c[k] !== v_p[k]));
    if (!axes.length) return null;
    const vector = AXES.map((k) => (axes.includes(k) ? v_c[k] - v_p[k] : 0));
    if (axes.length > 1) return { vector, value: Math.hypot(...vector), along: "" };
    return { vector, value: vector[axes[0]], along: [" sideways", " up", " ahead"][axes[0]] };
  }
}

/** Estimated over true distance at the samples; with the size known, the speed against the object instead. */
export function ratiosOf(worlds, result, run) {
  return derived(run.estimate, "ratio to the truth", () => {
    if (!worlds.known.size) {
      const [found, right] = [run.estimate, result.truth].map((rows) => rangeOf(result, rows));
      return found.map((value, k) => value / right[k]);
    }
    return Float64Array.from(result.time, (_, sample) => {
      const [found, right] = [run.estimate, result.truth].map((rows) => {
        const { camera, object } = speedsIn(worlds, result, rows, { sample, part: 0 });
        return Math.hypot(...AXES.map((k) => camera[k] - object[k]));
      });
      return found / right;
    });
  });
}

/** Velocities of camera and object at a place between samples, as an observer has found them. */
export function estimatedSpeeds(worlds, result, run, at) {
  return speedsIn(worlds, result, run.estimate, at);
}

/** Velocities by rows of estimates, or of the truth; those that are known are true. */
function speedsIn(worlds, result, rows, at) {
  const { unknown } = result.choice;
  const known = derived(result.time, "velocities", () => worlds.velocities(result.time));
  const found = ["v_c", "v_p"].map((which, part) =>
    AXES.map((k) => {
      const name = `${which}${k + 1}`;
      if (unknown.includes(name)) return valueBetween(quantityOf(result, rows, name), 1, 0, at);
      return known.rows[(known.varying ? 9 * at.sample : 0) + 3 + 3 * part + k];
    }),
  );
  return { camera: found[0], object: found[1] };
}
