// @ts-check
// The observer of many points: the same numbers as track() in Python.

import { EACH, instants, plantGrid, stepGrid } from "../../engine/tables.js";
import { rowsOf } from "./camera.js";
import { advance } from "./kernel.js";
import { layoutFollowed } from "./kernels.js";
import { diagonal, product, pseudoInverse } from "./symmetric.js";
import { inversesOf, isComputed, startOfP } from "./weight.js";

/** Follows what a camera has recorded. */
export class Observer {
  constructor(camera) {
    this.camera = camera;
  }

  /** Let the observer follow. */
  track(scene, recording) {
    const { memory, model } = this.camera;
    const { settings, layout, n } = scene;
    const { time, truth } = recording;
    const divide = ({ step }) => {
      const made = stepGrid(time, step);
      return { ...made, places: instants(made.grid) };
    };
    const steps = memory.once("steps", settings, divide, time);
    const inputs = {
      ...steps,
      held: this.held(scene, recording, steps),
      coefficients: this.camera.known(scene, "observer", steps.grid),
      inverses: this.inverses(scene, steps.places),
    };
    const start = new Float64Array(n);
    if (settings.start === "error") {
      const { error } = model;
      for (let i = 0; i < n; i++) start[i] = truth[i] - settings.error * error[i % error.length];
    }
    const estimate = new Float64Array(time.length * n);
    const together = layoutFollowed(model, settings);
    const apart = together === layout ? [0] : settings.points.keys();
    const parts = Array.from(apart, (k) => ({ layout: together, first: k, states: 3 * k }));
    const ends = parts.map((part) => this.follow(scene, recording, inputs, part, start, estimate));
    const divergedAt = Math.min(...ends);
    for (let k = 0; k < time.length; k++) if (time[k] >= divergedAt) estimate.fill(NaN, k * n, k * n + n);
    return { estimate, divergedAt: divergedAt < Infinity ? divergedAt : null };
  }

  /** The inverse of a P that is given, made anew when what it depends on changes. */
  inverses({ settings, functions }, places) {
    const { memory, model } = this.camera;
    const make = (read) => inversesOf(model, read, places, functions);
    return memory.once("inverse of P", settings, make, places, functions.typed);
  }

  /** Images as held between samples: a row for each instant of each step. */
  held(scene, { time, outputs }, { index, steps, places }) {
    const { camera } = this;
    const { memory } = camera;
    const { settings, points } = scene;
    const { hold } = settings;
    const wide = 2 * points;
    const table = memory.room("held", (EACH + 1) * wide * steps.length);
    let exact = null;
    if (hold === "exact") {
      const breaks = camera.kinks(settings);
      const plant = memory.once("exact plant", settings, () => plantGrid(places, breaks), places, breaks);
      exact = camera.project(scene, camera.move(scene, "signal", plant)).images;
    }
    for (let k = 0; k + 1 < time.length; k++) {
      for (let j = index[k]; j < index[k + 1]; j++) {
        for (let stage = 0; stage <= EACH; stage++) {
          const share = (places[EACH * j + stage] - time[k]) / (time[k + 1] - time[k]);
          for (let c = 0; c < wide; c++) {
            const before = outputs[k * wide + c];
            let value = before;
            if (hold === "first") value = (1 - share) * before + share * outputs[(k + 1) * wide + c];
            if (exact) value = Number.isNaN(before) ? NaN : exact[(EACH * j + stage) * wide + c];
            table[((EACH + 1) * j + stage) * wide + c] = value;
          }
        }
      }
    }
    return table;
  }

  /** Follow a part of the points; returns when the estimate diverged, or Infinity. */
  follow(scene, { time, outputs }, inputs, { layout, first, states }, start, estimate) {
    const { settings, points, n, width } = scene;
    const { grid, index, steps, held, coefficients, inverses } = inputs;
    const own = layout.names.length;
    const count = layout.begins.length - 1;
    const begun = isComputed(settings) ? startOfP(this.camera.model, settings, own, scene.functions) : null;
    const law = lawOf(settings, begun, own);
    let x = start.slice(states, states + own);
    const P = begun?.slice() ?? null;
    const began = settings.start === "rays" ? firstSights(outputs, time.length, points, first, count) : new Map();
    const stops = [...new Set([0, ...began.keys(), time.length - 1])].sort((a, b) => a - b);
    const seen = new Set();
    for (let s = 0; s < stops.length; s++) {
      const sample = stops[s];
      const fresh = began.get(sample);
      if (fresh) {
        this.onRays(scene, { layout, own, first }, outputs.subarray(2 * sample * points), fresh, seen, x, P, begun);
        fresh.forEach((k) => seen.add(k));
      }
      for (let i = 0; i < own; i++) estimate[sample * n + states + i] = x[i];
      if (s === stops.length - 1) break;
      const next = stops[s + 1];
      const [from, to] = [index[sample], index[next]];
      const path = this.camera.memory.room("observer's path", (to - from + 1) * own);
      const tables = {
        steps: steps.subarray(from, to),
        coefficients: coefficients.subarray(EACH * from * width),
        width,
        inverses: { ...inverses, rows: inverses.rows.subarray(inverses.constant ? 0 : EACH * from * inverses.entries) },
        images: held.subarray((EACH + 1) * 2 * points * from),
        points,
        first,
      };
      const diverged = advance(layout, scene.functions, law, x, P, tables, path);
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
  onRays({ settings, functions }, { layout, own, first }, images, fresh, seen, x, P, begun) {
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
    const make = () => pseudoInverse(part, rows.length, free.length);
    const inverse = this.camera.memory.once(`rays ${first}`, settings, make, layout, rows.join(), free.join());
    product(inverse, goal, free.length).forEach((value, k) => (x[free[k]] = value));
    if (!P) return;
    for (const i of free) for (let j = 0; j < own; j++) P[i * own + j] = P[j * own + i] = 0;
    for (const i of free) for (const j of free) P[i * own + j] = begun[i * own + j];
  }
}

/** Law of P, where it is computed. */
function lawOf({ weight, forgetting, decrease }, begun, n) {
  if (weight === "riccati")
    return { computed: true, information: 1, forgetting, pull: begun.map((value) => forgetting * value) };
  const pull = weight === "lyapunov" ? diagonal(n, () => -decrease) : null;
  return { computed: pull !== null, information: 0, forgetting: 0, pull };
}

/** The samples at which points are first seen, with these points. */
function firstSights(outputs, samples, points, first, count) {
  const found = new Map();
  for (let k = 0; k < count; k++) {
    let sample = 0;
    while (sample < samples && Number.isNaN(outputs[2 * (sample * points + first + k)])) sample++;
    if (sample < samples) found.set(sample, [...(found.get(sample) ?? []), k]);
  }
  return found;
}
