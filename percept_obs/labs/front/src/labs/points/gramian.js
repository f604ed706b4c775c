// Condition (14): what the images of each window tell of the state, as points/gramian.py has it.

import { derived } from "../../engine/derived.js";
import { slackOf } from "../../engine/tables.js";
import { ENTRIES } from "./flow.js";
import { spectrum } from "./symmetric.js";

const MOST_NUMBERS = 1500;

/**
 * Smallest and largest eigenvalue of the integral of Phi^T S Phi over windows that begin at samples, and the whole
 * matrix of the window that misses most directions or shows one least.
 *
 * As Phi is made of blocks 3 x 3, the integral is gathered once from the first sample on, in the blocks of vectors that
 * a point has together, and a window's is a difference, seen through the inverses of Phi's blocks. Of many windows some
 * are looked at, and all about the weakest.
 */
export function windowsOf(given) {
  const { layout, model, n, time, kindOf, back, window, memory } = given;
  const blocks = derived(layout, "blocks", () => blocksOf(layout));
  const gathered = gather(given, blocks);
  const ends = endsOf(time, window);
  const matrix = (first, room) => between(gathered, blocks, first, ends[first], n, kindOf, back, room);
  const room = memory.room("matrix", n * n);
  const every = Math.max(1, Math.ceil((ends.length * n) / MOST_NUMBERS));
  const found = new Map();
  const look = (k) => found.get(k) ?? found.set(k, spectrum(matrix(k, room), n, model.unseen, blocks.parts)).get(k);
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
    matrix: matrix(weakest, new Float64Array(n * n)),
  };
}

/**
 * Pairs of vectors that a point has together: all of them once, and for each point its vectors and its pairs' numbers;
 * `parts` are the states of vectors that such pairs join: with others they have no entry in the matrix.
 */
function blocksOf({ begins, states }) {
  const all = /** @type {number[][]} */ ([]);
  const numbers = new Map();
  const numberOf = (u, v) => {
    const key = `${u} ${v}`;
    if (!numbers.has(key)) numbers.set(key, all.push([u, v]) - 1);
    return numbers.get(key);
  };
  const ofPoints = begins.slice(1).map((end, p) => {
    const own = states.slice(begins[p], end).map((state) => (state / 3) | 0);
    const vectors = /** @type {number[]} */ ([...new Set(own)].sort((u, v) => u - v));
    const pairs = vectors.flatMap((u, i) => vectors.slice(i).map((v) => [u, v, numberOf(u, v)]));
    return { vectors, pairs: Int32Array.from(pairs.flat()) };
  });
  return { all, ofPoints, parts: partsOf(all) };
}

/** States of the vectors that pairs join, for each group of vectors by itself. */
function partsOf(pairs) {
  let groups = /** @type {number[][]} */ ([]);
  for (const pair of pairs) {
    const apart = groups.filter((group) => !pair.some((vector) => group.includes(vector)));
    const joined = groups.filter((group) => !apart.includes(group));
    groups = [...apart, [...new Set([...pair, ...joined.flat()])]];
  }
  return groups.map((group) => group.sort((u, v) => u - v).flatMap((v) => [3 * v, 3 * v + 1, 3 * v + 2]));
}

/** Integrals from the first sample to each, nine numbers a block. */
function gather({ layout, model, n, time, images, kindOf, flows, memory }, { all, ofPoints }) {
  const { begins, axes, states, entries } = layout;
  const { N, l } = model.block;
  const points = begins.length - 1;
  const size = 9 * all.length;
  const gathered = memory.room("gathered", size * time.length);
  const [now, before] = [memory.room("gathered now", size), memory.room("gathered before", size)];
  const row = new Float64Array(n);
  gathered.fill(0, 0, size);
  for (let k = 0; k < time.length; k++) {
    now.fill(0);
    for (let p = 0; p < points; p++) {
      const { vectors, pairs } = ofPoints[p];
      for (let m = 0; m < 2; m++) {
        const y = images[2 * (k * points + p) + m];
        if (Number.isNaN(y)) continue;
        for (const v of vectors) row[3 * v] = row[3 * v + 1] = row[3 * v + 2] = 0;
        // The row of B C Phi: each entry of C brings a row of its vector's Phi.
        for (let e = begins[p]; e < begins[p + 1]; e++) {
          const v = (states[e] / 3) | 0;
          const factor = entries[e] * (N[m][axes[e]] - y * l[axes[e]]);
          const flow = flows[kindOf[v]];
          const at = ENTRIES * k + 4 * (states[e] % 3);
          for (let c = 0; c < 3; c++) row[3 * v + c] += factor * flow[at + c];
        }
        for (let t = 0; t < pairs.length; t += 3) {
          const u = 3 * pairs[t];
          const v = 3 * pairs[t + 1];
          const to = 9 * pairs[t + 2];
          for (let i = 0; i < 3; i++) for (let j = 0; j < 3; j++) now[to + 3 * i + j] += row[u + i] * row[v + j];
        }
      }
    }
    const half = k ? (time[k] - time[k - 1]) / 2 : 0;
    const to = k * size;
    for (let i = 0; k && i < size; i++) gathered[to + i] = gathered[to - size + i] + half * (before[i] + now[i]);
    before.set(now);
  }
  return gathered;
}

/** Integral between two samples, from the state at the first of them, in the room for a matrix. */
function between(gathered, { all }, first, last, n, kindOf, back, room) {
  const found = room.fill(0);
  const inside = new Float64Array(9);
  const half = new Float64Array(9);
  const at = 9 * first;
  all.forEach(([u, v], block) => {
    const [U, V] = [back[kindOf[u]], back[kindOf[v]]];
    for (let c = 0; c < 9; c++)
      inside[c] = gathered[9 * (last * all.length + block) + c] - gathered[9 * (first * all.length + block) + c];
    for (let i = 0; i < 3; i++) {
      const a = inside[3 * i];
      const b = inside[3 * i + 1];
      const c = inside[3 * i + 2];
      for (let j = 0; j < 3; j++) half[3 * i + j] = a * V[at + j] + b * V[at + 3 + j] + c * V[at + 6 + j];
    }
    for (let i = 0; i < 3; i++) {
      for (let j = 0; j < 3; j++) {
        const value = U[at + i] * half[j] + U[at + 3 + i] * half[3 + j] + U[at + 6 + i] * half[6 + j];
        found[(3 * u + i) * n + 3 * v + j] = found[(3 * v + j) * n + 3 * u + i] = value;
      }
    }
  });
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
