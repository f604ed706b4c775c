// Condition (14): what the images of each window tell of the state, as points/gramian.py has it.

import { eigen, spectrum } from "./symmetric.js";

const MOST_MATRICES = 3000;

/**
 * Smallest and largest eigenvalue of the integral of Phi^T S Phi over windows that begin at samples.
 *
 * The states are vectors of three entries, and A moves each of them by itself: so Phi is made of blocks 3 x 3, the
 * integral is gathered once from the beginning on, and a window's is a difference, seen through the blocks' inverses.
 */
export class Gramian {
  constructor(layout, { block, unseen }, n, room) {
    Object.assign(this, { layout, block, unseen, n, room, vectors: n / 3 });
    const { rows, columns, which } = layout;
    const entries = Array.from({ length: this.vectors }, () => []);
    rows.forEach((row, e) => columns[e] < n && entries[(row / 3) | 0].push([3 * (row % 3) + (columns[e] % 3), which[e]]));
    // Vectors with the same coefficients have the same Phi.
    const kinds = new Map(entries.map((list) => [JSON.stringify(list), list]));
    this.kinds = [...kinds.values()];
    this.kindOf = entries.map((list) => [...kinds.keys()].indexOf(JSON.stringify(list)));
  }

  /** Phi of each kind from the first sample on, by the Runge-Kutta method; `known` has a row for each half step. */
  transitions(time, known, width) {
    const samples = time.length;
    return this.kinds.map((list, kind) => {
      const Phi = this.room(`transitions ${kind}`, 9 * samples);
      const A = [0, 1, 2].map(() => new Float64Array(9));
      const [k1, k2, k3, k4, stage, step] = Array.from({ length: 6 }, () => new Float64Array(9));
      Phi.fill(0, 0, 9);
      Phi[0] = Phi[4] = Phi[8] = 1;
      for (let k = 0; k + 1 < samples; k++) {
        const h = time[k + 1] - time[k];
        A.forEach((matrix, half) => list.forEach(([place, w]) => (matrix[place] = known[(2 * k + half) * width + w])));
        k1.set(A[0]);
        times(A[1], onward(stage, h / 2, k1), k2);
        times(A[1], onward(stage, h / 2, k2), k3);
        times(A[2], onward(stage, h, k3), k4);
        for (let i = 0; i < 9; i++) step[i] = (i % 4 ? 0 : 1) + (h / 6) * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
        times(step, Phi.subarray(9 * k, 9 * k + 9), Phi.subarray(9 * k + 9, 9 * k + 18));
      }
      return Phi;
    });
  }

  /** The windows' beginnings, with smallest and largest eigenvalues; of many windows some, and all about the weakest. */
  windows(time, images, known, width, window) {
    const { n } = this;
    const samples = time.length;
    this.Phi = this.transitions(time, known, width);
    this.gathered = this.gather(time, images);
    this.ends = endsOf(time, window);
    const count = this.ends.length;
    const every = Math.max(1, Math.ceil((count * n) / MOST_MATRICES));
    const found = new Map();
    const look = (k) => found.get(k) ?? found.set(k, spectrum(this.matrix(k), n, this.unseen)).get(k);
    for (let k = 0; k < count; k += every) look(k);
    look(count - 1);
    const sorted = () => [...found.keys()].sort((a, b) => a - b);
    const least = (of) => sorted().reduce((a, b) => (of(found.get(b)) < of(found.get(a)) ? b : a));
    // Windows that miss directions come first, and of them those that miss most.
    const weakness = ({ smallest, largest, missed }) => (missed ? -missed : smallest / Math.max(largest, 1e-300));
    for (const of of [weakness, ({ smallest }) => smallest]) {
      const middle = least(of);
      for (let k = Math.max(0, middle - every + 1); k < Math.min(count, middle + every); k++) look(k);
    }
    const begins = sorted();
    const column = (name) => Float64Array.from(begins, (k) => found.get(k)[name]);
    const weakest = least(weakness);
    return {
      window,
      samples,
      time: Float64Array.from(begins, (k) => time[k]),
      smallest: column("smallest"),
      largest: column("largest"),
      weakest,
      eigen: eigen(this.matrix(weakest), n),
    };
  }

