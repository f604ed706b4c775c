// Where what a run tells is, in metres before the camera, and how it moves.

import { valueBetween } from "../../engine/between.js";
import { knownAt } from "../../engine/tables.js";
import { shapeOf } from "./camera.js";

/** The motion's A and b at a time that is shown. */
export function coefficientsAt(lab, { settings, time }, functions, at) {
  const { motion } = lab.results.engines[0].camera.motion(settings, functions);
  const { rows } = knownAt(motion, [], [valueBetween(time, 1, 0, at)]);
  return { A: [0, 3, 6].map((row) => Array.from(rows.subarray(row, row + 3))), b: Array.from(rows.subarray(9, 12)) };
}

/** Where a point of image coordinates and inverse distance is, in metres. */
export function placesOf(lab, { settings }) {
  const { ray } = lab.kernels.of(settings);
  const shape = shapeOf(settings);
  const placeOf = (/** @type {number[]} */ [y1, y2, inverse]) =>
    Array.from(ray([y1, y2, ...shape], new Float64Array(3)), (value) => value / inverse);
  return placeOf;
}
