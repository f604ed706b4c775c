// Camera of one point, which moves, is projected and sampled; or a real track. As record() in Python.

import { errorOf, PointCamera } from "../../engine/camera.js";
import { derived } from "../../engine/derived.js";
import { known, withColumns } from "../../engine/tables.js";
import { seesSize } from "./size.js";
import { breaksOf, isTyped, typedAlong, typedRows } from "../../engine/typed.js";

export class Camera extends PointCamera {
  constructor(model, memory) {
    super(model, memory, 2, "move its start X, Y, Z in front of it");
    /** Rows of typed motions by the grids that they are along. */
    this.along = new WeakMap();
  }

  record(settings, functions) {
    const recorded = this.model.recordings[settings.scenario];
    return recorded ? derived(recorded, "track", () => readTrack(recorded)) : super.record(settings, functions);
  }

  /** The motion of a scenario that was sampled, if it was. */
  sampledMotion(scenario) {
    return this.model.scenarios[scenario]?.track;
  }

  kinks({ scenario, motion }) {
    return this.sampledMotion(scenario)?.times ?? breaksOf(this.model, motion);
  }

  path(settings, functions, lines) {
    const { motion, shape } = this.motion(settings, functions);
    const start = settings.X0;
    if (motion.times?.length === 1) return { start, known: { rows: motion.rows[0], varying: false }, shape };
    const make = (read) => known(this.motion(read, functions).motion, [], lines.grid);
    return { start, known: this.memory.once("path", settings, make, lines.grid), shape };
  }

  /** A motion that was typed: numbers at any times, and along the steps of a grid. */
  typedMotion({ A, b }, { typed }) {
    const numbers = [...A.flat(), ...b];
    return {
      count: numbers.length,
      over: (times, shape) => typedRows(typed, [...numbers, ...shape], times),
      along: (grid, shape) => typedAlong(this.along, typed, [...numbers, ...shape], grid),
    };
  }

  drawsFor(settings) {
    return seesSize(settings) ? 3 : 2;
  }

  sampled({ truth }, { noise: { kind, size }, dropout }, { shape, loss }) {
    const outputs = new Float64Array(shape.length);
    const each = shape.length / loss.length;
    const exact = (k, c) => (c < 2 ? truth[3 * k + c] : this.model.radius * truth[3 * k + 2]);
    for (let k = 0; k < loss.length; k++) {
      const lost = k > 0 && loss[k] < dropout;
      for (let c = 0; c < each; c++) {
        const error = errorOf(kind, size, shape[each * k + c]);
        outputs[each * k + c] = lost ? NaN : exact(k, c) + error;
      }
    }
    return outputs;
  }

  /** The motion that a recording brings with it, or that settings say, with the surface's own numbers. */
  motion(settings, functions) {
    const recorded = this.model.recordings[settings.scenario];
    if (recorded) return { motion: motionOf(this.model, recorded), shape: [] };
    const table = this.sampledMotion(settings.scenario);
    const shape = shapeOf(settings);
    if (table) return { motion: derived(table, "columns", () => withColumns(table)), shape };
    return { motion: isTyped(settings) ? this.typedMotion(settings, functions) : constantMotion(settings), shape };
  }
}

/** True if the motion of settings varies. */
export function varies(settings, { recordings, scenarios }) {
  return settings.scenario in recordings || Boolean(scenarios[settings.scenario]?.track) || isTyped(settings);
}

/** The numbers of the surface's shape, as in Python's surfaces.py. */
export function shapeOf({ surface, normal, xi }) {
  return { plane: normal, unified: [xi] }[surface] ?? [];
}

/** A motion that stays as it is, as a table of one row. */
export function constantMotion({ A, b }) {
  return { times: [0], rows: [[...A.flat(), ...b]] };
}

/** The motion of a recording, which it may share with others, by its own time. */
export function motionOf({ motions }, recorded) {
  const { times, rows } = motions[recorded.motion];
  const own = () => withColumns({ times: times.map((time) => time - recorded.begin), rows });
  return derived(recorded, "motion", own);
}

/** The samples of a recording, and its truth. */
export function readTrack(track) {
  const number = (value) => (value === null ? NaN : value);
  // A track may have y1 or y2 alone: what is missing stays a column of NaN that nothing measures.
  const both = track.samples.map((row) => ["y1", "y2"].map((name) => number(row[track.names.indexOf(name)] ?? null)));
  return {
    time: Float64Array.from(track.time),
    truth: track.truth && Float64Array.from(track.truth.flat(), number),
    outputs: Float64Array.from(both.flat()),
    leavesAt: null,
  };
}
