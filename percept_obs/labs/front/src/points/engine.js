// The whole of a run: points in motion, camera, observer. The same numbers as record_points() and track_points().

import { lazily, Memory } from "../common/memory.js";
import { draws } from "../common/random.js";
import { column, differences, halves, plantGrid, sampleTimes, stepGrid, withSteps } from "../common/tables.js";
import { ENTRIES, flowOf, inversesOf, kindsOf } from "./flow.js";
import { windowsOf } from "./gramian.js";
import { advance } from "./kernel.js";
import { decayRate, norms, spansOf } from "./measures.js";
import { pseudoInverse } from "./symmetric.js";

/** Runs settings. */
export class Engine {
  constructor(model) {
    this.model = model;
    this.memory = new Memory();
  }

  /** Everything that is shown for these settings; functions are the state's coefficients and a point's place. */
  run(settings, functions) {
    const points = settings.points.length;
    const layout = this.model.states[settings.state].layouts[points - 1];
    const n = layout.names.length;
    const scene = { settings, functions, layout, points, n, width: this.model.states[settings.state].width };
    const recording = this.record(scene);
    const run = this.track(scene, recording);
    const shown = { settings, points, n, names: layout.names, ...recording, ...run };
    const { time, truth, depths } = recording;
    const room = (part, length) => this.memory.room(part, length);
    shown.size = norms(truth, run.estimate, n, room("size", time.length));
    shown.seenAs = this.project(scene, run.estimate, "estimated", true);
    shown.offs = this.distances(scene, truth, run.estimate);
    const depthOf = (rows, part) => (k) => column(rows, points, k, (length) => room(`${part} ${k}`, length));
    shown.trueDepth = depthOf(depths, "true depth");
    shown.depth = depthOf(shown.seenAs.depths, "depth");
    shown.fit = decayRate(time, shown.size);
    shown.hiddenSpans = Array.from({ length: points }, (_, k) => spansOf(time, recording.outputs, points, k));
    lazily(shown, "gramian", () => this.gramian(scene, recording));
    return shown;
  }

  /** The state whose points are at the given places; of several the smallest. */
  begin({ settings, layout, points, n }) {
    const inverse = this.memory.once("begin", [settings.state, points], () => pseudoInverse(rowsOf(layout, n), 3 * points, n));
    return product(inverse, settings.points.flat(), n);
  }

  /** Numbers of the coefficients at some times, a row each. */
  known({ settings, functions, width }, part, clock, places) {
    const { state, turning, spin, input, velocity } = settings;
    return this.memory.once(`known ${part}`, [state, turning, spin, input, velocity, clock], () => {
      const rows = new Float64Array(places.length * width);
      const out = new Float64Array(width);
      const x = Float64Array.of(0, turning, spin, input, ...velocity);
      for (let k = 0; k < places.length; k++) {
        x[0] = places[k];
        functions.coefficients(x, out);
        rows.set(out, k * width);
      }
      return rows;
    });
  }

  /** How each kind of vector moves, at some of the ends of steps; made anew only when the motion changes. */
  flows(scene, part, clock, { grid, steps }, wanted) {
    const { settings, layout, n, width } = scene;
    const { state, turning, spin, input, velocity } = settings;
    const kinds = kindsOf(layout, n);
    const motion = [state, kinds.kinds.length, turning, spin, input, velocity, clock];
    const flows = this.memory.once(`flows ${part}`, motion, () => {
      const known = this.known(scene, part, clock, halves(grid));
      return { of: kinds.kinds.map((kind) => flowOf(kind, steps, known, width, wanted)) };
    });
    return { ...kinds, flows: flows.of, made: flows };
  }

