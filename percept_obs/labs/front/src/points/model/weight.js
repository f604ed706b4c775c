// @ts-check
// P of the observer: what is given of it over time, and where a computed one begins.

import { eigen } from "./symmetric.js";

/** Kinds of a P that is computed as the observer goes. */
const COMPUTED = ["lyapunov", "riccati"];

export function isComputed({ weight }) {
  return COMPUTED.includes(weight);
}

/** What is typed for P in settings: P over time, or where a computed one begins; empty where nothing is. */
export function textOfP({ weight, P, P0 }) {
  return weight === "typed" ? P : COMPUTED.includes(weight) ? P0.trim() : "";
}

/** What Python read of it, as blocks of 1, 3 or all states; a multiple of the identity where nothing is typed. */
export function readP({ written = {} }, settings) {
  const { block = 1, varies = true, python } = written[textOfP(settings)] ?? {};
  return { block, varies, python };
}

/** Whether P couples states that nothing else couples. */
export function isFull(model, settings) {
  return readP(model, settings).block > 3;
}

/** Why P does not fit a state of so many entries; empty if it does. */
export function misfit(model, settings, n) {
  const { block } = readP(model, settings);
  if ([1, 3, n].includes(block)) return "";
  return `P is of ${block} × ${block}, and the state has ${n} entries. Type a number, 3 × 3 for each vector of three states, or ${n} × ${n}.`;
}

/** The inverse of a P that is given, as blocks of so many states: at each of the places, or once where it stays. */
export function inversesOf(model, settings, places, { typed }) {
  const { weight, size, final, duration } = settings;
  const scheduled = (t) => 1 / (size * (final / size) ** (t / duration));
  if (weight === "scheduled") return { block: 1, stays: false, rows: Float64Array.from(places, scheduled) };
  if (weight !== "typed") return { block: 1, stays: true, rows: Float64Array.of(1 / size) };
  const { block, varies } = readP(model, settings);
  const entries = block * block;
  const times = varies ? places : places.subarray(0, 1);
  const rows = new Float64Array(entries * times.length);
  times.forEach((t, k) => fillInverse(typed([t, size], rows.subarray(entries * k, entries * k + entries)), block, t));
  return { block, stays: !varies, rows };
}

/** Where a computed P of so many states begins. */
export function startOfP(model, settings, n, { typed }) {
  const { block } = readP(model, settings);
  const given = textOfP(settings) ? typed([0, settings.size], new Float64Array(block * block)) : [settings.size];
  const start = new Float64Array(n * n);
  for (let i = 0; i < n; i++) {
    const first = i - (i % block);
    for (let j = 0; j < block; j++) start[i * n + first + j] = given[(i - first) * block + j];
  }
  return start;
}

function fillInverse(matrix, n, t) {
  const found = eigen(matrix, n);
  if (!(found[0].value > 0 && found[n - 1].value < Infinity)) {
    throw new Error(`P has the eigenvalue ${found[0].value.toPrecision(3)} at ${t.toPrecision(3)} s. It must be positive definite at all times: type another one.`);
  }
  matrix.fill(0);
  for (const { value, vector } of found) {
    for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) matrix[i * n + j] += (vector[i] * vector[j]) / value;
  }
}
