// @ts-check
// Where a constant motion x' = A x + b leads, by the series of the exponential; as constant_path() in Python.

import { LARGEST_SQUARED_STATE } from "./integrator.js";

/** |A| times the time over which the series is summed; a longer time is divided. */
const REACH = 0.5;
/** Terms of that series: the next one is below 1e-18 of the first. */
const TERMS = 15;

/**
 * Fill in positions at the places of a grid that begins at time 0, the first place left out; NaN from where they leave
 * every bound.  `rates` has the rows of [A b].
 */
export function constantPath(start, rates, grid, index, points) {
  const size = Math.max(...[0, 1, 2].map((j) => Math.abs(rates[j]) + Math.abs(rates[4 + j]) + Math.abs(rates[8 + j])));
  const term = new Float64Array(3);
  let [x, y, z] = start;
  let step = stepOf(0, size, rates, term);
  points.fill(NaN);
  for (let k = 1; k < index.length; k++) {
    const end = grid[index[k]];
    const time = end - grid[index[k - 1]];
    // Equal intervals differ by the rounding of their ends, and lead alike.
    if (!(Math.abs(time - step.time) <= 4 * Number.EPSILON * end)) step = stepOf(time, size, rates, term);
    const m = step.rows;
    const dx = m[0] * x + m[1] * y + m[2] * z + m[3];
    const dy = m[4] * x + m[5] * y + m[6] * z + m[7];
    z += m[8] * x + m[9] * y + m[10] * z + m[11];
    x += dx;
    y += dy;
    if (!(x * x + y * y + z * z < LARGEST_SQUARED_STATE)) break;
    points[3 * k - 3] = x;
    points[3 * k - 2] = y;
    points[3 * k - 1] = z;
  }
  return points;
}

/**
 * Motion of a position over a time: the rows of a matrix and beside it those of a vector, from the images of 0 and to
 * the unit vectors. The position itself is left out, since its rounding would add up over the steps.
 */
export function stepOf(time, size, rates, term) {
  const pieces = Math.max(1, Math.ceil((size * time) / REACH));
  const still = Float64Array.from(rates, (value, at) => (at % 4 === 3 ? 0 : value));
  const rows = new Float64Array(12);
  for (let c = 0; c < 4; c++) {
    const added = new Float64Array(3);
    for (let piece = 0; piece < pieces; piece++) advance(added, c, term, c < 3 ? still : rates, time / pieces);
    for (let i = 0; i < 3; i++) rows[4 * i + c] = added[i];
  }
  return { time, rows };
}

/** Add h (A x + b) + h^2/2 A (A x + b) + ... to what was added, where x is that and the unit vector `c`, or 0 for 3. */
function advance(added, c, term, rates, time) {
  let [u, v, w] = [0, 1, 2].map((i) => added[i] + (i === c ? 1 : 0));
  let constant = 1;
  for (let k = 1; k <= TERMS; k++) {
    const share = time / k;
    for (let i = 0; i < 3; i++) {
      const row = 4 * i;
      term[i] = share * (rates[row] * u + rates[row + 1] * v + rates[row + 2] * w + constant * rates[row + 3]);
    }
    constant = 0;
    [u, v, w] = term;
    for (let i = 0; i < 3; i++) added[i] += term[i];
  }
}
