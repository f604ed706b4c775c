// The whole of a lab's run: point, camera, observers. The same numbers as record() and track() in Python.

import { draws } from "./random.js";
import { arriving, column, differences, halves, held, known, knownAt, lastSamples, stepGrid } from "./tables.js";
import { hiddenError, settlingTime, windowed } from "./measures.js";

const PLANT_STEP = 0.005;
const LONGEST_STEP = 0.01;
const NOTHING = new Float64Array(0);

/** Runs settings; keeps the parts that the next settings do not change. */
export class Engine {
  constructor(model) {
    this.model = model;
    this.kept = new Map();
    this.rooms = new Map();
  }

  /** Everything that is shown for these settings, with the functions that Kernels.of() gave for them. */
  run(settings, kernels) {
    const chart = this.model.surfaces[settings.surface];
    const structure = chart.structures[settings.outputs.join("+")];
    const recording = this.recording(settings, kernels, chart);
    const shown = { settings, ...recording, width: chart.coordinates.length, names: chart.coordinates, runs: [] };
    const hiddenNames = structure.hidden.map((c) => chart.coordinates[c]);
    Object.assign(shown, { measured: structure.measured, hidden: structure.hidden, hiddenNames });
    Object.assign(shown, this.geometry(settings, kernels, structure));
    if (recording.problem) return shown;
    lazily(shown, "excitation", () => this.excitation(settings, shown, structure, kernels));
    shown.runs = settings.observers.map((name) =>
      this.follow(name, settings, shown, structure.observers[name], kernels.observers[name]),
    );
    return shown;
  }

  recording(settings, kernels, chart) {
    const recorded = track(settings, this.model);
    if (recorded) return this.once("track", [settings.scenario], () => readTrack(recorded));
    const { surface, normal, A, b, X0, period, duration, noise, dropout, seed } = settings;
    const place = [surface, normal, A, b, X0, period, duration];
    const seen = this.once("seen", place, () => this.see(settings, kernels, chart));
    if (seen.problem) return seen;
    return this.once("samples", [...place, noise, dropout, seed], () => {
      const { shape, loss } = this.once("draws", [noise.kind, seed, seen.time.length], () =>
        draws(noise.kind, seed, seen.time.length, 2),
      );
      return { ...seen, outputs: sampled(seen.truth, shape, loss, noise, dropout) };
    });
  }

  follow(name, settings, shown, kernel, functions) {
    const { time, outputs, measured, width } = shown;
    const observed = this.model.observers[name];
    const gains = Float64Array.from(observed.gains, (gain) => settings.gains[name][gain.name]);
    const columns = measured.map((c) => column(outputs, 2, c));
    const clock = track(settings, this.model) ? settings.scenario : [settings.period, time.length];
    const { grid, index, steps } = this.once("grid", clock, () => withSteps(stepGrid(time, LONGEST_STEP)));
    const exact = settings.hold === "exact" ? this.exact(shown, grid) : null;
    const believed = known(believedMotion(settings, shown.motion), shown.shape, grid);
    const start = startState(settings, kernel, functions, columns, gains);
    const states = this.room("states", grid.length * kernel.states).fill(NaN);
    const resets = this.room("resets", grid.length).fill(0);
    const diverged = functions.run(
      start,
      steps,
      held(columns, time, grid, index, settings.hold, exact && measured.map((c) => exact[c]), (length) =>
        this.room("held", length),
      ),
      believed.rows,
      arriving(columns, index, grid.length, (length) => this.room("arriving", length)),
      gains,
      believed.varying,
      states,
      resets,
    );
    const { estimate, deviation } = read(functions, kernel, states, index, columns, width);
    const result = {
      name,
      title: observed.title,
      order: Object.keys(this.model.observers).indexOf(name),
      estimate,
      deviation,
      resets: timesOf(resets, grid),
      divergedAt: diverged < 0 ? null : grid[diverged],
    };
    if (shown.truth) {
      result.error = hiddenError(shown.truth, estimate, width, shown.hidden);
      result.settling = settlingTime(time, result.error);
    }
    return result;
  }

  exact(shown, grid) {
    return this.once("exact", [shown.key, grid.length], () => shown.signal(halves(grid)));
  }