  /** Integrals from the first sample to each. */
  gather(time, images) {
    const { n, Phi, kindOf } = this;
    const { begins, axes, states, entries } = this.layout;
    const { N, l } = this.block;
    const points = begins.length - 1;
    const size = n * n;
    const gathered = this.room("gathered", size * time.length);
    const now = new Float64Array(size);
    const before = new Float64Array(size);
    const row = new Float64Array(n);
    gathered.fill(0, 0, size);
    for (let k = 0; k < time.length; k++) {
      now.fill(0);
      for (let p = 0; p < points; p++) {
        for (let m = 0; m < 2; m++) {
          const y = images[2 * (k * points + p) + m];
          if (Number.isNaN(y)) continue;
          // The row of B C Phi: each entry of C brings a row of its vector's Phi.
          const used = new Set();
          for (let e = begins[p]; e < begins[p + 1]; e++) {
            const vector = (states[e] / 3) | 0;
            if (!used.has(vector)) row.fill(0, 3 * vector, 3 * vector + 3);
            used.add(vector);
            const factor = entries[e] * (N[m][axes[e]] - y * l[axes[e]]);
            const at = 9 * k + 3 * (states[e] % 3);
            const matrix = Phi[kindOf[vector]];
            for (let c = 0; c < 3; c++) row[3 * vector + c] += factor * matrix[at + c];
          }
          for (const u of used) {
            for (const v of used) {
              for (let i = 3 * u; i < 3 * u + 3; i++) for (let j = 3 * v; j < 3 * v + 3; j++) now[i * n + j] += row[i] * row[j];
            }
          }
        }
      }
      const half = k ? (time[k] - time[k - 1]) / 2 : 0;
      for (let i = 0; k && i < size; i++) gathered[k * size + i] = gathered[(k - 1) * size + i] + half * (before[i] + now[i]);
      before.set(now);
    }
    return gathered;
  }

  /** The matrix of the window that begins at a sample. */
  matrix(first) {
    const { n, gathered, vectors, kindOf } = this;
    const size = n * n;
    const back = this.Phi.map((Phi) => inverse(Phi.subarray(9 * first, 9 * first + 9)));
    const from = first * size;
    const to = this.ends[first] * size;
    const found = new Float64Array(size);
    const [part, half, whole] = [0, 1, 2].map(() => new Float64Array(9));
    for (let u = 0; u < vectors; u++) {
      for (let v = u; v < vectors; v++) {
        for (let i = 0; i < 9; i++) {
          const at = (3 * u + ((i / 3) | 0)) * n + 3 * v + (i % 3);
          part[i] = gathered[to + at] - gathered[from + at];
        }
        times(part, back[kindOf[v]], half);
        times(transposed(back[kindOf[u]]), half, whole);
        for (let i = 0; i < 9; i++) {
          const [r, c] = [3 * u + ((i / 3) | 0), 3 * v + (i % 3)];
          found[r * n + c] = found[c * n + r] = whole[i];
        }
      }
    }
    return found;
  }
}

/** For each window that fits, the sample at which it ends. */
function endsOf(time, window) {
  const ends = [];
  let end = 0;
  for (let k = 0; k < time.length; k++) {
    while (end < time.length && time[end] < time[k] + window - 1e-9) end++;
    if (end === time.length) break;
    ends.push(end);
  }
  return ends;
}

function times(a, b, out) {
  for (let i = 0; i < 9; i += 3) {
    for (let j = 0; j < 3; j++) out[i + j] = a[i] * b[j] + a[i + 1] * b[3 + j] + a[i + 2] * b[6 + j];
  }
  return out;
}

/** The unit matrix and a multiple of another one. */
function onward(out, factor, matrix) {
  for (let i = 0; i < 9; i++) out[i] = (i % 4 ? 0 : 1) + factor * matrix[i];
  return out;
}

function transposed(m) {
  return [m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]];
}

function inverse(m) {
  const cofactor = (i, j) => {
    const at = (r, c) => m[3 * ((i + r) % 3) + ((j + c) % 3)];
    return at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1);
  };
  const determinant = m[0] * cofactor(0, 0) + m[1] * cofactor(0, 1) + m[2] * cofactor(0, 2);
  return Float64Array.from({ length: 9 }, (_, i) => cofactor(i % 3, (i / 3) | 0) / determinant);
}
