// A world that stands still while a camera moves through it: where what the camera sees is, and where it is itself.

import { stepOf } from "../../engine/path.js";
import { sampleAt } from "../../engine/tables.js";

/** @typedef {number[]} Affine  three rows of a matrix and a vector, for x -> M x + v */

/** @type {Affine} */
const SAME = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
/** How many standing things there are, and their distances ahead in metres. */
const [THINGS, NEAREST, FARTHEST] = [120, 4, 48];
/** Most ways to the world that are remembered: a picture asks for hundreds, and the next one for the same. */
const MOST = 5000;
/** Steps of a sequence that fills a cube evenly. */
const STEPS = [0.8191725, 0.6710436, 0.5497005];

/** True if a motion x' = A x + b is that of standing things before a camera which turns and travels. */
export function isRigid(A) {
  return A.every((row, i) => row.every((value, j) => Math.abs(value + A[j][i]) < 1e-12));
}

/** Where a motion leads in a time, which may be negative. */
export function flow({ A, b }, time) {
  const sign = time < 0 ? -1 : 1;
  const rates = A.flatMap((row, i) => [...row, b[i]].map((value) => sign * value));
  const size = Math.max(...A.flat().map(Math.abs)) * 3;
  const { rows } = stepOf(Math.abs(time), size, rates, new Float64Array(3));
  return SAME.map((value, k) => value + rows[k]);
}

export function apply(/** @type {Affine} */ map, /** @type {number[]} */ [x, y, z]) {
  return [0, 4, 8].map((row) => map[row] * x + map[row + 1] * y + map[row + 2] * z + map[row + 3]);
}

/** The first map after the second. */
function after(first, second) {
  const columns = [0, 1, 2, 3].map((c) => {
    const column = [second[c], second[4 + c], second[8 + c]];
    return [0, 4, 8].map((row, i) => apply(first, column)[i] - (c < 3 ? first[row + 3] : 0));
  });
  return SAME.map((_, k) => columns[k % 4][Math.floor(k / 4)]);
}

/** The way back of a map that turns and moves. */
export function back(map) {
  const turned = SAME.map((_, k) => (k % 4 < 3 ? map[4 * (k % 4) + Math.floor(k / 4)] : 0));
  const moved = apply(turned, [map[3], map[7], map[11]]);
  return turned.map((value, k) => (k % 4 < 3 ? value : -moved[Math.floor(k / 4)]));
}

/** A camera's place in a standing world: known at one time, and by its motion at all others. */
export class Standing {
  at = 0;
  pose = SAME;
  known = { motion: null, /** @type {Map<number, Affine>} */ ways: new Map() };

  /** Let the camera stand at time 0 where the world begins. */
  begin() {
    this.at = 0;
    this.pose = SAME;
    this.known.motion = null;
  }

  /** Keep the present place of the camera, whatever its motion will be. */
  keep(motion, time) {
    this.pose = this.toWorld(motion, time);
    this.at = time;
    this.known.motion = null;
  }

  /** From what the camera sees at a time to the world; a motion that is not rigid has the camera for its world. */
  toWorld(motion, time) {
    if (motion !== this.known.motion || this.known.ways.size > MOST) this.known = { motion, ways: new Map() };
    const { ways } = this.known;
    const way = ways.get(time) ?? (isRigid(motion.A) ? after(this.pose, flow(motion, this.at - time)) : SAME);
    ways.set(time, way);
    return way;
  }
}

/**
 * From what a camera sees at a time of a sampled motion to the world, which is what it sees at the first sample; null
 * where the motion is not rigid.
 */
export function wayOf({ times, rows }) {
  const motionOf = (row) => ({ A: [0, 3, 6].map((k) => row.slice(k, k + 3)), b: row.slice(9, 12) });
  if (!rows.every((row) => isRigid(motionOf(row).A))) return null;
  const between = (k) => motionOf(rows[k].map((value, p) => (value + (rows[k + 1] ?? rows[k])[p]) / 2));
  const maps = [SAME];
  for (let k = 1; k < times.length; k++) maps.push(after(maps[k - 1], flow(between(k - 1), times[k - 1] - times[k])));
  return (time) => {
    const k = sampleAt(times, time);
    return after(maps[k], flow(between(k), times[k] - time));
  };
}

/** Standing things, near and far alike in the image. */
export const STANDING_THINGS = Array.from({ length: THINGS }, (_, k) => {
  const [far, across, up] = STEPS.map((step) => (k * step) % 1);
  const z = NEAREST + (FARTHEST - NEAREST) * far ** 1.5;
  return [z * (3 * across - 1.5), z * (1.6 * up - 0.8), z];
});
