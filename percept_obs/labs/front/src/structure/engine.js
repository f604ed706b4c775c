// The whole of a run: object, camera, observers. The same numbers as record_structure() and track() in Python.

import { lazily } from "../common/memory.js";
import { Runner } from "../common/runner.js";
import { halves, stepGrid, withSteps } from "../common/tables.js";
import { motionOf, StructureCamera } from "./camera.js";
import { keyOf } from "./kernels.js";

const OUTPUTS = ["y1", "y2", "ybar3"];

/** Runs settings. */
export class StructureEngine extends Runner {
  constructor(model) {
    super(model);
    this.camera = new StructureCamera(model, this.memory);
  }

  /** Everything that is shown for these settings, with the functions that StructureKernels.of() gave for them. */
  run(settings, kernels, refusal) {
    const recording = this.camera.record(settings, kernels);
    const { image, outputs } = recording;
    const shown = { settings, ...recording, scale: settings.scale, tolerance: settings.tolerance, refusal, runs: [] };
    shown.sampleOf = this.columns("samples", outputs, 3).columnOf;
    if (recording.problem || refusal) {
      const seen = { truth: image, width: 3, names: OUTPUTS, ...this.columns("image", image, 3) };
      return Object.assign(shown, { measured: [0, 1, 2], hidden: [], hiddenNames: [], ...seen });
    }
    const choice = this.model.unknowns[keyOf(settings)];
    const hidden = choice.unknown.map((_, i) => 3 + i);
    const hiddenNames = choice.unknown.map((_, i) => `theta${i + 1}`);
    const width = 3 + hidden.length;
    Object.assign(shown, { choice, hidden, hiddenNames, width, measured: [0, 1, 2], names: [...OUTPUTS, ...hiddenNames] });
    const truth = this.truth(shown, kernels);
    Object.assign(shown, { truth, ...this.columns("truth", truth, width) });
    this.readable(shown, shown, "truth");
    const inputs = this.inputs(settings, shown, kernels);
    const asked = OUTPUTS.map((_, c) => (settings.start === "own" ? inputs.columns[c][0] : 0));
    asked.push(...hidden.map(() => 0));
    lazily(shown, "guard", () => this.guard(shown, inputs, kernels));
    lazily(shown, "limits", () => this.limits(settings, inputs, kernels));
    shown.runs = settings.observers.map((name) => {
      const kernel = this.model.forms[hidden.length].observers[name];
      const run = this.follow(name, settings.gains[name], shown, inputs, kernel, kernels.observers[name], asked);
      run.innovation = () => this.innovation(run, inputs.last, name);
      return this.readable(run, shown, `estimate ${name}`);
    });
    return shown;
  }

  /** Rows of what the choice makes of the velocities at some times: M, m, theta; one row if they do not change. */
  signals(settings, count, { swinging, signals }, times) {
    const { rows, varying } = this.camera.velocities(settings, swinging, times);
    const size = 4 * count + 3;
    const found = new Float64Array((rows.length / 9) * size);
    const x = new Float64Array(10);
    const out = new Float64Array(size);
    x[0] = settings.scale;
    for (let k = 0; 9 * k < rows.length; k++) {
      for (let i = 0; i < 9; i++) x[1 + i] = rows[9 * k + i];
      found.set(signals(x, out), k * size);
    }
    return { found, size, varying };
  }

  /** True ybar and theta at the samples. */
  truth({ settings, time, image, width, hidden }, kernels) {
    const count = hidden.length;
    const place = [keyOf(settings), motionOf(settings), settings.scale, settings.period, time.length];
    const { found, size, varying } = this.memory.once("theta", place, () => this.signals(settings, count, kernels, time));
    const truth = this.memory.room("truth", width * time.length);
    for (let k = 0; k < time.length; k++) {
      const from = (varying ? k : 0) * size + 3 * count + 3;
      for (let c = 0; c < 3; c++) truth[k * width + c] = image[3 * k + c];
      for (let i = 0; i < count; i++) truth[k * width + 3 + i] = found[from + i];
    }
    return truth;
  }

  inputs(settings, shown, kernels) {
    const { memory } = this;
    const count = shown.hidden.length;
    const clock = [settings.period, settings.step, shown.time.length];
    const lines = memory.once("grid", clock, () => withSteps(stepGrid(shown.time, settings.step)));
    const place = [clock, keyOf(settings), motionOf(settings), settings.scale];
    const known = memory.once("known", place, () => this.known(settings, count, kernels, halves(lines.grid)));
    const between = [clock, motionOf(settings), settings.ybar, settings.scale];
    const exact = () => memory.once("exact", between, () => ({ lines: shown.signal(halves(lines.grid)) })).lines;
    return this.layOut(shown, lines, known, settings.hold, settings.hold === "exact" ? exact() : null);
  }

