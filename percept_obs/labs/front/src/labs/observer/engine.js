// The whole of a run: point, camera, observers. The same numbers as record() and track() in Python.

import { LONGEST_STEP } from "../../engine/integrator.js";
import { columnOf } from "../../engine/derived.js";
import { distanceError } from "../../engine/errors.js";
import { evaluated, Runner } from "../../engine/runner.js";
import { switchOf } from "../../state/settings.js";
import { known, knownAt, lastSamples, spansOf, stepGrid, windowIn } from "../../engine/tables.js";
import { boundOf, noBound, variancesOf } from "./bound.js";
import { Camera, constantMotion, shapeOf, varies } from "./camera.js";
import { keyOf } from "./kernels.js";
import { windowed } from "./measures.js";
import { drawn, outputsOf, seesSize, startWithSize, withoutSize, withSize } from "./size.js";

/** An image coordinate that is as good as infinite, and what is next to nothing beside a length. */
const INFINITY = 1e6;
const NEARLY = 1e-9;
const NONE = new Float64Array(0);
/** What settings have whose translation points nowhere in the image. */
const NOWHERE = { foe: null, foeTowards: null, circle: null };

export class Engine extends Runner {
  constructor(model) {
    super(model);
    this.camera = new Camera(model, this.memory);
  }

  /** @returns {import("../../types.js").ObserverResult} what is shown of settings: whole, or as far as is drawn */
  run(settings, functions, whole = true) {
    const { coordinates: names } = this.model.surfaces[settings.surface];
    const form = this.model.forms[keyOf(settings)];
    const { measured, hidden } = drawn(settings, form);
    const sized = seesSize(settings);
    const { tolerance, settledPart, judged } = this.model;
    const result = {
      settings,
      ...this.camera.record(settings, functions),
      ...this.geometry(settings, functions, form),
      ...{ sampled: sized ? 3 : 2, radius: sized ? this.model.radius : 0 },
      ...{ width: 3, names, measured, hidden, hiddenNames: hidden.map((c) => names[c]) },
      ...{ tolerance, settledPart, judged, runs: [], inside: [] },
      ...{ bound: null, excitation: null, whole: false },
    };
    if (result.problem) return { ...result, whole: true };
    const { truth, time, circle } = result;
    if (truth && circle) {
      const [y1, y2, radius] = circle;
      const isInside = (k) => (truth[3 * k] - y1) ** 2 + (truth[3 * k + 1] - y2) ** 2 < radius * radius;
      result.inside = spansOf(time.length, isInside).map(({ first, last }) => [time[first], time[last]]);
    }
    const all = withSize(result, form, this.model.radius);
    const inputs = this.inputs(settings, all, functions);
    const asked = estimatesAsked(settings, all, inputs);
    const kernelOf = (name) => form.observers[name][switchOf(settings, name)];
    const runs = this.followAll(settings, all, inputs, kernelOf, functions, asked);
    result.runs = sized ? runs.map(withoutSize) : runs;
    return whole ? this.completed(result, functions) : result;
  }

  /** A result with all that is read off it. */
  completed(result, functions) {
    const all = withSize(result, this.model.forms[keyOf(result.settings)], this.model.radius);
    const [bound, excitation] = [this.bound(result, functions), this.excitation(all, functions)];
    return { ...result, bound, excitation, whole: true };
  }

  /** The steps of a run, and the numbers that are known at them. */
  known(settings, { time }, functions) {
    const { memory } = this;
    const recorded = settings.scenario in this.model.recordings;
    const clock = recorded ? [time] : [settings.period, time.length];
    const lines = memory.once("grid", settings, () => stepGrid(time, LONGEST_STEP), ...clock);
    const believe = (read) => {
      const { motion, shape } = this.camera.motion(read, functions);
      return known(read.believed ? constantMotion(read.believed) : motion, shape, lines.grid);
    };
    return { lines, table: memory.once("known", settings, believe, lines) };
  }

  inputs(settings, result, functions) {
    const { lines, table } = this.known(settings, result, functions);
    const exact = settings.hold === "exact" ? this.exact(settings, lines.grid, functions) : null;
    const { hold, start } = settings;
    const columns = exact && outputsOf(exact, result.measured, this.model.radius);
    return this.layOut(result, lines, table, hold, columns, start.mode === "own");
  }