  /** True states at the times of a grid that begins at time 0. */
  move(scene, part, clock, plant) {
    const { n } = scene;
    const wanted = plant.index.subarray(1);
    const { kindOf, flows } = this.flows(scene, part, clock, plant, wanted);
    const states = this.memory.room(`states ${part}`, wanted.length * n);
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

  /** What the camera records. */
  record(scene) {
    const { memory } = this;
    const { settings, points } = scene;
    const { period, duration, noise, seed, dropout, view, hidden } = settings;
    const clock = memory.once("clock", [period, duration], () => {
      const time = sampleTimes(period, duration);
      return { time, plant: plantGrid(time) };
    });
    const { time } = clock;
    const truth = this.move(scene, "samples", clock.key, clock.plant);
    const { images, depths } = this.project(scene, truth, "true");
    const drawn = memory.once("draws", [noise.kind, seed, time.length, points], () =>
      draws(noise.kind, seed, time.length * points, 2),
    );
    const outputs = memory.room("outputs", images.length);
    const seenImages = memory.room("seen", images.length);
    for (let k = 0; k < time.length; k++) {
      for (let p = 0; p < points; p++) {
        const at = k * points + p;
        const [y1, y2] = [images[2 * at], images[2 * at + 1]];
        const away = hidden[p] && time[k] >= hidden[p][0] && time[k] < hidden[p][1];
        const lost = away || drawn.loss[at] < dropout || !(Math.max(Math.abs(y1), Math.abs(y2)) <= view);
        for (let m = 0; m < 2; m++) {
          const draw = drawn.shape[2 * at + m];
          const error = noise.kind === "uniform" ? -noise.size + 2 * noise.size * draw : noise.size * draw;
          outputs[2 * at + m] = lost ? NaN : images[2 * at + m] + error;
          seenImages[2 * at + m] = lost ? NaN : images[2 * at + m];
        }
      }
    }
    return { time, clockKey: clock.key, truth, images, depths, outputs, seenImages };
  }

  /** Images and depths of the points of states: no image behind the camera, unless asked for everywhere. */
  project({ layout, points, n }, states, part, everywhere = false) {
    const { N, l } = this.model.block;
    const { begins, axes, states: which, entries } = layout;
    const count = states.length / n;
    const images = this.memory.room(`${part} images`, 2 * points * count);
    const depths = this.memory.room(`${part} depths`, points * count);
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
          images[2 * at + m] = depth > 0 || (everywhere && depth > 1e-3) ? image : NaN;
        }
      }
    }
    return { images, depths };
  }

  /** How far each point's estimate is from it, a column each. */
  distances({ layout, points, n }, truth, estimate) {
    const { begins, axes, states, entries } = layout;
    const count = truth.length / n;
    const off = new Float64Array(3);
    return Array.from({ length: points }, (_, p) => {
      const found = this.memory.room(`off ${p}`, count);
      for (let k = 0; k < count; k++) {
        off.fill(0);
        for (let e = begins[p]; e < begins[p + 1]; e++) {
          off[axes[e]] += entries[e] * (truth[k * n + states[e]] - estimate[k * n + states[e]]);
        }
        found[k] = Math.hypot(off[0], off[1], off[2]);
      }
      return found;
    });
  }

  /** What the observer takes for the images between samples: three rows a step. */
  held(scene, { time, clockKey, outputs }, { grid, index, steps }) {
    const { memory } = this;
    const { settings, points } = scene;
    const { hold } = settings;
    const wide = 2 * points;
    const table = memory.room("held", 3 * wide * steps.length);
    const places = memory.once("observer's places", [clockKey, settings.step], () => halves(grid));
    let exact = null;
    if (hold === "exact") {
      const clock = `exact ${clockKey} ${settings.step}`;
      const plant = memory.once("exact plant", [clock], () => plantGrid(places));
      exact = this.project(scene, this.move(scene, "signal", clock, plant), "exact").images;
    }
    for (let k = 0; k + 1 < time.length; k++) {
      for (let j = index[k]; j < index[k + 1]; j++) {
        for (let stage = 0; stage < 3; stage++) {
          const share = (places[2 * j + stage] - time[k]) / (time[k + 1] - time[k]);
          for (let c = 0; c < wide; c++) {
            const before = outputs[k * wide + c];
            let value = before;
            if (hold === "first") value = (1 - share) * before + share * outputs[(k + 1) * wide + c];
            if (exact) value = Number.isNaN(before) ? NaN : exact[(2 * j + stage) * wide + c];
            table[(3 * j + stage) * wide + c] = value;
          }
        }
      }
    }
    return table;
  }

  /** Let the observer follow. */
  track(scene, recording) {
    const { memory, model } = this;
    const { settings, layout, points, n } = scene;
    const { time, clockKey, truth } = recording;
    const steps = memory.once("steps", [clockKey, settings.step], () => withSteps(stepGrid(time, settings.step)));
    const places = memory.once("observer's places", [clockKey, settings.step], () => halves(steps.grid));
    const inputs = {
      ...steps,
      held: this.held(scene, recording, steps),
      coefficients: this.known(scene, "observer", `${clockKey} ${settings.step}`, places),
      inverses: inversesOfP(settings, places),
    };
    const start = new Float64Array(n);
    if (settings.start === "error") {
      const { error } = model;
      for (let i = 0; i < n; i++) start[i] = truth[i] - settings.error * error[i % error.length];
    }
    const estimate = memory.room("estimate", time.length * n);
    // Points that share nothing unknown are followed one by one, which is the same and takes less.
    const alone = settings.state === "independent";
    const ends = (alone ? Array.from({ length: points }, (_, k) => k) : [-1]).map((k) => {
      const part = k < 0 ? { layout, first: 0, states: 0 } : { layout: model.states.independent.layouts[0], first: k, states: 3 * k };
      return this.follow(scene, recording, inputs, part, start, estimate);
    });
    const divergedAt = Math.min(...ends);
    for (let k = 0; k < time.length; k++) if (time[k] >= divergedAt) estimate.fill(NaN, k * n, k * n + n);
    return { estimate, divergedAt: divergedAt < Infinity ? divergedAt : null };
  }

  /** Follow a part of the points; returns when the estimate diverged, or Infinity. */
  follow(scene, { time, outputs }, inputs, { layout, first, states }, start, estimate) {
    const { settings, points, n, width } = scene;
    const { grid, index, steps, held, coefficients, inverses } = inputs;
    const own = layout.names.length;
    const count = layout.begins.length - 1;
    const law = lawOf(settings, own);
    let x = start.slice(states, states + own);
    const P = law.computed ? unit(own, settings.size) : null;
    const began = settings.start === "rays" ? firstSights(outputs, time.length, points, first, count) : new Map();
    const stops = [...new Set([0, ...began.keys(), time.length - 1])].sort((a, b) => a - b);
    const seen = new Set();
    for (let s = 0; s < stops.length; s++) {
      const sample = stops[s];
      if (began.has(sample)) {
        this.onRays(scene, { layout, own, first }, outputs.subarray(2 * sample * points), began.get(sample), seen, x, P);
        began.get(sample).forEach((k) => seen.add(k));
      }
      for (let i = 0; i < own; i++) estimate[sample * n + states + i] = x[i];
      if (s === stops.length - 1) break;
      const next = stops[s + 1];
      const [from, to] = [index[sample], index[next]];
      const path = this.memory.room("observer's path", (to - from + 1) * own);
      const tables = {
        steps: steps.subarray(from, to),
        coefficients: coefficients.subarray(2 * from * width),
        width,
        inverses: inverses.length > 1 ? inverses.subarray(2 * from) : inverses,
        images: held.subarray(6 * points * from),
        points,
        first,
      };
      const diverged = advance(layout, this.model.block, law, x, P, tables, path);
      for (let k = sample; k <= next; k++) {
        const at = (index[k] - from) * own;
        for (let i = 0; i < own; i++) estimate[k * n + states + i] = path[at + i];
      }
      if (diverged >= 0) return grid[from + diverged];
      x = path.slice((to - from) * own, (to - from + 1) * own);
    }
    return Infinity;
  }

  /** Put points on their rays by the states that no point seen before uses; P starts anew for these. */
  onRays({ settings, functions }, { layout, own, first }, images, fresh, seen, x, P) {
    const { begins, states } = layout;
    const used = (points) => new Set(points.flatMap((k) => states.slice(begins[k], begins[k + 1])));
    const taken = used([...seen].filter((k) => !fresh.includes(k)));
    const free = [...used(fresh)].filter((i) => !taken.has(i)).sort((a, b) => a - b);
    if (!free.length) return;
    const place = new Float64Array(3);
    const all = rowsOf(layout, own);
    const rows = fresh.flatMap((k) => [0, 1, 2].map((axis) => 3 * k + axis));
    const goal = fresh.flatMap((k) => {
      const at = 2 * (first + k);
      return Array.from(functions.locate([images[at], images[at + 1], settings.depth], place));
    });
    rows.forEach((row, r) => {
      for (let i = 0; i < own; i++) if (!free.includes(i)) goal[r] -= all[row * own + i] * x[i];
    });
    const part = Float64Array.from(rows.flatMap((row) => free.map((i) => all[row * own + i])));
    const key = [settings.state, own, rows, free];
    const inverse = this.memory.once(`rays ${first}`, key, () => pseudoInverse(part, rows.length, free.length));
    product(inverse, goal, free.length).forEach((value, k) => (x[free[k]] = value));
    if (!P) return;
    for (const i of free) {
      for (let j = 0; j < own; j++) P[i * own + j] = P[j * own + i] = 0;
    }
    for (const i of free) P[i * own + i] = settings.size;
  }

  gramian(scene, { time, clockKey, seenImages }) {
    const { memory, model } = this;
    const clock = memory.once("samples' steps", [clockKey], () => ({
      grid: time,
      steps: differences(time),
      wanted: Int32Array.from(time, (_, k) => k),
    }));
    const { kindOf, flows, made } = this.flows(scene, "gramian", clockKey, clock, clock.wanted);
    made.back ??= flows.map(inversesOf);
    const window = Math.min(scene.settings.window, time.at(-1));
    return windowsOf({ ...scene, model, time, images: seenImages, kindOf, flows, back: made.back, window, memory });
  }
}

