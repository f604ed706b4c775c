// The whole of a run: point, camera, observers. The same numbers as record() and track() in Python.

import { lazily, Memory } from "../common/memory.js";
import { arriving, column, halves, held, known, knownAt, lastSamples, stepGrid, withSteps } from "../common/tables.js";
import { Camera, constantMotion, shapeOf } from "./camera.js";
import { keyOf, switchOf } from "./kernels.js";
import { hiddenError, settlingTime, windowed } from "./measures.js";

const LONGEST_STEP = 0.01;

/** Runs settings. */
export class Engine {
  constructor(model) {
    this.model = model;
    this.memory = new Memory();
    this.camera = new Camera(model, this.memory);
    this.order = Object.keys(model.observers);
  }

  /** Everything that is shown for these settings, with the functions that Kernels.of() gave for them. */
  run(settings, kernels) {
    const chart = this.model.surfaces[settings.surface];
    const structure = this.model.structures[keyOf(settings)];
    const recording = this.camera.record(settings, kernels, chart);
    const shown = { settings, ...recording, width: chart.coordinates.length, names: chart.coordinates, runs: [] };
    const hiddenNames = structure.hidden.map((c) => chart.coordinates[c]);
    Object.assign(shown, { measured: structure.measured, hidden: structure.hidden, hiddenNames });
    Object.assign(shown, this.geometry(settings, kernels, structure));
    if (recording.problem) return shown;
    Object.assign(shown, this.columns("truth", shown.truth, shown.width));
    shown.sampleOf = this.columns("samples", shown.outputs, 2).columnOf;
    lazily(shown, "excitation", () => this.excitation(settings, shown, structure, kernels));
    const inputs = this.inputs(settings, shown);
    shown.runs = settings.observers.map((name) => {
      const kernel = structure.observers[name][switchOf(settings, name)];
      return this.follow(name, settings, shown, inputs, kernel, kernels.observers[name]);
    });
    return shown;
  }

  /** What all observers of a run are given: steps, held outputs, samples as they arrive, known numbers. */
  inputs(settings, shown) {
    const { memory } = this;
    const { time, measured } = shown;
    const columns = measured.map((c) => shown.sampleOf(c));
    const recorded = settings.scenario in this.model.recordings;
    const clock = recorded ? settings.scenario : [settings.period, time.length];
    const { grid, index, steps } = memory.once("grid", clock, () => withSteps(stepGrid(time, LONGEST_STEP)));
    const room = (part) => (length) => memory.room(part, length);
    const exact = settings.hold === "exact" ? this.exact(shown, grid) : null;
    const believed = settings.believed ? constantMotion(settings.believed.A, settings.believed.b) : shown.motion;
    return {
      grid,
      index,
      steps,
      columns,
      last: columns.map((values, m) => lastSamples(values, room(`last ${m}`))),
      held: held(columns, time, grid, index, settings.hold, exact && measured.map((c) => exact[c]), room("held")),
      arriving: arriving(columns, index, grid.length, room("arriving")),
      known: memory.once("known", [clock, settings.believed ?? (recorded ? "" : believed.rows), shown.shape], () =>
        known(believed, shown.shape, grid),
      ),
    };
  }

  follow(name, settings, shown, inputs, kernel, functions) {
    const { memory } = this;
    const { width, time } = shown;
    const { grid, known: table } = inputs;
    const gains = Float64Array.from(kernel.gains, (gain) => settings.gains[name][gain]);
    const states = memory.room(`states of ${name}`, grid.length * kernel.states);
    const resets = memory.room("resets", grid.length).fill(0);
    const start = startState(settings, shown, inputs, kernel, functions, gains);
    const { steps, held: outputs, arriving: samples } = inputs;
    const diverged = functions.run(start, steps, outputs, table.rows, samples, gains, table.varying, states, resets);
    if (diverged >= 0) states.fill(NaN, diverged * kernel.states);
    const estimate = memory.room(`estimate ${name}`, time.length * width);
    const hidden = functions.gap ? shown.hidden : [];
    readEstimates(functions, kernel, states, inputs, gains, width, hidden, estimate);
    const result = {
      name,
      title: this.model.observers[name].title,
      order: this.order.indexOf(name),
      estimate,
      deviation: null,
      ...this.columns(`estimate ${name}`, estimate, width),
      resets: timesOf(resets, grid),
      gaps: functions.gap ? gapsOf(estimate, width, hidden[0], time, diverged < 0 ? Infinity : grid[diverged]) : [],
      gapReason: kernel.gapReason,
      divergedAt: diverged < 0 ? null : grid[diverged],
    };
    if (functions.variances) {
      result.deviation = memory.room(`deviation ${name}`, estimate.length);
      readDeviations(functions, kernel, states, inputs, width, result.deviation);
    }
    if (shown.truth) {
      const error = memory.room(`error ${name}`, time.length);
      result.error = hiddenError(shown.truth, estimate, width, shown.hidden, error);
      result.settling = settlingTime(time, result.error);
    }
    return result;
  }

  /** Functions that give a column of these rows, and the distances: none where the inverse one is not positive. */
  columns(part, rows, width) {
    const found = [];
    const room = (which) => (length) => this.memory.room(`${part} ${which}`, length);
    const columnOf = (c) => (found[c] ??= column(rows, width, c, room(c)));
    const distances = () => {
      if (found[width]) return found[width];
      const inverse = columnOf(width - 1);
      const far = (found[width] = room("distances")(inverse.length));
      for (let k = 0; k < far.length; k++) far[k] = inverse[k] > 0 ? 1 / inverse[k] : NaN;
      return far;
    };
    return { columnOf, distances };
  }

