// Condition (14): what the images of each window tell of the state, as points/gramian.py has it.

import { slackOf } from "../../common/model/tables.js";
import { ENTRIES } from "./flow.js";
import { spectrum } from "./symmetric.js";

const MOST_NUMBERS = 1500;

/**
 * Smallest and largest eigenvalue of the integral of Phi^T S Phi over windows that begin at samples, and the whole
 * matrix of the window that misses most directions or shows one least.
 *
 * As Phi is made of blocks 3 x 3, the integral is gathered once from the first sample on, and a window's is a
 * difference, seen through the blocks' inverses.  Of many windows some are looked at, and all about the weakest.
 */
export function windowsOf({ layout, model, n, time, images, kindOf, flows, back, window, memory }) {
  const gathered = gather(layout, model.block, n, time, images, kindOf, flows, memory);
  const ends = endsOf(time, window);
  const matrix = (first) => between(gathered, first, ends[first], n, kindOf, back);
  const every = Math.max(1, Math.ceil((ends.length * n) / MOST_NUMBERS));
  const found = new Map();
  const look = (k) => found.get(k) ?? found.set(k, spectrum(matrix(k), n, model.unseen)).get(k);
  for (let k = 0; k < ends.length; k += every) look(k);
  look(ends.length - 1);
  const sorted = () => [...found.keys()].sort((a, b) => a - b);
  const least = (of) => sorted().reduce((a, b) => (of(found.get(b)) < of(found.get(a)) ? b : a));
  // Windows that miss directions come first, and of them those that miss most.
  const weakness = ({ smallest, largest, missed }) => (missed ? -missed : smallest / Math.max(largest, 1e-300));
  for (const of of [weakness, ({ smallest }) => smallest]) {
    const middle = least(of);
    for (let k = Math.max(0, middle - every + 1); k < Math.min(ends.length, middle + every); k++) look(k);
  }
  const begins = sorted();
  const column = (name) => Float64Array.from(begins, (k) => found.get(k)[name]);
  const weakest = least(weakness);
  return {
    window,
    time: Float64Array.from(begins, (k) => time[k]),
    smallest: column("smallest"),
    largest: column("largest"),
    weakest,
    matrix: matrix(weakest),
  };
}

/** Integrals from the first sample to each. */
function gather({ begins, axes, states, entries }, { N, l }, n, time, images, kindOf, flows, memory) {
  const points = begins.length - 1;
  const size = n * n;
  const gathered = memory.room("gathered", size * time.length);
  const [now, before] = [memory.room("gathered now", size), memory.room("gathered before", size)];
  const row = new Float64Array(n);
  const vectors = Array.from({ length: points }, (_, p) => [
    ...new Set(states.slice(begins[p], begins[p + 1]).map((state) => (state / 3) | 0)),
  ]);
  gathered.fill(0, 0, size);
  for (let k = 0; k < time.length; k++) {
    now.fill(0);
    for (let p = 0; p < points; p++) {
      const used = vectors[p];
      for (let m = 0; m < 2; m++) {
        const y = images[2 * (k * points + p) + m];
        if (Number.isNaN(y)) continue;
        for (const v of used) row[3 * v] = row[3 * v + 1] = row[3 * v + 2] = 0;
        // The row of B C Phi: each entry of C brings a row of its vector's Phi.
        for (let e = begins[p]; e < begins[p + 1]; e++) {
          const v = (states[e] / 3) | 0;
          const factor = entries[e] * (N[m][axes[e]] - y * l[axes[e]]);
          const flow = flows[kindOf[v]];
          const at = ENTRIES * k + 4 * (states[e] % 3);
          for (let c = 0; c < 3; c++) row[3 * v + c] += factor * flow[at + c];
        }
        for (const u of used) {
          for (const v of used) {
            for (let i = 3 * u; i < 3 * u + 3; i++) {
              for (let j = 3 * v; j < 3 * v + 3; j++) now[i * n + j] += row[i] * row[j];
            }
          }
        }
      }
    }
    const half = k ? (time[k] - time[k - 1]) / 2 : 0;
    const [from, to] = [(k - 1) * size, k * size];
    for (let i = 0; k && i < size; i++) gathered[to + i] = gathered[from + i] + half * (before[i] + now[i]);
    before.set(now);
  }
  return gathered;
}

/** What was gathered between two samples, from the state at the first of them. */
function between(gathered, first, last, n, kindOf, back) {
  const found = new Float64Array(n * n);
  const half = new Float64Array(9);
  const [from, to, at] = [first * n * n, last * n * n, 9 * first];
  for (let u = 0; u < n; u += 3) {
    const U = back[kindOf[u / 3]];
    for (let v = u; v < n; v += 3) {
      const V = back[kindOf[v / 3]];
      for (let i = 0; i < 3; i++) {
        const row = (u + i) * n + v;
        const a = gathered[to + row] - gathered[from + row];
        const b = gathered[to + row + 1] - gathered[from + row + 1];
        const c = gathered[to + row + 2] - gathered[from + row + 2];
        for (let j = 0; j < 3; j++) half[3 * i + j] = a * V[at + j] + b * V[at + 3 + j] + c * V[at + 6 + j];
      }
      for (let i = 0; i < 3; i++) {
        for (let j = 0; j < 3; j++) {
          const value = U[at + i] * half[j] + U[at + 3 + i] * half[3 + j] + U[at + 6 + i] * half[6 + j];
          found[(u + i) * n + v + j] = found[(v + j) * n + u + i] = value;
        }
      }
    }
  }
  return found;
}

/** For each window that fits, the sample at which it ends. */
function endsOf(time, window) {
  const ends = [];
  const least = window - slackOf(time);
  let end = 0;
  for (let k = 0; k < time.length; k++) {
    while (end < time.length && time[end] < time[k] + least) end++;
    if (end === time.length) break;
    ends.push(end);
  }
  return ends;
}