  excitation(settings, shown, structure, kernels) {
    const { time, measured, hidden, width } = shown;
    const source = shown.truth ? [shown.truth, width] : [shown.outputs, 2];
    const columns = measured.map((c) => (shown.truth ? column(...source, c) : lastSamples(column(...source, c))));
    const table = knownAt(shown.motion, shown.shape, time);
    const parameters = table.varying ? table.rows.length / time.length : table.rows.length;
    const size = hidden.length * measured.length;
    const w = new Float64Array(time.length * size);
    const x = new Float64Array(measured.length + parameters);
    const out = new Float64Array(size);
    if (!table.varying) x.set(table.rows, measured.length);
    for (let k = 0; k < time.length; k++) {
      for (let m = 0; m < measured.length; m++) x[m] = columns[m][k];
      if (table.varying) x.set(table.rows.subarray(k * parameters, (k + 1) * parameters), measured.length);
      kernels.structure.w(x, out);
      w.set(out, k * size);
    }
    const window = Math.min(settings.window, time[time.length - 1] - time[0]);
    return { window, ...windowed(time, w, hidden.length, measured.length, window) };
  }

  /** Where the translation points in the image, and where an instant tells too little. */
  geometry(settings, kernels, structure) {
    if (track(settings, this.model)) return { foe: null, circle: null };
    const parameters = [...settings.A.flat(), ...settings.b, ...shapeOf(settings)];
    const foe = Array.from(kernels.surface.foe(parameters, [0, 0]));
    if (!foe.every((v) => Math.abs(v) < 1e6)) return { foe: null, circle: null };
    const circle = structure.circle
      ? Array.from(kernels.structure.circle([...parameters, settings.threshold], [0, 0, 0]))
      : null;
    return { foe, circle };
  }

  /** Sample times, the point's true coordinates there, and the signal at any time. */
  see(settings, kernels, chart) {
    const { period, duration } = settings;
    const count = Math.floor(duration / period + 1e-9) + 1;
    const motion = constantMotion(settings.A, settings.b);
    const shape = shapeOf(settings);
    const width = chart.coordinates.length;
    const clock = this.once("clock", [period, duration], () => {
      const time = new Float64Array(count);
      for (let k = 0; k < count; k++) time[k] = period * k;
      return { time, ...plantGrid(time) };
    });
    const room = (part, length) => this.room(part, length);
    const seen = project(move(settings, kernels, motion, clock, room), kernels, shape, width);
    if (seen.count === 0) return { problem: "the point starts behind the camera; move X0 in front of it", ...EMPTY };
    if (seen.count < 2) return { problem: "the point leaves the half-space in front of the camera at once", ...EMPTY };
    const signal = (times) => {
      const { truth } = project(move(settings, kernels, motion, plantGrid(times), room), kernels, shape, width);
      return [0, 1].map((c) => column(truth, width, c));
    };
    return {
      time: clock.time.subarray(0, seen.count),
      truth: seen.truth.subarray(0, seen.count * width),
      leavesAt: seen.count < count ? clock.time[seen.count] : null,
      motion,
      shape,
      signal,
    };
  }

  /** Room for numbers that only one run needs: taken again by the next, so that a drag leaves no litter. */
  room(part, length) {
    if (this.rooms.get(part)?.length !== length) this.rooms.set(part, new Float64Array(length));
    return this.rooms.get(part);
  }

  once(part, inputs, make) {
    const key = JSON.stringify(inputs);
    const kept = this.kept.get(part);
    if (kept && kept.key === key) return kept.value;
    const value = make();
    if (value && typeof value === "object" && !ArrayBuffer.isView(value)) value.key ??= `${part} ${key}`;
    this.kept.set(part, { key, value });
    return value;
  }
}

/** The b that puts the focus of expansion at an image point, with its distance from the camera kept. */
export function translationTowards(place, settings, kernels) {
  const shape = shapeOf(settings);
  const ray = kernels.surface.ray([...place, ...shape], [0, 0, 0]);
  const [, , distance] = kernels.surface.project([...settings.b, ...shape], [0, 0, 0]);
  return Array.from(ray, (entry) => entry * distance);
}

export function shapeOf(settings) {
  return settings.surface === "plane" ? settings.normal : [];
}

function constantMotion(A, b) {
  return { times: [0], rows: [[...A.flat(), ...b]] };
}

function believedMotion(settings, motion) {
  return settings.believed ? constantMotion(settings.believed.A, settings.believed.b) : motion;
}

const EMPTY = { time: NOTHING, truth: NOTHING, outputs: NOTHING };

