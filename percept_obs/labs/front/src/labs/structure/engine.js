// The whole of a run: object, camera, observers. The same numbers as record() and track() in Python.

import { columnOf, derived } from "../../engine/derived.js";
import { distanceError } from "../../engine/errors.js";
import { evaluated, Runner } from "../../engine/runner.js";
import { column, EACH, instants, lastSamples, stepGrid } from "../../engine/tables.js";
import { StructureCamera } from "./camera.js";
import { keyOf } from "./kernels.js";
import { quantityOf } from "./quantities.js";

const OUTPUTS = ["y1", "y2", "ybar3"];

export class StructureEngine extends Runner {
  constructor(model) {
    super(model);
    this.camera = new StructureCamera(model, this.memory);
  }

  /** @returns {import("../../types.js").StructureResult} what is shown of settings: whole, or as far as is drawn */
  run(settings, functions, whole = true) {
    const { refusal } = functions;
    const { scale, tolerance } = settings;
    const recording = this.camera.record(settings, functions);
    const { settledPart } = this.model;
    const told = { scale, tolerance, settledPart, refusal, sampled: 3, measured: [0, 1, 2] };
    const seen = { settings, ...recording, image: recording.truth, ...told };
    if (recording.problem || refusal) {
      const nothing = { hidden: [], hiddenNames: [], runs: [], choice: null, guard: null, limits: [], whole: true };
      return { ...seen, ...nothing, width: 3, names: OUTPUTS };
    }
    const { unknown, scaled, square } = this.model.unknowns[keyOf(settings)];
    const hidden = unknown.map((_, i) => 3 + i);
    const hiddenNames = unknown.map((_, i) => `theta${i + 1}`);
    const width = 3 + hidden.length;
    const truth = this.truth(seen, hidden.length, functions);
    const names = [...OUTPUTS, ...hiddenNames];
    const judged = unknown.map((name) => (name === "d_s" ? this.model.judged : name)).join(", ");
    const fastest = (read) => this.greatestSpeed(read, seen.time, functions);
    const speed = this.memory.once("speed", settings, fastest, settings.period, seen.time.length);
    const choice = { unknown, scaled, square };
    const result = { ...seen, judged, speed, choice, hidden, hiddenNames, width, names, truth, runs: [] };
    const lines = this.lines(result);
    const known = this.known(result, lines, functions);
    const exact = settings.hold === "exact" ? this.exact(settings, lines.grid, functions) : null;
    const inputs = this.layOut(result, lines, known, settings.hold, exact, settings.start === "own");
    const asked = OUTPUTS.map((_, c) => (settings.start === "own" ? inputs.columns[c][0] : 0));
    asked.push(...hidden.map(() => 0));
    const { observers } = this.model.forms[hidden.length];
    result.runs = this.followAll(settings, result, inputs, (name) => observers[name], functions, asked);
    if (whole) return this.completed(result, functions);
    return { ...result, guard: null, limits: [], whole: false };
  }

  /** The largest of the unknowns, as StructureAndMotion.relative_error(): a velocity's is relative to the speed. */
  relativeError(result, estimate) {
    const { truth, choice, width, time } = result;
    const ones = new Float64Array(time.length).fill(1);
    const inverseOf = (rows) => derived(rows, "inverse where d_s is positive", () => {
      const scale = quantityOf(result, rows, "d_s");
      return columnOf(rows, width, 2).map((value, k) => scale[k] * value);
    });
    const [right, inverse] = choice.unknown.includes("d_s") ? [truth, estimate].map(inverseOf) : [ones, ones];
    const error = distanceError(right, inverse, estimate, width);
    const { speed } = result;
    for (const name of choice.unknown.filter((each) => each !== "d_s")) {
      const [found, right] = [estimate, truth].map((rows) => quantityOf(result, rows, name));
      for (let k = 0; k < time.length; k++) {
        const off = Math.abs(found[k] - right[k]);
        const share = speed > 0 ? off / speed : off > 0 ? Infinity : off;
        if (error[k] !== Infinity && !Number.isNaN(error[k]) && !(share <= error[k])) error[k] = share;
      }
    }
    return error;
  }