/** How P moves, where it is computed. */
function lawOf({ weight, size, forgetting, decrease }, n) {
  if (weight === "riccati") return { computed: true, information: 1, forgetting, pull: unit(n, forgetting * size) };
  if (weight === "lyapunov") return { computed: true, information: 0, forgetting: 0, pull: unit(n, -decrease) };
  return { computed: false, information: 0, forgetting: 0, pull: null };
}

/** The inverse of a P that is given, as a multiple of the identity. */
function inversesOfP({ weight, size, final, duration }, places) {
  if (weight !== "scheduled") return Float64Array.of(1 / size);
  return Float64Array.from(places, (t) => 1 / (size * (final / size) ** (t / duration)));
}

/** The samples at which points are first seen, with these points. */
function firstSights(outputs, samples, points, first, count) {
  const found = new Map();
  for (let k = 0; k < count; k++) {
    for (let sample = 0; sample < samples; sample++) {
      if (Number.isNaN(outputs[2 * (sample * points + first + k)])) continue;
      found.set(sample, [...(found.get(sample) ?? []), k]);
      break;
    }
  }
  return found;
}

/** C of all points, three rows each. */
function rowsOf({ begins, axes, states, entries }, n) {
  const rows = new Float64Array(3 * (begins.length - 1) * n);
  for (let p = 0; p + 1 < begins.length; p++) {
    for (let e = begins[p]; e < begins[p + 1]; e++) rows[(3 * p + axes[e]) * n + states[e]] = entries[e];
  }
  return rows;
}

function product(matrix, x, rows) {
  const width = x.length;
  return Float64Array.from({ length: rows }, (_, i) => {
    let sum = 0;
    for (let j = 0; j < width; j++) sum += matrix[i * width + j] * x[j];
    return sum;
  });
}

function unit(n, size) {
  const matrix = new Float64Array(n * n);
  for (let i = 0; i < n; i++) matrix[i * n + i] = size;
  return matrix;
}