function move(settings, kernels, motion, { index, steps }, room) {
  const states = room("plant states", 3 * steps.length + 3).fill(NaN);
  const resets = room("plant resets", steps.length + 1);
  kernels.plant.run(settings.X0, steps, NOTHING, motion.rows[0], NOTHING, NOTHING, false, states, resets);
  const points = room("points", 3 * index.length - 3);
  for (let k = 1; k < index.length; k++) {
    for (let c = 0; c < 3; c++) points[3 * k - 3 + c] = states[3 * index[k] + c];
  }
  return points;
}

/** The steps in which the point moves: from time 0 on, with an end at each of the times. */
function plantGrid(times) {
  const from = new Float64Array(times.length + 1);
  from.set(times, 1);
  return withSteps(stepGrid(from, PLANT_STEP));
}

/** A property that is computed when it is first asked for. */
function lazily(owner, name, make) {
  let value;
  Object.defineProperty(owner, name, { get: () => (value ??= make()), enumerable: true });
}

function withSteps({ grid, index }) {
  return { grid, index, steps: differences(grid) };
}

function timesOf(resets, grid) {
  const found = [];
  for (let k = 0; k < resets.length; k++) if (resets[k]) found.push(grid[k]);
  return found;
}

function track(settings, model) {
  return model.recordings[settings.scenario];
}

/** Coordinates of points, and how many of them are in front of the camera from the first on. */
function project(points, kernels, shape, width) {
  const samples = points.length / 3;
  const truth = new Float64Array(samples * width);
  const x = new Float64Array(3 + shape.length);
  const out = new Float64Array(width);
  x.set(shape, 3);
  let count = samples;
  for (let k = 0; k < samples; k++) {
    for (let c = 0; c < 3; c++) x[c] = points[3 * k + c];
    kernels.surface.project(x, out);
    if (!(out[width - 1] > 0 && out[width - 1] < Infinity)) count = Math.min(count, k);
    out[width - 1] = 1 / out[width - 1];
    truth.set(out, k * width);
  }
  return { truth, count };
}

function sampled(truth, shape, loss, noise, dropout) {
  const outputs = new Float64Array(shape.length);
  for (let k = 0; k < loss.length; k++) {
    for (let c = 0; c < 2; c++) {
      const draw = shape[2 * k + c];
      const error = noise.kind === "uniform" ? -noise.size + 2 * noise.size * draw : noise.size * draw;
      outputs[2 * k + c] = k > 0 && loss[k] < dropout ? NaN : truth[3 * k + c] + error;
    }
  }
  return outputs;
}

function readTrack(track) {
  const number = (value) => (value === null ? NaN : value);
  const width = track.samples[0].length;
  // A track may have y1 or y2 alone: what is missing stays a column of NaN that nothing measures.
  const both = track.samples.map((row) => ["y1", "y2"].map((name) => number(row[track.names.indexOf(name)] ?? null)));
  const { times, rows } = track.motion;
  const columns = rows[0].map((_, p) => Float64Array.from(rows, (row) => row[p]));
  return {
    time: Float64Array.from(track.time),
    truth: track.truth && Float64Array.from(track.truth.flat()),
    outputs: Float64Array.from((width === 2 ? track.samples.map((row) => row.map(number)) : both).flat()),
    leavesAt: null,
    motion: { times, rows, columns },
    shape: [],
  };
}

function startState(settings, kernel, functions, columns, gains) {
  const state = functions.start([...columns.map((values) => values[0]), ...gains], new Float64Array(kernel.states));
  const { mode, values } = settings.start;
  if (mode !== "own") kernel.stateOf.forEach((s, c) => (state[s] = mode === "zero" ? 0 : values[c]));
  return state;
}

/** Estimates, and their claimed standard deviations if there are any, at the samples. */
function read(functions, kernel, states, index, columns, width) {
  const last = columns.map(lastSamples);
  const estimate = new Float64Array(index.length * width);
  const deviation = functions.variances ? new Float64Array(index.length * width) : null;
  const x = new Float64Array(kernel.states + columns.length);
  const out = new Float64Array(width);
  for (let k = 0; k < index.length; k++) {
    for (let s = 0; s < kernel.states; s++) x[s] = states[index[k] * kernel.states + s];
    for (let m = 0; m < columns.length; m++) x[kernel.states + m] = last[m][k];
    estimate.set(functions.estimate(x, out), k * width);
    if (!deviation) continue;
    functions.variances(x, out);
    for (let c = 0; c < width; c++) deviation[k * width + c] = Math.sqrt(Math.max(0, out[c]));
  }
  return { estimate, deviation };
}