  exact(shown, grid) {
    return this.memory.once("exact", [shown.key, grid.length], () => shown.signal(halves(grid)));
  }

  excitation(settings, shown, structure, kernels) {
    const { time, measured, hidden } = shown;
    const columns = measured.map((c) => (shown.truth ? shown.columnOf(c) : lastSamples(shown.sampleOf(c))));
    const parameters = shown.motion.rows[0].length + shown.shape.length;
    const table = knownAt(shown.motion, shown.shape, time);
    const size = hidden.length * measured.length;
    const w = this.memory.room("w", size * time.length);
    const x = new Float64Array(measured.length + parameters);
    const out = new Float64Array(size);
    if (!table.varying) x.set(table.rows, measured.length);
    for (let k = 0; k < time.length; k++) {
      for (let m = 0; m < measured.length; m++) x[m] = columns[m][k];
      if (table.varying) for (let p = 0; p < parameters; p++) x[measured.length + p] = table.rows[k * parameters + p];
      kernels.structure.w(x, out);
      for (let i = 0; i < size; i++) w[k * size + i] = out[i];
    }
    const window = Math.min(settings.window, time[time.length - 1] - time[0]);
    return { window, ...windowed(time, w, hidden.length, measured.length, window) };
  }

  /** Where the translation points in the image, and where an instant tells too little. */
  geometry(settings, kernels, structure) {
    if (settings.scenario in this.model.recordings) return { foe: null, circle: null };
    const parameters = [...settings.A.flat(), ...settings.b, ...shapeOf(settings)];
    const foe = Array.from(kernels.surface.foe(parameters, [0, 0]));
    if (!foe.every((v) => Math.abs(v) < 1e6)) return { foe: null, circle: null };
    const circle = structure.circle
      ? Array.from(kernels.structure.circle([...parameters, settings.threshold], [0, 0, 0]))
      : null;
    return { foe, circle };
  }
}

/** The b that puts the focus of expansion at an image point, with its distance from the camera kept. */
export function translationTowards(place, settings, kernels) {
  const shape = shapeOf(settings);
  const ray = kernels.surface.ray([...place, ...shape], [0, 0, 0]);
  const [, , distance] = kernels.surface.project([...settings.b, ...shape], [0, 0, 0]);
  return Array.from(ray, (entry) => entry * distance);
}

/** The state at the first sample, from it, from what is known there, and from the estimates that are asked for. */
function startState(settings, shown, { columns, known: table }, kernel, functions, gains) {
  const { mode, values } = settings.start;
  const asked = new Array(shown.width).fill(0);
  if (mode === "own") shown.measured.forEach((c, m) => (asked[c] = columns[m][0]));
  if (mode === "chosen") asked.splice(0, asked.length, ...values);
  const parameters = table.rows.subarray(0, table.width);
  const inputs = [...columns.map((values) => values[0]), ...parameters, ...gains, ...asked];
  return functions.start(inputs, new Float64Array(kernel.states));
}

/** Fill in the estimates at the samples; none of the hidden coordinates in a gap. */
function readEstimates(functions, kernel, states, { index, last, known: table }, gains, width, hidden, estimate) {
  const before = last.length + table.width + gains.length;
  const x = new Float64Array(before + kernel.states);
  const out = new Float64Array(width);
  const missing = new Float64Array(1);
  x.set(table.rows.subarray(0, table.width), last.length);
  x.set(gains, last.length + table.width);
  for (let k = 0; k < index.length; k++) {
    const at = index[k] * kernel.states;
    for (let s = 0; s < kernel.states; s++) x[before + s] = states[at + s];
    for (let m = 0; m < last.length; m++) x[m] = last[m][k];
    if (table.varying) {
      const row = 2 * index[k] * table.width;
      for (let p = 0; p < table.width; p++) x[last.length + p] = table.rows[row + p];
    }
    functions.estimate(x, out);
    for (let c = 0; c < width; c++) estimate[k * width + c] = out[c];
    if (hidden.length && functions.gap(x, missing)[0]) for (const c of hidden) estimate[k * width + c] = NaN;
  }
}

/** The times of every gap's first and last sample: where a hidden coordinate has no estimate, though the run goes on. */
function gapsOf(estimate, width, c, time, end) {
  const found = [];
  let inside = false;
  for (let k = 0; k < time.length && time[k] < end; k++) {
    const missing = Number.isNaN(estimate[k * width + c]);
    if (missing && !inside) found.push([time[k], time[k]]);
    if (missing) found.at(-1)[1] = time[k];
    inside = missing;
  }
  return found;
}

/** Fill in the standard deviations that are claimed at the samples. */
function readDeviations(functions, kernel, states, { index }, width, deviation) {
  const x = new Float64Array(kernel.states);
  const out = new Float64Array(width);
  for (let k = 0; k < index.length; k++) {
    for (let s = 0; s < kernel.states; s++) x[s] = states[index[k] * kernel.states + s];
    functions.variances(x, out);
    for (let c = 0; c < width; c++) deviation[k * width + c] = Math.sqrt(Math.max(0, out[c]));
  }
}

function timesOf(resets, grid) {
  const found = [];
  for (let k = 0; k < resets.length; k++) if (resets[k]) found.push(grid[k]);
  return found;
}
