// Points in motion and the camera that sees them: the same numbers as record() in Python.

import { clockOf, errorOf } from "../../engine/camera.js";
import { sampledAt } from "../../engine/derived.js";
import { draws } from "../../engine/random.js";
import { instants } from "../../engine/tables.js";
import { breaksOf } from "../../engine/typed.js";
import { ENTRIES, flowOf, kindsOf, placed } from "./flow.js";
import { product, pseudoInverse } from "./symmetric.js";

/** Records scenes; keeps in `memory` the parts that the next settings do not change. */
export class Camera {
  constructor(model, memory) {
    this.model = model;
    this.memory = memory;
  }

  /** Recording of the camera. */
  record(scene) {
    const { memory } = this;
    const { settings, points } = scene;
    const { noise, dropout, view, hidden } = settings;
    const { time, plant } = clockOf(memory, settings, this.kinks(settings));
    const truth = this.move(scene, "samples", plant);
    const { images, depths } = this.project(scene, truth);
    const drawing = (read) => draws(read.noise.kind, read.seed, time.length * points, 2);
    const drawn = memory.once("draws", settings, drawing, time.length, points);
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
    const count = states.length / n;
    const images = new Float64Array(2 * points * count);
    const depths = new Float64Array(points * count);
    const xi = new Float64Array(3);
    for (let k = 0; k < count; k++) {
      for (let p = 0; p < points; p++) {
        placed(layout, states, k * n, p, xi);
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
  move(scene, purpose, plant) {
    const { n } = scene;
    const wanted = plant.index.subarray(1);
    const { kindOf, flows } = this.flows(scene, purpose, plant, wanted);
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

  /** Flow of each kind of vector at some of the ends of steps; made anew only when motion or clock changes. */
  flows(scene, purpose, { grid, steps }, wanted) {
    const { settings, layout, n, width } = scene;
    const kinds = kindsOf(layout, n);
    const make = (read) => {
      const known = this.known({ ...scene, settings: read }, purpose, grid);
      return { of: kinds.kinds.map((kind) => flowOf(kind, steps, known, width, wanted)) };
    };
    // A typed motion is in the coefficients themselves.
    const inputs = [kinds.kinds.length, grid, scene.functions.coefficients];
    const flows = this.memory.once(`flows ${purpose}`, settings, make, ...inputs);
    return { ...kinds, flows: flows.of, made: flows };
  }

  /** Numbers of the coefficients at the instants of a grid's steps, a row each. */
  known({ settings, functions }, purpose, grid) {
    const make = (read) => coefficientsAt(this.model, read, functions, instants(grid));
    return this.memory.once(`known ${purpose}`, settings, make, grid, functions.coefficients);
  }

  /** Times at which the motion of a state has kinks: those of a user's samples, or of what is typed. */
  kinks({ state, motion }) {
    return this.model.states[state].samples?.times ?? breaksOf(this.model, motion);
  }

  /** The state whose points are at the given places; of several the smallest. */
  begin({ settings, layout, points, n }) {
    const make = () => pseudoInverse(rowsOf(layout, n), 3 * points, n);
    const inverse = this.memory.once("begin", settings, make, layout);
    return product(inverse, settings.points.flat(), n);
  }
}

/** Numbers of a state's coefficients at some times, a row each. */
export function coefficientsAt({ states }, { state, turning, spin, input, camera_velocity }, { coefficients }, places) {
  const { width, samples } = states[state];
  const rows = new Float64Array(places.length * width);
  const out = new Float64Array(width);
  const x = Float64Array.of(0, turning, spin, input, ...camera_velocity);
  const given = samples && sampledAt(samples, places);
  for (let k = 0; k < places.length; k++) {
    x[0] = places[k];
    rows.set(coefficients(given ? given.rows.subarray(k * given.width, (k + 1) * given.width) : x, out), k * width);
  }
  return rows;
}

/** C of all points, three rows each. */
export function rowsOf({ begins, axes, states, entries }, n) {
  const rows = new Float64Array(3 * (begins.length - 1) * n);
  for (let p = 0; p + 1 < begins.length; p++) {
    for (let e = begins[p]; e < begins[p + 1]; e++) rows[(3 * p + axes[e]) * n + states[e]] = entries[e];
  }
  return rows;
}
