// Where what a run tells is, in metres before the camera, and how it moves.

import { valueBetween } from "../../engine/between.js";
import { knownAt } from "../../engine/tables.js";
import { shapeOf } from "./camera.js";

/** The motion's A and b at a time that is shown. */
export function coefficientsAt(lab, shown, functions, at) {
  const [row] = motionAt(lab, shown, functions, [valueBetween(shown.time, 1, 0, at)]).rows;
  return { A: [0, 3, 6].map((k) => row.slice(k, k + 3)), b: row.slice(9, 12) };
}

/** The motion's numbers at some times, as a table. */
export function motionAt(lab, { settings }, functions, times) {
  const { motion } = lab.results.engines[0].camera.motion(settings, functions);
  const { rows, width, varying } = knownAt(motion, [], times);
  const rowAt = (k) => Array.from(rows.subarray(width * k, width * k + width));
  return { times, rows: Array.from(times, (_, k) => rowAt(varying ? k : 0)) };
}

/** Where a point of image coordinates and inverse distance is, in metres. */
export function placesOf(lab, { settings }) {
  const { ray } = lab.kernels.of(settings);
  const shape = shapeOf(settings);
  const placeOf = (/** @type {number[]} */ [y1, y2, inverse]) =>
    Array.from(ray([y1, y2, ...shape], new Float64Array(3)), (value) => value / inverse);
  return placeOf;
}
