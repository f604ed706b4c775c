// Measures of a run of many points: size and decay of the error, times when points were not seen.

import { spansOf } from "../../engine/tables.js";
import { placed } from "./flow.js";

/** Norm of each row of n numbers. */
export function norms(rows, n) {
  const found = new Float64Array(rows.length / n);
  for (let k = 0; k < found.length; k++) for (let i = k * n; i < k * n + n; i++) found[k] += rows[i] ** 2;
  return found.map(Math.sqrt);
}

/** Distance of each point in states from the origin, a column each. */
export function distancesOf(layout, rows, n) {
  const place = new Float64Array(3);
  return Array.from({ length: layout.begins.length - 1 }, (_, p) => {
    const found = new Float64Array(rows.length / n);
    for (let k = 0; k < found.length; k++) {
      placed(layout, rows, k * n, p, place);
      found[k] = Math.sqrt(place[0] * place[0] + place[1] * place[1] + place[2] * place[2]);
    }
    return found;
  });
}

/** The largest of several columns at each sample; NaN where one of them is not there. */
export function largestOf(columns) {
  return columns[0].map((_, k) => columns.reduce((most, values) => Math.max(most, values[k]), 0));
}

/** The exponential fitted to the last two thirds of an error: its rate and its logarithm at time 0, or null. */
export function decayRate(time, size) {
  const begin = time.at(-1) / 3;
  let [count, t, l, tt, tl] = [0, 0, 0, 0, 0];
  for (let k = 0; k < time.length; k++) {
    if (time[k] < begin) continue;
    const value = Math.log(size[k]);
    if (!Number.isFinite(value)) return null;
    count += 1;
    t += time[k];
    l += value;
    tt += time[k] * time[k];
    tl += time[k] * value;
  }
  const spread = count * tt - t * t;
  if (count < 2 || !(spread > 0)) return null;
  const slope = (count * tl - t * l) / spread;
  return { rate: -slope, begin, level: (l - slope * t) / count };
}

/** Spans of samples from begin to end in which a point is not seen. */
export function absencesOf(time, outputs, points, point) {
  const spans = spansOf(time.length, (k) => Number.isNaN(outputs[2 * (k * points + point)]));
  const endOf = (last) => time[Math.min(last + 1, time.length - 1)];
  return spans.map(({ first, last }) => ({ first, last, begin: time[first], end: endOf(last) }));
}
