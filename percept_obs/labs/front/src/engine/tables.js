// Tables of the signals that an observer knows at the instants of every step; see tracking.py.

import { INSTANTS, PLANT_STEP, STEP_ROUNDING } from "./integrator.js";

/** Rows that a step adds to a table of known signals; its end is the next one's start. */
export const EACH = INSTANTS.length - 1;

/** The intervals between times in equal steps no longer than given; index says where in the grid the times stand. */
export function stepGrid(times, longest) {
  const index = new Int32Array(times.length);
  const counts = new Int32Array(times.length - 1);
  for (let k = 0; k < counts.length; k++) {
    const interval = times[k + 1] - times[k];
    counts[k] = interval > 0 ? Math.max(1, Math.ceil(interval / longest - STEP_ROUNDING)) : 0;
    index[k + 1] = index[k] + counts[k];
  }
  const grid = new Float64Array(index[index.length - 1] + 1);
  for (let k = 0; k < counts.length; k++) {
    const interval = times[k + 1] - times[k];
    for (let j = 1; j < counts[k]; j++) grid[index[k] + j] = times[k] + interval * (j / counts[k]);
  }
  for (let k = 0; k < index.length; k++) grid[index[k]] = times[k];
  return { grid, index, steps: differences(grid) };
}

export function differences(grid) {
  return grid.subarray(1).map((end, k) => end - grid[k]);
}

/**
 * The steps in which the truth moves: from time 0 on, with an end at each of the times, and at each of the breaks,
 * where its motion has a kink; index says where time 0 and the times stand.
 */
export function plantGrid(times, breaks = /** @type {number[]} */ ([])) {
  const last = times[times.length - 1];
  const places = [{ time: 0, wanted: true }, ...Array.from(times, (time) => ({ time, wanted: true }))];
  for (const time of breaks) if (time > 0 && time < last) places.push({ time, wanted: false });
  if (breaks.length) places.sort((one, other) => one.time - other.time);
  const { index, ...steps } = stepGrid(Float64Array.from(places, ({ time }) => time), PLANT_STEP);
  return { ...steps, index: index.filter((_, k) => places[k].wanted) };
}

export function sampleTimes(period, duration) {
  return Float64Array.from({ length: Math.floor(duration / period + 1e-9) + 1 }, (_, k) => period * k);
}

/** The times at which the steps of a grid look at known signals. */
export function instants(grid) {
  const times = new Float64Array(EACH * (grid.length - 1) + 1);
  for (let k = 0; k < times.length - 1; k++) {
    const [step, share] = [(k / EACH) | 0, INSTANTS[k % EACH]];
    times[k] = (1 - share) * grid[step] + share * grid[step + 1];
  }
  times[times.length - 1] = grid[grid.length - 1];
  return times;
}

/** Linear interpolation at increasing places, constant outside. */
export function interpolate(places, times, values) {
  const result = new Float64Array(places.length);
  const last = times.length - 1;
  let k = 0;
  for (let j = 0; j < places.length; j++) {
    const t = places[j];
    if (t <= times[0]) result[j] = values[0];
    else if (t >= times[last]) result[j] = values[last];
    else {
      while (times[k + 1] <= t) k++;
      result[j] = values[k] + ((values[k + 1] - values[k]) / (times[k + 1] - times[k])) * (t - times[k]);
    }
  }
  return result;
}

const fresh = (length) => new Float64Array(length);

/** One column of a table of rows. */
export function column(rows, width, which) {
  const result = new Float64Array(rows.length / width);
  for (let k = 0; k < result.length; k++) result[k] = rows[k * width + which];
  return result;
}

/** Each sample, or where it was lost (NaN) the last one before it; `room` gives an array to put it into. */
export function lastSamples(values, room = fresh) {
  const result = room(values.length);
  let last = NaN;
  for (let k = 0; k < values.length; k++) {
    if (values[k] === values[k]) last = values[k];
    result[k] = last;
  }
  return result;
}

