// What is measured of an object: a point moves, and its image and scaled inverse depth are sampled. As record_structure().

import { move, project } from "../common/plant.js";
import { draws } from "../common/random.js";
import { column, halves, plantGrid, sampleTimes } from "../common/tables.js";

const NOTHING = new Float64Array(0);
const NAMES = ["v_c", "v_p"];

/** The parts of settings that the true path depends on. */
export function motionOf({ v_c, v_p, v_c_swing, v_p_swing, rate, w }) {
  return { v_c, v_p, v_c_swing, v_p_swing, rate, w };
}

/** Records settings; keeps in `memory` the parts that the next settings do not change. */
export class StructureCamera {
  constructor(model, memory) {
    this.model = model;
    this.memory = memory;
  }

  /** Whether a velocity swings, so that it is not the same at all times. */
  varies({ rate, v_c_swing, v_p_swing }) {
    return rate !== 0 && [...v_c_swing, ...v_p_swing].some((value) => value !== 0);
  }

  /** Known and unknown velocities at some times, in rows of w, v_c, v_p; one row if they do not change. */
  velocities(settings, swinging, times) {
    const varying = this.varies(settings);
    const count = varying ? times.length : 1;
    const rows = new Float64Array(9 * count);
    const x = new Float64Array(5);
    const out = new Float64Array(1);
    for (let k = 0; k < count; k++) {
      rows.set(settings.w, 9 * k);
      for (let i = 0; i < 6; i++) {
        const name = NAMES[Math.floor(i / 3)];
        x[0] = settings[name][i % 3];
        x[1] = settings[`${name}_swing`][i % 3];
        x[2] = settings.rate;
        x[3] = this.model.phases[name][i % 3];
        x[4] = varying ? times[k] : 0;
        rows[9 * k + 3 + i] = swinging(x, out)[0];
      }
    }
    return { rows, varying };
  }

  /** Sample times, samples, true ybar, and the exact signal at any time; or the problem that there is. */
  record(settings, kernels) {
    const { memory } = this;
    const { ybar, scale, period, duration, noise, bias, drift, seed } = settings;
    const place = [motionOf(settings), ybar, scale, period, duration];
    const seen = memory.once("seen", place, () => this.see(settings, kernels));
    if (seen.problem) return seen;
    return memory.once("samples", [place, noise, bias, drift, seed], () => {
      const { shape } = memory.once("draws", [noise.kind, seed, seen.time.length], () =>
        draws(noise.kind, seed, seen.time.length, 3),
      );
      return { ...seen, outputs: sampled(seen, shape, settings, memory.room("outputs", shape.length)) };
    });
  }

  see(settings, { plant, project: projection, swinging }) {
    const { memory } = this;
    const { ybar, scale, period, duration } = settings;
    const clock = memory.once("clock", [period, duration], () => {
      const time = sampleTimes(period, duration);
      return { time, ...plantGrid(time) };
    });
    const count = clock.time.length;
    const depth = 1 / (scale * ybar[2]);
    const start = [ybar[0] * depth, ybar[1] * depth, depth];
    const room = (part, length) => memory.room(part, length);
    const path = (lines) => {
      const place = [motionOf(settings), lines.grid.length, lines.grid.at(-1)];
      const known = memory.once("velocities", place, () => this.velocities(settings, swinging, halves(lines.grid)));
      return move(start, plant, known, lines, room);
    };
    const image = memory.room("image", 3 * count);
    const inFront = project(path(clock), projection, NOTHING, 3, image);
    if (inFront < 2) return { problem: "the point leaves the half-space in front of the camera at once", ...EMPTY };
    const scaled = (rows) => {
      for (let k = 2; k < rows.length; k += 3) rows[k] /= scale;
      return rows;
    };
    return {
      time: clock.time.subarray(0, inFront),
      image: scaled(image).subarray(0, 3 * inFront),
      leavesAt: inFront < count ? clock.time[inFront] : null,
      signal: (times) => {
        const exact = new Float64Array(3 * times.length);
        project(path(plantGrid(times)), projection, NOTHING, 3, exact);
        scaled(exact);
        return [0, 1, 2].map((c) => column(exact, 3, c));
      },
    };
  }
}

const EMPTY = { time: NOTHING, image: NOTHING, outputs: NOTHING };

function sampled({ time, image }, shape, { noise, bias, drift }, outputs) {
  const uniform = noise.kind === "uniform";
  const error = (size, draw) => (uniform ? -size + 2 * size * draw : size * draw);
  const count = time.length;
  for (let k = 0; k < count; k++) {
    outputs[3 * k] = image[3 * k] + error(noise.size, shape[2 * k]);
    outputs[3 * k + 1] = image[3 * k + 1] + error(noise.size, shape[2 * k + 1]);
    outputs[3 * k + 2] = image[3 * k + 2] + bias + drift * time[k] + error(noise.depth, shape[2 * count + k]);
  }
  return outputs;
}
