// The whole of a run: point, camera, observers. The same numbers as record() and track() in Python.

import { lazily } from "../common/memory.js";
import { switchOf } from "../common/observer_list.js";
import { Runner } from "../common/runner.js";
import { halves, known, knownAt, lastSamples, stepGrid, withSteps } from "../common/tables.js";
import { Camera, constantMotion, shapeOf } from "./camera.js";
import { keyOf } from "./kernels.js";
import { windowed } from "./measures.js";

const LONGEST_STEP = 0.01;
const TOLERANCE = 0.05;

/** Runs settings. */
export class Engine extends Runner {
  constructor(model) {
    super(model);
    this.camera = new Camera(model, this.memory);
  }

  /** Everything that is shown for these settings, with the functions that Kernels.of() gave for them. */
  run(settings, kernels) {
    const chart = this.model.surfaces[settings.surface];
    const structure = this.model.forms[keyOf(settings)];
    const recording = this.camera.record(settings, kernels, chart);
    const shown = { settings, ...recording, width: chart.coordinates.length, names: chart.coordinates, runs: [] };
    shown.tolerance = TOLERANCE;
    const hiddenNames = structure.hidden.map((c) => chart.coordinates[c]);
    Object.assign(shown, { measured: structure.measured, hidden: structure.hidden, hiddenNames });
    Object.assign(shown, this.geometry(settings, kernels, structure));
    if (recording.problem) return shown;
    Object.assign(shown, this.columns("truth", shown.truth, shown.width));
    shown.sampleOf = this.columns("samples", shown.outputs, 2).columnOf;
    lazily(shown, "excitation", () => this.excitation(settings, shown, structure, kernels));
    const inputs = this.inputs(settings, shown);
    const asked = estimatesAsked(settings, shown, inputs);
    shown.runs = settings.observers.map((name) => {
      const kernel = structure.observers[name][switchOf(settings, name)];
      return this.follow(name, settings.gains[name], shown, inputs, kernel, kernels.observers[name], asked);
    });
    return shown;
  }

  /** What all observers of a run are given: steps, held outputs, samples as they arrive, known numbers. */
  inputs(settings, shown) {
    const { memory } = this;
    const { time, measured } = shown;
    const recorded = settings.scenario in this.model.recordings;
    const clock = recorded ? settings.scenario : [settings.period, time.length];
    const lines = memory.once("grid", clock, () => withSteps(stepGrid(time, LONGEST_STEP)));
    const { grid } = lines;
    const exact = settings.hold === "exact" ? this.exact(shown, grid) : null;
    const believed = settings.believed ? constantMotion(settings.believed.A, settings.believed.b) : shown.motion;
    const table = memory.once("known", [clock, settings.believed ?? (recorded ? "" : believed.rows), shown.shape], () =>
      known(believed, shown.shape, grid),
    );
    return this.layOut(shown, lines, table, settings.hold, exact && measured.map((c) => exact[c]));
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

/** The estimates at the first sample: that sample and 0, or what is asked for. */
function estimatesAsked({ start }, { width, measured }, { columns }) {
  if (start.mode === "chosen") return start.values;
  const asked = new Array(width).fill(0);
  if (start.mode === "own") measured.forEach((c, m) => (asked[c] = columns[m][0]));
  return asked;
}