/** Measured outputs as held at the instants of each step: rows of instants x outputs. */
export function held(columns, times, grid, index, hold, exact, room = fresh) {
  const outputs = columns.length;
  const steps = grid.length - 1;
  const row = INSTANTS.length * outputs;
  const table = room(steps * row);
  columns.forEach((values, m) => {
    if (hold === "zero") {
      let last = NaN;
      for (let k = 0; k + 1 < index.length; k++) {
        if (values[k] === values[k]) last = values[k];
        for (let at = index[k] * row + m; at < index[k + 1] * row; at += outputs) table[at] = last;
      }
      return;
    }
    const line = hold === "exact" ? exact[m] : lineThrough(values, times, instants(grid));
    for (let j = 0; j < steps; j++) {
      for (let i = 0; i <= EACH; i++) table[j * row + i * outputs + m] = line[EACH * j + i];
    }
  });
  return table;
}

function lineThrough(values, times, places) {
  if (!values.some(Number.isNaN)) return interpolate(places, times, values);
  const there = [...values.keys()].filter((k) => !Number.isNaN(values[k]));
  return interpolate(places, Float64Array.from(there, (k) => times[k]), Float64Array.from(there, (k) => values[k]));
}

/** Samples at the steps' ends at which they arrive, NaN at the others. */
export function arriving(columns, index, count, room = fresh) {
  const outputs = columns.length;
  const table = room(count * outputs).fill(NaN);
  for (let k = 0; k < index.length; k++) {
    for (let m = 0; m < outputs; m++) table[index[k] * outputs + m] = columns[m][k];
  }
  return table;
}

/** A table of sampled numbers, as Python tells it, with a list of each of its columns. */
export function withColumns({ times, rows }) {
  return { times, rows, columns: rows[0].map((_, p) => Float64Array.from(rows, (row) => row[p])) };
}

/** Numbers known at the instants of a grid's steps, or the one row that is constant. */
export function known(motion, shape, grid) {
  if (motion.along) return { rows: motion.along(grid, shape), width: motion.count + shape.length, varying: true };
  return knownAt(motion, shape, motion.times?.length === 1 ? grid : instants(grid));
}

/** Rows of known numbers at some times. */
export function knownAt(motion, shape, places) {
  if (motion.over) return { rows: motion.over(places, shape), width: motion.count + shape.length, varying: true };
  const width = motion.rows[0].length + shape.length;
  if (motion.times.length === 1)
    return { rows: Float64Array.from([...motion.rows[0], ...shape]), width, varying: false };
  const rows = new Float64Array(places.length * width);
  const still = shape.map((value) => new Float64Array(places.length).fill(value));
  const columns = [...motion.columns.map((values) => interpolate(places, motion.times, values)), ...still];
  columns.forEach((values, p) => values.forEach((value, k) => (rows[k * width + p] = value)));
  return { rows, width, varying: true };
}

/** The spans in which a key of each sample stays the same and is not 0: their first and last sample, and the key. */
export function spansOf(count, keyAt) {
  const spans = /** @type {{first: number, last: number, key: any}[]} */ ([]);
  for (let k = 0, before = 0; k < count; k++) {
    const key = keyAt(k);
    if (key && key === before) spans[spans.length - 1].last = k;
    else if (key) spans.push({ first: k, last: k, key });
    before = key;
  }
  return spans;
}

/** By how many seconds two times may differ and still be the same one, as slack_of() in Python. */
export function slackOf(time) {
  const gaps = Float64Array.from({ length: time.length - 1 }, (_, k) => time[k + 1] - time[k]).sort();
  const middle = (gaps.length - 1) / 2;
  return (1e-3 * (gaps[Math.floor(middle)] + gaps[Math.ceil(middle)])) / 2;
}

/** Seconds of a window: as long as asked, but no longer than a run, and no shorter than its intervals. */
export function windowIn(time, asked) {
  let longest = 0;
  for (let k = 1; k < time.length; k++) longest = Math.max(longest, time[k] - time[k - 1]);
  return Math.max(Math.min(asked, time[time.length - 1] - time[0]), longest);
}

/** The last sample that is not after a time. */
export function sampleAt(time, when) {
  let [low, high] = [0, time.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (time[middle] <= when + 1e-9) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** Which of increasing times a span needs to be drawn: its own, and one at either side. */
export function indicesIn(time, { low, high }) {
  return [sampleAt(time, low), Math.min(sampleAt(time, high) + 1, time.length - 1)];
}
