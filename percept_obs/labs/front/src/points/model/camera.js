// Points in motion and the camera that sees them: the same numbers as record() in Python.

import { clockOf, errorOf } from "../../common/model/camera.js";
import { sampledAt } from "../../common/model/derived.js";
import { draws } from "../../common/model/random.js";
import { instants } from "../../common/model/tables.js";
import { ENTRIES, flowOf, kindsOf } from "./flow.js";
import { product, pseudoInverse } from "./symmetric.js";

/** Records scenes; keeps in `memory` the parts that the next settings do not change. */
export class Camera {
  constructor(model, memory) {
    this.model = model;
    this.memory = memory;
  }

  /** What the camera records. */
  record(scene) {
    const { memory } = this;
    const { settings, points } = scene;
    const { period, duration, noise, seed, dropout, view, hidden } = settings;
    const { state, breaks } = this.kinks(settings);
    const { time, plant } = clockOf(memory, period, duration, state, breaks);
    const truth = this.move(scene, "samples", [], plant);
    const { images, depths } = this.project(scene, truth);
    const drawn = memory.once("draws", [noise.kind, seed, time.length, points], () =>
      draws(noise.kind, seed, time.length * points, 2),
    );
    const outputs = new Float64Array(images.length);
    const seenImages = new Float64Array(images.length);
    for (let k = 0; k < time.length; k++) {
      for (let p = 0; p < points; p++) {
        const at = k * points + p;
        const away = hidden[p] && time[k] >= hidden[p][0] && time[k] < hidden[p][1];
        const chance = k > 0 && drawn.loss[at] < dropout; // the first sample is never lost
        const lost = away || chance || !(Math.abs(images[2 * at]) <= view && Math.abs(images[2 * at + 1]) <= view);
        for (let m = 0; m < 2; m++) {
          const error = errorOf(noise.kind, noise.size, drawn.shape[2 * at + m]);
          outputs[2 * at + m] = lost ? NaN : images[2 * at + m] + error;
          seenImages[2 * at + m] = lost ? NaN : images[2 * at + m];
        }
      }
    }
    return { time, truth, images, depths, outputs, seenImages };
  }

  /** Images and depths of the points of states; no image behind the camera. */
  project({ layout, points, n }, states) {
    const { N, l } = this.model.block;
    const { begins, axes, states: which, entries } = layout;
    const count = states.length / n;
    const images = new Float64Array(2 * points * count);
    const depths = new Float64Array(points * count);
    const xi = new Float64Array(3);
    for (let k = 0; k < count; k++) {
      for (let p = 0; p < points; p++) {
        xi.fill(0);
        for (let e = begins[p]; e < begins[p + 1]; e++) xi[axes[e]] += entries[e] * states[k * n + which[e]];
        const depth = l[0] * xi[0] + l[1] * xi[1] + l[2] * xi[2];
        const at = k * points + p;
        depths[at] = depth;
        for (let m = 0; m < 2; m++) {
          const image = (N[m][0] * xi[0] + N[m][1] * xi[1] + N[m][2] * xi[2]) / depth;
          images[2 * at + m] = depth > 0 ? image : NaN;
        }
      }
    }
    return { images, depths };
  }

  /** True states at the times of a grid that begins at time 0. */
  move(scene, part, clock, plant) {
    const { n } = scene;
    const wanted = plant.index.subarray(1);
    const { kindOf, flows } = this.flows(scene, part, clock, plant, wanted);
    const states = new Float64Array(wanted.length * n);
    const x = this.begin(scene);
    for (let v = 0; v < n; v += 3) {
      const flow = flows[kindOf[v / 3]];
      for (let k = 0; k < wanted.length; k++) {
        for (let i = 0; i < 3; i++) {
          const at = ENTRIES * k + 4 * i;
          states[k * n + v + i] = flow[at] * x[v] + flow[at + 1] * x[v + 1] + flow[at + 2] * x[v + 2] + flow[at + 3];
        }
      }
    }
    return states;
  }

  /** How each kind of vector moves, at some of the ends of steps; made anew only when motion or clock changes. */
  flows(scene, part, clock, { grid, steps }, wanted) {
    const { settings, layout, n, width } = scene;
    const kinds = kindsOf(layout, n);
    const motion = [kinds.kinds.length, ...placeOf(settings), clock];
    const flows = this.memory.once(`flows ${part}`, motion, () => {
      const known = this.known(scene, part, clock, instants(grid));
      return { of: kinds.kinds.map((kind) => flowOf(kind, steps, known, width, wanted)) };
    });
    return { ...kinds, flows: flows.of, made: flows };
  }

  /** Numbers of the coefficients at some times, a row each. */
  known({ settings, functions }, part, clock, places) {
    return this.memory.once(`known ${part}`, [...placeOf(settings), clock], () =>
      coefficientsAt(this.model, settings, functions, places),
    );
  }

  /** When the motion of a state has kinks: at the samples that somebody brought. */
  kinks({ state }) {
    return { state, breaks: this.model.states[state].samples?.times ?? [] };
  }

  /** The state whose points are at the given places; of several the smallest. */
  begin({ settings, layout, points, n }) {
    const inverse = this.memory.once("begin", [settings.state, points], () => pseudoInverse(rowsOf(layout, n), 3 * points, n));
    return product(inverse, settings.points.flat(), n);
  }
}

/** Numbers of a state's coefficients at some times, a row each. */
export function coefficientsAt({ states }, { state, turning, spin, input, velocity }, { coefficients }, places) {
  const { width, samples } = states[state];
  const rows = new Float64Array(places.length * width);
  const out = new Float64Array(width);
  const x = Float64Array.of(0, turning, spin, input, ...velocity);
  const given = samples && sampledAt(samples, places);
  for (let k = 0; k < places.length; k++) {
    x[0] = places[k];
    rows.set(coefficients(given ? given.rows.subarray(k * given.width, (k + 1) * given.width) : x, out), k * width);
  }
  return rows;
}

/** The settings that motion and samples' times depend on; what else a clock depends on is added where it is made. */
function placeOf({ state, turning, spin, input, velocity, motion, period, duration }) {
  return [state, turning, spin, input, velocity, motion, period, duration];
}

/** C of all points, three rows each. */
export function rowsOf({ begins, axes, states, entries }, n) {
  const rows = new Float64Array(3 * (begins.length - 1) * n);
  for (let p = 0; p + 1 < begins.length; p++) {
    for (let e = begins[p]; e < begins[p + 1]; e++) rows[(3 * p + axes[e]) * n + states[e]] = entries[e];
  }
  return rows;
}