  /** The least relative error that the noise leaves; null where there is none. */
  bound(result, functions) {
    const { settings } = result;
    if (noBound(settings, this.model)) return null;
    const { lines, table } = this.known(settings, result, functions);
    const make = (read) => {
      const { motion, shape } = this.camera.motion(read, functions);
      const truly = read.believed ? known(motion, shape, lines.grid) : table;
      return boundOf(result, lines, truly, functions.flow, variancesOf(read, this.model));
    };
    return this.memory.once("bound", settings, make, result.outputs, result.measured, table);
  }

  /** Relative error of the distance, whose inverse is the last coordinate. */
  relativeError({ truth, width }, estimate) {
    const [right, found] = [truth, estimate].map((rows) => columnOf(rows, width, width - 1));
    return distanceError(right, found, estimate, width);
  }

  excitation({ settings, time, truth, outputs, measured, hidden, width, sampled }, functions) {
    const window = windowIn(time, settings.window);
    if (!functions.w) return { window, time: NONE, smallest: NONE, begun: { time: NONE, smallest: NONE } };
    const seen = (c) => (truth ? columnOf(truth, width, c) : lastSamples(columnOf(outputs, sampled, c)));
    const columns = measured.map(seen);
    const { motion, shape } = this.camera.motion(settings, functions);
    const w = evaluated(functions.w, columns, knownAt(motion, shape, time), hidden.length * measured.length);
    return { window, ...windowed(time, w, hidden.length, measured.length, window) };
  }

  /** Where the translation points in the image, and where an instant tells too little. */
  geometry(settings, functions, form) {
    if (varies(settings, this.model)) return NOWHERE;
    const foe = focusOf(settings, functions, this.model);
    if (!foe) return { ...NOWHERE, foeTowards: towardsFoe(settings, functions) };
    const at = [...parametersOf(settings), settings.threshold];
    return { ...NOWHERE, foe, circle: form.circle ? Array.from(functions.circle(at, [0, 0, 0])) : null };
  }
}

function parametersOf(settings) {
  return [...settings.A.flat(), ...settings.b, ...shapeOf(settings)];
}

/** The focus of expansion in the image; null where it is at infinity, or the motion varies. */
function focusOf(settings, functions, model) {
  if (varies(settings, model)) return null;
  return inImage(functions, parametersOf(settings));
}

/**
 * Where the translation of a motion's numbers points in the image; null where that is at infinity, or nothing
 * translates.
 */
export function inImage(functions, numbers) {
  const foe = Array.from(functions.foe(numbers, [0, 0]));
  return foe.every((v) => Math.abs(v) < INFINITY) ? foe : null;
}

/** The direction in the image in which a focus of expansion lies that is at infinity; null where nothing translates. */
function towardsFoe(settings, functions) {
  const shape = shapeOf(settings);
  const length = Math.hypot(...settings.b);
  // A little of the translation along the middle ray brings it back from infinity, on the same side.
  const ahead = functions.ray([0, 0, ...shape], [0, 0, 0]);
  const b = settings.b.map((value, i) => value + NEARLY * length * ahead[i]);
  const [y1, y2] = functions.foe([...settings.A.flat(), ...b, ...shape], [0, 0]);
  const far = Math.hypot(y1, y2);
  return length > 0 && far < Infinity && far > 0 ? [y1 / far, y2 / far] : null;
}

/** The b that puts the focus of expansion at an image point, with its distance from the camera kept. */
export function translationTowards(place, settings, functions) {
  const shape = shapeOf(settings);
  const ray = functions.ray([...place, ...shape], [0, 0, 0]);
  const [, , distance] = functions.project([...settings.b, ...shape], [0, 0, 0]);
  const length = Math.hypot(...settings.b);
  // From infinity it comes back with the speed kept, since it had no distance from the camera.
  const size = Math.abs(distance) > NEARLY * length ? distance : length / Math.hypot(...ray);
  return Array.from(ray, (entry) => entry * size);
}

/** The estimates at the first sample: that sample and 0, or what is asked for. */
function estimatesAsked({ start }, { width, measured }, { columns }) {
  if (start.mode === "chosen") return startWithSize(start.values, columns);
  const asked = new Array(width).fill(0);
  if (start.mode === "own") measured.forEach((c, m) => (asked[c] = columns[m][0]));
  return asked;
}
