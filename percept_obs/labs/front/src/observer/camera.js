// What a camera records: a point moves, is projected and sampled; or a real track. As record() does in Python.

import { draws } from "../common/random.js";
import { column, plantGrid, sampleTimes } from "../common/tables.js";

const NOTHING = new Float64Array(0);

/** Records settings; keeps in `memory` the parts that the next settings do not change. */
export class Camera {
  constructor(model, memory) {
    this.model = model;
    this.memory = memory;
  }

  /** Sample times, samples, truth, motion, and the exact signal at any time; or the problem that there is. */
  record(settings, kernels, chart) {
    const { memory } = this;
    const recorded = this.model.recordings[settings.scenario];
    if (recorded) return memory.once("track", [settings.scenario], () => readTrack(recorded));
    const { surface, normal, A, b, X0, period, duration, noise, dropout, seed } = settings;
    const place = [surface, normal, A, b, X0, period, duration];
    const seen = memory.once("seen", place, () => this.see(settings, kernels, chart));
    if (seen.problem) return seen;
    return memory.once("samples", [...place, noise, dropout, seed], () => {
      const { shape, loss } = memory.once("draws", [noise.kind, seed, seen.time.length], () =>
        draws(noise.kind, seed, seen.time.length, 2),
      );
      const outputs = sampled(seen.truth, shape, loss, noise, dropout, memory.room("outputs", shape.length));
      return { ...seen, outputs };
    });
  }

  see(settings, kernels, chart) {
    const { memory } = this;
    const { period, duration } = settings;
    const motion = constantMotion(settings.A, settings.b);
    const shape = shapeOf(settings);
    const width = chart.coordinates.length;
    const clock = memory.once("clock", [period, duration], () => {
      const time = sampleTimes(period, duration);
      return { time, ...plantGrid(time) };
    });
    const count = clock.time.length;
    const truth = memory.room("truth", count * width);
    const room = (part, length) => memory.room(part, length);
    const inFront = project(move(settings, kernels, motion, clock, room), kernels, shape, width, truth);
    if (inFront === 0) return { problem: "the point starts behind the camera; move X0 in front of it", ...EMPTY };
    if (inFront < 2) return { problem: "the point leaves the half-space in front of the camera at once", ...EMPTY };
    const signal = (times) => {
      const exact = new Float64Array(times.length * width);
      project(move(settings, kernels, motion, plantGrid(times), room), kernels, shape, width, exact);
      return [0, 1].map((c) => column(exact, width, c));
    };
    return {
      time: clock.time.subarray(0, inFront),
      truth: truth.subarray(0, inFront * width),
      leavesAt: inFront < count ? clock.time[inFront] : null,
      motion,
      shape,
      signal,
    };
  }
}

const EMPTY = { time: NOTHING, truth: NOTHING, outputs: NOTHING };

/** The surface's own numbers. */
export function shapeOf(settings) {
  return settings.surface === "plane" ? settings.normal : [];
}

/** A motion that stays as it is, as a table of one row. */
export function constantMotion(A, b) {
  return { times: [0], rows: [[...A.flat(), ...b]] };
}

function move(settings, kernels, motion, { index, steps }, room) {
  const states = room("plant states", 3 * steps.length + 3);
  const resets = room("plant resets", steps.length + 1);
  const { rows } = motion;
  const diverged = kernels.plant.run(settings.X0, steps, NOTHING, rows[0], NOTHING, NOTHING, false, states, resets);
  if (diverged >= 0) states.fill(NaN, 3 * diverged);
  const points = room("points", 3 * index.length - 3);
  for (let k = 1; k < index.length; k++) {
    for (let c = 0; c < 3; c++) points[3 * k - 3 + c] = states[3 * index[k] + c];
  }
  return points;
}

/** Fill in coordinates of points; returns how many of them are in front of the camera from the first on. */
function project(points, kernels, shape, width, truth) {
  const samples = points.length / 3;
  const x = new Float64Array(3 + shape.length);
  const out = new Float64Array(width);
  x.set(shape, 3);
  let count = samples;
  for (let k = 0; k < samples; k++) {
    x[0] = points[3 * k];
    x[1] = points[3 * k + 1];
    x[2] = points[3 * k + 2];
    kernels.surface.project(x, out);
    const distance = out[width - 1];
    if (k < count && !(distance > 0 && distance < Infinity)) count = k;
    for (let c = 0; c < width - 1; c++) truth[k * width + c] = out[c];
    truth[(k + 1) * width - 1] = 1 / distance;
  }
  return count;
}

function sampled(truth, shape, loss, noise, dropout, outputs) {
  const uniform = noise.kind === "uniform";
  for (let k = 0; k < loss.length; k++) {
    const lost = k > 0 && loss[k] < dropout;
    for (let c = 0; c < 2; c++) {
      const draw = shape[2 * k + c];
      const error = uniform ? -noise.size + 2 * noise.size * draw : noise.size * draw;
      outputs[2 * k + c] = lost ? NaN : truth[3 * k + c] + error;
    }
  }
  return outputs;
}

function readTrack(track) {
  const number = (value) => (value === null ? NaN : value);
  // A track may have y1 or y2 alone: what is missing stays a column of NaN that nothing measures.
  const both = track.samples.map((row) => ["y1", "y2"].map((name) => number(row[track.names.indexOf(name)] ?? null)));
  const { times, rows } = track.motion;
  return {
    time: Float64Array.from(track.time),
    truth: track.truth && Float64Array.from(track.truth.flat()),
    outputs: Float64Array.from(both.flat()),
    leavesAt: null,
    motion: { times, rows, columns: rows[0].map((_, p) => Float64Array.from(rows, (row) => row[p])) },
    shape: [],
  };
}
