// The Cramer-Rao bound along the truth, the same numbers as cramer_rao() in Python.

import { alongSteps } from "../../engine/runge_kutta.js";
import { seesSize } from "./size.js";

const N = 3;

/** Why settings have no bound, or nothing. */
export function noBound({ scenario, noise, outputs }, { recordings }) {
  if (seesSize({ outputs })) return "Of the size no bound is drawn here; cramer_rao() in Python has it.";
  if (scenario in recordings) return "There is no bound of a recording: it does not say how large its noise is.";
  return noise.size > 0
    ? ""
    : "There is no bound without noise: every error can become as small as you like. Give the samples some noise.";
}

/** Variances at the start of the bound: of the noise, and of hidden coordinates as in Python. */
export function variancesOf({ noise: { kind, size } }, { bound }) {
  return { noise: size * size * bound.noise[kind], hidden: bound.hidden };
}

/**
 * Least relative standard deviation of the distance at each sample; measured outputs begin at their first sample.
 *
 * @param {any} result of a simulated point
 * @param {any} lines the grid's steps, and where the samples stand in it
 * @param {any} table the true motion's known numbers
 * @param {(x: Float64Array, out: Float64Array) => Float64Array} flow rates of the coordinates, then their Jacobian
 * @param {{noise: number, hidden: number}} variances
 * @returns {Float64Array}
 */
export function boundOf({ truth, outputs, measured, sampled, time }, { steps, index }, table, flow, variances) {
  const along = transitions(table, flow);
  const P = new Float64Array(N * N);
  for (let c = 0; c < N; c++) P[(N + 1) * c] = measured.includes(c) ? variances.noise : variances.hidden;
  const found = new Float64Array(time.length);
  for (let k = 0; k < time.length; k++) {
    if (k) {
      move(P, along(truth.subarray(N * (k - 1), N * k), steps, index[k - 1], index[k]));
      for (const c of measured) if (!Number.isNaN(outputs[k * sampled + c])) correct(P, c, variances.noise);
    }
    found[k] = Math.sqrt(Math.max(0, P[N * N - 1])) / truth[N * k + N - 1];
  }
  return found;
}

/** A function that tells how small errors of the coordinates move over steps from a place on: Phi, row by row. */
function transitions(table, flow) {
  const [state, F] = [new Float64Array(N + N * N), new Float64Array(N + N * N)];
  const x = new Float64Array(N + table.width);
  const Phi = state.subarray(N);
  x.set(table.rows.subarray(0, table.width), N);
  const along = alongSteps(state.length, table, (row, stage, out) => {
    for (let c = 0; c < N; c++) x[c] = stage[c];
    if (table.varying) for (let p = 0; p < table.width; p++) x[N + p] = table.rows[row + p];
    flow(x, F);
    for (let c = 0; c < N; c++) out[c] = F[c];
    product(F, stage, out, N);
  });
  return (start, ...steps) => {
    state.fill(0).set(start);
    for (let c = 0; c < N; c++) Phi[(N + 1) * c] = 1;
    along(state, ...steps);
    return Phi;
  };
}

const moved = new Float64Array(N * N);

/** P becomes Phi P Phi^T. */
function move(P, Phi) {
  product(Phi, P, moved, 0);
  for (let i = 0; i < N; i++) {
    for (let j = i; j < N; j++) {
      let sum = 0;
      for (let k = 0; k < N; k++) sum += moved[N * i + k] * Phi[N * j + k];
      P[N * i + j] = P[N * j + i] = sum;
    }
  }
}

/** Update P by a sample of a coordinate. */
function correct(P, c, noise) {
  const total = P[(N + 1) * c] + noise;
  const shared = P.slice(N * c, N * c + N);
  for (let i = 0; i < N; i++) for (let j = 0; j < N; j++) P[N * i + j] -= (shared[i] * shared[j]) / total;
}

/** Fill a matrix with the product of two, all of which begin at the same place of their arrays. */
function product(A, B, out, at) {
  for (let i = at; i < at + N * N; i += N) {
    for (let j = 0; j < N; j++) out[i + j] = A[i] * B[at + j] + A[i + 1] * B[at + N + j] + A[i + 2] * B[at + 2 * N + j];
  }
}
