// Excitation of a run.

import { slackOf } from "../../engine/tables.js";

/** Smallest eigenvalue of a symmetric matrix of size 1 or 2, given row by row. */
export function smallestEigenvalue(matrix) {
  if (matrix.length === 1) return matrix[0];
  const [a, b, , d] = matrix;
  const mean = (a + d) / 2;
  const root = Math.hypot((a - d) / 2, b);
  // The quotient keeps digits that the difference of two almost equal numbers would lose.
  return mean > 0 ? (a * d - b * b) / (mean + root) : mean - root;
}

/**
 * Smallest eigenvalue of the integral of w w^T over the window that ends at each sample, from one window on; before
 * that since the first.
 */
export function windowed(time, w, hidden, measured, window) {
  const samples = time.length;
  const size = hidden * hidden;
  const gathered = new Float64Array(samples * size);
  const before = new Float64Array(size);
  const now = new Float64Array(size);
  for (let k = 0; k < samples; k++) {
    for (let i = 0; i < hidden; i++) {
      for (let j = 0; j < hidden; j++) {
        let sum = 0;
        for (let m = 0; m < measured; m++) {
          sum += w[(k * hidden + i) * measured + m] * w[(k * hidden + j) * measured + m];
        }
        now[i * hidden + j] = sum;
      }
    }
    for (let c = 0; c < size && k > 0; c++) {
      gathered[k * size + c] = gathered[(k - 1) * size + c] + ((time[k] - time[k - 1]) * (before[c] + now[c])) / 2;
    }
    before.set(now);
  }
  const least = window - slackOf(time);
  const first = time.findIndex((t) => t - time[0] >= least);
  const ends = time.subarray(first < 0 ? samples : first);
  const smallest = new Float64Array(ends.length);
  const inside = new Array(size);
  let at = 0;
  for (let k = 0; k < ends.length; k++) {
    const begin = Math.max(ends[k] - window, time[0]);
    while (at + 2 < samples && time[at + 1] <= begin) at++;
    const part = Math.min(1, (begin - time[at]) / (time[at + 1] - time[at]));
    for (let c = 0; c < size; c++) {
      const low = gathered[at * size + c];
      const start = low + (gathered[(at + 1) * size + c] - low) * part;
      inside[c] = gathered[(first + k) * size + c] - start;
    }
    smallest[k] = smallestEigenvalue(inside);
  }
  const earlier = time.subarray(0, first < 0 ? samples : first + 1);
  const since = Float64Array.from(earlier, (_, k) => smallestEigenvalue(gathered.subarray(k * size, (k + 1) * size)));
  return { time: ends, smallest, begun: { time: earlier, smallest: since } };
}
