// What a camera records: a point moves, is projected and sampled; or a real track. As record() does in Python.

import { errorOf, PointCamera } from "../../common/model/camera.js";

export class Camera extends PointCamera {
  constructor(model, memory) {
    super(model, memory, 2, "move its start X, Y, Z in front of it");
  }

  record(settings, functions) {
    const recorded = this.model.recordings[settings.scenario];
    if (recorded) return this.memory.once("track", [settings.scenario], () => readTrack(recorded));
    return super.record(settings, functions);
  }

  placeOf(settings) {
    const { surface, A, b, X0, period, duration } = settings;
    return [surface, shapeOf(settings), A, b, X0, period, duration];
  }

  path(settings) {
    const known = { rows: [...settings.A.flat(), ...settings.b], varying: false };
    return { start: settings.X0, known, shape: shapeOf(settings) };
  }

  sampled({ truth }, { noise, dropout }, { shape, loss }) {
    const outputs = new Float64Array(shape.length);
    for (let k = 0; k < loss.length; k++) {
      const lost = k > 0 && loss[k] < dropout;
      for (let c = 0; c < 2; c++) {
        const error = errorOf(noise.kind, noise.size, shape[2 * k + c]);
        outputs[2 * k + c] = lost ? NaN : truth[3 * k + c] + error;
      }
    }
    return outputs;
  }

  /** The motion that a recording brings with it, or that settings say, with the surface's own numbers. */
  motion(settings) {
    const recorded = this.model.recordings[settings.scenario];
    if (!recorded) return { motion: constantMotion(settings), shape: shapeOf(settings) };
    const { times, rows } = recorded.motion;
    const columns = rows[0].map((_, p) => Float64Array.from(rows, (row) => row[p]));
    return { motion: { times, rows, columns }, shape: [] };
  }
}

/** The numbers of the surface's shape, as Python's offered.py keeps them. */
export function shapeOf({ surface, normal, xi }) {
  return { plane: normal, unified: [xi] }[surface] ?? [];
}

/** A motion that stays as it is, as a table of one row. */
export function constantMotion({ A, b }) {
  return { times: [0], rows: [[...A.flat(), ...b]] };
}

function readTrack(track) {
  const number = (value) => (value === null ? NaN : value);
  // A track may have y1 or y2 alone: what is missing stays a column of NaN that nothing measures.
  const both = track.samples.map((row) => ["y1", "y2"].map((name) => number(row[track.names.indexOf(name)] ?? null)));
  return {
    time: Float64Array.from(track.time),
    truth: track.truth && Float64Array.from(track.truth.flat()),
    outputs: Float64Array.from(both.flat()),
    leavesAt: null,
  };
}