  /** What the observers know of the motion: rows of w, M, m. */
  known(settings, count, kernels, times) {
    const { found, size, varying } = this.signals(settings, count, kernels, times);
    const width = 3 * count + 6;
    const rows = new Float64Array((found.length / size) * width);
    for (let k = 0; k * size < found.length; k++) {
      rows.set(settings.w, k * width);
      rows.set(found.subarray(k * size, k * size + 3 * count + 3), k * width + 3);
    }
    return { rows, width, varying };
  }

  /** Add the unknown quantities and the range to rows of ybar and theta: NaN where no positive d_s follows. */
  readable(owner, { choice, scale }, part) {
    const { columnOf } = owner;
    const at = choice.unknown.indexOf("d_s");
    const found = {};
    const room = (which) => this.memory.room(`${part} ${which}`, columnOf(0).length);
    const scaleOf = (k) => (at < 0 ? scale : columnOf(3 + at)[k] > 0 ? columnOf(3 + at)[k] : NaN);
    owner.quantityOf = (name) => (found[name] ??= fillWith(room(name), quantity(choice, name, columnOf, scaleOf)));
    owner.distances = () => (found.range ??= fillWith(room("range"), (k) => {
      const inverse = scaleOf(k) * columnOf(2)[k];
      return inverse > 0 && !Number.isNaN(columnOf(3)[k]) ? 1 / inverse : NaN;
    }));
    return owner;
  }

  /** The largest difference of a sample and its estimate. */
  innovation(run, last, name) {
    const columns = last.map((_, c) => run.columnOf(c));
    return fillWith(this.memory.room(`innovation ${name}`, last[0].length), (k) => {
      let most = 0;
      for (let c = 0; c < columns.length; c++) most = Math.max(most, Math.abs(last[c][k] - columns[c][k]));
      return most;
    });
  }

  /** How much recovering theta amplifies errors along the run, and the determinant that it divides by. */
  guard({ time }, { index, last, known }, { guard }) {
    const sizes = this.memory.room("guard sizes", time.length);
    const determinants = this.memory.room("guard determinants", time.length);
    const x = new Float64Array(3 + known.width);
    const out = new Float64Array(2);
    x.set(known.rows.subarray(0, known.width), 3);
    for (let k = 0; k < time.length; k++) {
      for (let m = 0; m < 3; m++) x[m] = last[m][k];
      const row = 2 * index[k] * known.width;
      if (known.varying) for (let p = 0; p < known.width; p++) x[3 + p] = known.rows[row + p];
      guard(x, out);
      sizes[k] = out[0];
      determinants[k] = out[1];
    }
    return { sizes, determinants };
  }

  /** Where an observer's steps become too long for its fastest part: by its name, from when on. */
  limits(settings, { grid, steps }, kernels) {
    const { largestStepRate } = this.model;
    return settings.observers.flatMap((name) => {
      const { fastest } = kernels.observers[name];
      if (!fastest) return [];
      const kernel = this.model.forms[settings.unknown.length].observers[name];
      const x = Float64Array.from([0, ...kernel.gains.map((gain) => settings.gains[name][gain])]);
      const out = new Float64Array(1);
      const rateAt = (k) => {
        x[0] = grid[k + 1] - grid[0];
        return fastest(x, out)[0];
      };
      let first = -1;
      let most = 0;
      for (let k = 0; k < steps.length; k++) {
        const rate = rateAt(k);
        most = Math.max(most, rate);
        if (first < 0 && rate * steps[k] >= largestStepRate) first = k;
      }
      if (first < 0) return [];
      const found = { name, time: grid[first] - grid[0], rate: rateAt(first), step: steps[first] };
      return [{ ...found, shorter: largestStepRate / most, remedy: kernel.remedy }];
    });
  }
}

function fillWith(room, valueAt) {
  for (let k = 0; k < room.length; k++) room[k] = valueAt(k);
  return room;
}

/** An unknown quantity at a sample, as StructureAndMotion.quantities(). */
function quantity(choice, name, columnOf, scaleOf) {
  const i = choice.unknown.indexOf(name);
  if (name === "d_s") return scaleOf;
  return choice.scaled[i] ? (k) => columnOf(3 + i)[k] / scaleOf(k) : (k) => columnOf(3 + i)[k];
}
