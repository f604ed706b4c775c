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
  const x = Float64Array.from(start);
  const term = new Float64Array(3);
  points.fill(NaN);
  for (let k = 1; k < index.length; k++) {
    const time = grid[index[k]] - grid[index[k - 1]];
    const pieces = Math.max(1, Math.ceil((size * time) / REACH));
    for (let piece = 0; piece < pieces; piece++) advance(x, term, rates, time / pieces);
    if (!(x[0] * x[0] + x[1] * x[1] + x[2] * x[2] < LARGEST_SQUARED_STATE)) break;
    points.set(x, 3 * k - 3);
  }
  return points;
}

/** x + h (A x + b) + h^2/2 A (A x + b) + ... */
function advance(x, term, rates, time) {
  let [a, b, c] = x;
  let constant = 1;
  for (let k = 1; k <= TERMS; k++) {
    const share = time / k;
    for (let i = 0; i < 3; i++) {
      const row = 4 * i;
      term[i] = share * (rates[row] * a + rates[row + 1] * b + rates[row + 2] * c + constant * rates[row + 3]);
    }
    constant = 0;
    [a, b, c] = term;
    x[0] += a;
    x[1] += b;
    x[2] += c;
  }
}