  /** Greatest speed of the point relative to the camera, in m/s. */
  greatestSpeed(settings, time, functions) {
    const { rows } = this.camera.velocities(settings, functions, time);
    let most = 0;
    for (let k = 0; k < rows.length; k += 9) {
      const [x, y, z] = [3, 4, 5].map((at) => rows[k + at + 3] - rows[k + at]);
      most = Math.max(most, Math.hypot(x, y, z));
    }
    return most;
  }

  /** A result with all that is read off it. */
  completed(result, functions) {
    const lines = this.lines(result);
    const guard = this.guard(result, lines, this.known(result, lines, functions), functions);
    return { ...result, guard, limits: this.limits(result, lines, functions), whole: true };
  }

  /** Rows of what the choice makes of the velocities at some times: M, m, theta; one row if they do not change. */
  signals(settings, count, functions, times) {
    const { signals } = functions;
    const { rows, varying } = this.camera.velocities(settings, functions, times);
    const size = 4 * count + 3;
    const found = new Float64Array((rows.length / 9) * size);
    const x = new Float64Array(10);
    const out = new Float64Array(size);
    x[0] = settings.scale;
    for (let k = 0; 9 * k < rows.length; k++) {
      for (let i = 0; i < 9; i++) x[1 + i] = rows[9 * k + i];
      found.set(signals(x, out), k * size);
    }
    return { found, size, varying, velocities: rows };
  }

  /** True ybar and theta at the samples. */
  truth({ settings, time, image }, count, functions) {
    const width = 3 + count;
    const make = (read) => this.signals(read, count, functions, time);
    const inputs = [functions.signals, settings.period, time.length];
    const { found, size, varying } = this.memory.once("theta", settings, make, ...inputs);
    const truth = new Float64Array(width * time.length);
    for (let k = 0; k < time.length; k++) {
      const from = (varying ? k : 0) * size + 3 * count + 3;
      for (let c = 0; c < 3; c++) truth[k * width + c] = image[3 * k + c];
      for (let i = 0; i < count; i++) truth[k * width + 3 + i] = found[from + i];
    }
    return truth;
  }

  lines({ settings, time }) {
    const make = ({ step }) => stepGrid(time, step);
    return this.memory.once("grid", settings, make, settings.period, time.length);
  }

  /** Known signals of the observers: rows of w_c, M, m. */
  known({ settings, hidden }, { grid }, functions) {
    const count = hidden.length;
    const make = (read) => {
      const { found, size, varying, velocities } = this.signals(read, count, functions, instants(grid));
      const width = 3 * count + 6;
      const rows = new Float64Array((found.length / size) * width);
      for (let k = 0; k * size < found.length; k++) {
        rows.set(velocities.subarray(9 * k, 9 * k + 3), k * width);
        rows.set(found.subarray(k * size, k * size + 3 * count + 3), k * width + 3);
      }
      return { rows, width, varying };
    };
    return this.memory.once("known", settings, make, grid, functions.signals);
  }

  /** Amplification of errors by recovering theta along the run, and the determinant that it divides by. */
  guard({ outputs }, { index }, known, { guard }) {
    const last = [0, 1, 2].map((c) => lastSamples(columnOf(outputs, 3, c)));
    const found = evaluated(guard, last, known, 2, (k) => EACH * index[k]);
    return { sizes: column(found, 2, 0), determinants: column(found, 2, 1) };
  }

  /** Where an observer's steps become too long for its fastest part: by its name, from when on. */
  limits({ settings }, { grid, steps }, functions) {
    const { largestStepRate } = this.model;
    return settings.observers.flatMap((name) => {
      const { fastest } = functions.observers[name];
      if (!fastest) return [];
      const kernel = this.model.forms[settings.unknown.length].observers[name];
      const x = Float64Array.from([0, ...kernel.gains.map((gain) => settings.gains[name][gain])]);
      const out = new Float64Array(1);
      const rateIn = (k) => {
        x[0] = grid[k + 1] - grid[0];
        return fastest(x, out)[0];
      };
      let [first, most] = [-1, 0];
      for (let k = 0; k < steps.length; k++) {
        const rate = rateIn(k);
        most = Math.max(most, rate);
        if (first < 0 && rate * steps[k] >= largestStepRate) first = k;
      }
      if (first < 0) return [];
      const found = { name, time: grid[first] - grid[0], rate: rateIn(first), step: steps[first] };
      return [{ ...found, shorter: largestStepRate / most, remedy: kernel.remedy }];
    });
  }
}
