// The bound over the image, as percept_obs/observability/maps.py computes it and says what it means.

import { LONGEST_STEP } from "../../engine/integrator.js";
import { alongSteps } from "../../engine/runge_kutta.js";
import { known, sampleTimes, stepGrid } from "../../engine/tables.js";
import { variancesOf } from "./bound.js";

/** Intervals between the samples that a map is computed with; together they tell as much as those of the camera. */
const INTERVALS = 20;

/**
 * The bound over a square of the image, for points that are first seen there.
 *
 * @param {any} settings
 * @param {any} functions
 * @param {{motion: any, shape: number[]}} moving the motion, and the numbers of the surface's shape
 * @param {{centre: number[], half: number}} square
 * @param {number} resolution places along a side
 * @param {any} model
 */
export function mapOf(settings, functions, { motion, shape }, { centre, half }, resolution, model) {
  const { seconds, distance } = settings.map;
  const { noise, hidden } = variancesOf(settings, model);
  const period = seconds / INTERVALS;
  const noiseVariance = (noise * (INTERVALS + 1)) / sampleTimes(settings.period, seconds).length;
  const [y1, y2] = centre.map((c) => [c - half, c + half]);
  const along = (ends, k) => placeAlong(ends, resolution, k);
  const points = new Float64Array(3 * resolution * resolution);
  const seen = new Float64Array(2 + shape.length);
  const out = new Float64Array(3);
  seen.set(shape, 2);
  for (let i = 0; i < points.length / 3; i++) {
    seen[0] = along(y1, i % resolution);
    seen[1] = along(y2, Math.floor(i / resolution));
    functions.ray(seen, out);
    for (let c = 0; c < 3; c++) points[3 * i + c] = out[c] * distance;
  }
  const times = Float64Array.from({ length: INTERVALS + 1 }, (_, k) => period * k);
  const given = { points, ...displacements(motion, times), noiseVariance, hiddenVariance: hidden, shape };
  return { y1, y2, resolution, seconds, distance, period, noiseVariance, relative: boundMap(functions, given) };
}

/** Where one of so many places along a side lies. */
export function placeAlong(ends, resolution, k) {
  return ends[0] + ((ends[1] - ends[0]) * k) / (resolution - 1);
}

/** The value of a map at the place that is nearest; NaN outside. */
export function mapAt({ y1, y2, resolution, relative }, place) {
  const [i, j] = [y1, y2].map(([low, high], c) => Math.round(((place[c] - low) / (high - low)) * (resolution - 1)));
  return i >= 0 && i < resolution && j >= 0 && j < resolution ? relative[j * resolution + i] : NaN;
}

/** Phi and what is moved, of X(t) = Phi X(0) + moved at times from 0 on. */
function displacements(motion, times) {
  const { grid, index, steps } = stepGrid(times, LONGEST_STEP);
  const table = known(motion, [], grid);
  const state = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0); // rows of Phi, each with what is moved behind it
  const Phi = new Float64Array(9 * times.length);
  const moved = new Float64Array(3 * times.length);
  const along = alongSteps(12, table, (row, stage, out) => {
    for (let i = 0; i < 3; i++) {
      for (let j = 0; j < 4; j++) {
        out[4 * i + j] = j === 3 ? table.rows[row + 9 + i] : 0;
        for (let k = 0; k < 3; k++) out[4 * i + j] += table.rows[row + 3 * i + k] * stage[4 * k + j];
      }
    }
  });
  for (let k = 0; k < times.length; k++) {
    if (k) along(state, steps, index[k - 1], index[k]);
    for (let i = 0; i < 3; i++) {
      for (let j = 0; j < 3; j++) Phi[9 * k + 3 * i + j] = state[4 * i + j];
      moved[3 * k + i] = state[4 * i + 3];
    }
  }
  return { Phi, moved };
}

/**
 * Least relative standard deviation of the distance of points, NaN where one comes behind the camera on the way.
 *
 * @param {Record<"begin" | "gather" | "finish", (x: Float64Array, out: Float64Array) => Float64Array>} kernel
 *   The printed functions of a surface and its measured outputs.
 * @param {object} given
 * @param {ArrayLike<number>} given.points Where the points begin, three numbers each.
 * @param {ArrayLike<number>} given.Phi Nine numbers for each sample: X = Phi X0 + moved.
 * @param {ArrayLike<number>} given.moved Three numbers for each sample.
 * @param {number} given.noiseVariance
 * @param {number} given.hiddenVariance
 * @param {ArrayLike<number>} [given.shape] What shapes the surface.
 * @returns {Float64Array} One number a point.
 */
export function boundMap({ begin, gather, finish }, given) {
  const { points, Phi, moved, noiseVariance, hiddenVariance, shape = [] } = given;
  const samples = moved.length / 3;
  const J = 6; // entries of the information, on and above its diagonal
  const whole = new Float64Array(J + 15 + shape.length);
  const place = whole.subarray(J);
  const start = new Float64Array(3 + shape.length);
  place.set(shape, 15);
  start.set(shape, 3);
  const share = new Float64Array(J + 1);
  const last = new Float64Array(1);
  const found = new Float64Array(points.length / 3);
  for (let i = 0; i < found.length; i++) {
    for (let j = 0; j < 3; j++) start[j] = place[12 + j] = points[3 * i + j];
    begin(start, share);
    for (let j = 0; j < J; j++) whole[j] = share[j] / hiddenVariance;
    let seen = true;
    for (let k = 0; k < samples && seen; k++) {
      for (let j = 0; j < 9; j++) place[j] = Phi[9 * k + j];
      for (let j = 0; j < 3; j++) place[9 + j] = moved[3 * k + j];
      gather(place, share);
      for (let j = 0; j < J; j++) whole[j] += share[j] / noiseVariance;
      seen = share[J] > 0;
    }
    found[i] = seen ? finish(whole, last)[0] : NaN;
  }
  return found;
}
