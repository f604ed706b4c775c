// @ts-check
// Cameras of single points: sample times, noise, the time until the point leaves the front.

import { constantPath } from "./path.js";
import { draws } from "./random.js";
import { filled } from "../state/texts.js";
import { column, plantGrid, sampleTimes } from "./tables.js";

const NOTHING = new Float64Array(0);

/** The kinks of a motion that has none. */
export const NO_BREAKS = /** @type {number[]} */ ([]);

/** An empty recording with the problem that there is. */
function nothing(problem) {
  return { problem, time: NOTHING, truth: NOTHING, outputs: NOTHING, leavesAt: null };
}

/** The times of samples, and the steps of what moves before them, which end at the breaks as well. */
export function clockOf(memory, settings, breaks) {
  const make = ({ period, duration }) => {
    const time = sampleTimes(period, duration);
    return { time, plant: plantGrid(time, breaks) };
  };
  return memory.once("clock", settings, make, breaks);
}

/** The error that a draw stands for, in noise of a kind and a size. */
export function errorOf(kind, size, draw) {
  return kind === "uniform" ? -size + 2 * size * draw : size * draw;
}

/**
 * Records settings; keeps in `memory` the parts that the next settings do not change.  A camera of its own says in
 * methods of its own:
 *   path(settings, functions, lines) positions at the ends of steps, with the shape of the surface
 *   sampled(seen, settings, drawn)   the samples, with noise
 */
export class PointCamera {
  constructor(model, memory, drawsOf, remedy) {
    this.model = model;
    /** Remedy in the panel's words when the point starts behind the camera. */
    this.remedy = remedy;
    this.memory = memory;
    this.drawsOf = drawsOf;
  }

  /** Times, samples and true coordinates; or the problem that there is. */
  record(settings, functions) {
    const { memory } = this;
    const seen = memory.once("seen", settings, (read) => this.see(read, functions), functions.project);
    if (seen.problem) return seen;
    const count = seen.time.length;
    const each = this.drawsFor(settings);
    const make = (read) => {
      const drawing = ({ noise, seed }) => draws(noise.kind, seed, count, each);
      const drawn = memory.once("draws", read, drawing, count, each);
      return { ...seen, outputs: /** @type {any} */ (this).sampled(seen, read, drawn) };
    };
    return memory.once("samples", settings, make, seen, each);
  }

  /** How many outputs a sample of settings has. */
  drawsFor(_settings) {
    return this.drawsOf;
  }

  /** Times at which the motion has kinks. */
  kinks(_settings) {
    return NO_BREAKS;
  }

  see(settings, functions) {
    const { time, plant } = clockOf(this.memory, settings, this.kinks(settings));
    const count = time.length;
    if (count < 2) return nothing(filled(this.model.verdicts["too short"], settings));
    const truth = new Float64Array(3 * count);
    const inFront = this.look(settings, functions, plant, truth);
    if (inFront === 1) return nothing(this.model.leaves);
    if (!inFront) return nothing(`the point starts behind the camera: ${this.remedy}`);
    const leavesAt = inFront < count ? time[inFront] : null;
    return { time: time.subarray(0, inFront), truth: truth.subarray(0, 3 * inFront), leavesAt };
  }

  /** The exact coordinates at some times, a column each. */
  exact(settings, functions, times) {
    const found = new Float64Array(3 * times.length);
    this.look(settings, functions, plantGrid(times, this.kinks(settings)), found);
    return [0, 1, 2].map((c) => column(found, 3, c));
  }

  /** Fill in coordinates at the ends of steps; how many of them are in front of the camera from the first on. */
  look(settings, functions, lines, found) {
    const { start, known, shape } = /** @type {any} */ (this).path(settings, functions, lines);
    const points = move(start, functions, known, lines, (part, length) => this.memory.room(part, length));
    return project(points, functions.project, shape, found);
  }
}

/** Positions at a clock's times, from time 0 on, of a point that moves by a motion's known rows. */
function move(start, functions, { rows, varying }, { grid, index, steps }, room) {
  const points = room("points", 3 * index.length - 3);
  if (!varying) return constantPath(start, functions.rates(rows, new Float64Array(12)), grid, index, points);
  const states = room("plant states", 3 * steps.length + 3);
  const resets = room("plant resets", steps.length + 1);
  const diverged = functions.plant(start, steps, NOTHING, rows, NOTHING, NOTHING, varying, states, resets);
  if (diverged >= 0) states.fill(NaN, 3 * diverged);
  for (let k = 1; k < index.length; k++) {
    for (let c = 0; c < 3; c++) points[3 * k - 3 + c] = states[3 * index[k] + c];
  }
  return points;
}

/** Fill in coordinates of points, the last one inverse; how many are in front of the camera from the first on. */
function project(points, projection, shape, found) {
  const samples = points.length / 3;
  const x = new Float64Array(3 + shape.length);
  const out = new Float64Array(3);
  x.set(shape, 3);
  let count = samples;
  for (let k = 0; k < samples; k++) {
    for (let c = 0; c < 3; c++) x[c] = points[3 * k + c];
    projection(x, out);
    const distance = out[2];
    if (k < count && !(distance > 0 && distance < Infinity)) count = k;
    found[3 * k] = out[0];
    found[3 * k + 1] = out[1];
    found[3 * k + 2] = 1 / distance;
  }
  return count;
}
