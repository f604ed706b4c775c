// @ts-check
// A state and its flow: vectors of three entries, each by itself, x(t) = Phi(t) x(0) + q(t).

import { INSTANTS } from "../../engine/integrator.js";
import { stepper } from "../../engine/runge_kutta.js";
import { EACH } from "../../engine/tables.js";

/** Numbers of a flow at a time: Phi and beside it q, row by row. */
export const ENTRIES = 12;

/** Vectors of a state that move alike: where the coefficients of each kind stand in [A v], and each vector's kind. */
export function kindsOf({ rows, columns, which }, n) {
  const entries = Array.from({ length: n / 3 }, () => /** @type {number[][]} */ ([]));
  rows.forEach((row, e) => {
    const column = columns[e] === n ? 3 : columns[e] % 3;
    entries[(row / 3) | 0].push([4 * (row % 3) + column, which[e]]);
  });
  const keys = entries.map((list) => JSON.stringify(list));
  const names = [...new Set(keys)];
  return { kinds: names.map((name) => entries[keys.indexOf(name)]), kindOf: keys.map((key) => names.indexOf(key)) };
}

/** The place of a point in metres, C x of the state that begins at a place of an array. */
export function placed({ begins, axes, states, entries }, values, begin, point, out) {
  out[0] = out[1] = out[2] = 0;
  for (let e = begins[point]; e < begins[point + 1]; e++) out[axes[e]] += entries[e] * values[begin + states[e]];
  return out;
}

/** The flow of a kind at the wanted ends of steps; `known` has a row for each instant at which a step looks. */
export function flowOf(kind, steps, known, width, wanted) {
  const found = new Float64Array(ENTRIES * wanted.length);
  const A = INSTANTS.map(() => new Float64Array(ENTRIES));
  const now = new Float64Array(ENTRIES);
  const step = stepper(ENTRIES);
  const rate = (instant, flow, out) => ratesOf(A[instant], flow, out);
  now[0] = now[5] = now[10] = 1;
  let next = 0;
  for (let k = 0; next < wanted.length; k++) {
    for (; wanted[next] === k; next++) found.set(now, ENTRIES * next);
    if (k === steps.length) break;
    for (let instant = 0; instant <= EACH; instant++) {
      const row = (EACH * k + instant) * width;
      for (let e = 0; e < kind.length; e++) A[instant][kind[e][0]] = known[row + kind[e][1]];
    }
    step(now, steps[k], rate);
  }
  return found;
}

/** Phi' = A Phi, q' = A q + v. */
function ratesOf(A, flow, rate) {
  for (let i = 0; i < 12; i += 4) {
    for (let j = 0; j < 4; j++) rate[i + j] = A[i] * flow[j] + A[i + 1] * flow[4 + j] + A[i + 2] * flow[8 + j];
    rate[i + 3] += A[i + 3];
  }
}

/** The inverse of Phi at each time, nine numbers a time. */
export function inversesOf(flow) {
  const found = new Float64Array((9 * flow.length) / ENTRIES);
  for (let k = 0; k * ENTRIES < flow.length; k++) {
    const at = (r, c) => flow[ENTRIES * k + 4 * (r % 3) + (c % 3)];
    const cofactor = (i, j) => at(i + 1, j + 1) * at(i + 2, j + 2) - at(i + 1, j + 2) * at(i + 2, j + 1);
    const determinant = at(0, 0) * cofactor(0, 0) + at(0, 1) * cofactor(0, 1) + at(0, 2) * cofactor(0, 2);
    for (let i = 0; i < 9; i++) found[9 * k + i] = cofactor(i % 3, (i / 3) | 0) / determinant;
  }
  return found;
}
