// Camera of a moving object: image and scaled inverse depth are sampled, as record() in Python.

import { errorOf, PointCamera } from "../../engine/camera.js";
import { sampledAt } from "../../engine/derived.js";
import { instants } from "../../engine/tables.js";
import { breaksOf, isTyped } from "../../engine/typed.js";

/** True if the velocities are the user's samples. */
export function isSampled({ velocities }) {
  return velocities === "samples";
}

/** True if a velocity swings or is typed. */
export function varies(settings) {
  return isTyped(settings) || swings(settings);
}

function swings({ rate, v_c_swing, v_p_swing }) {
  return rate !== 0 && [...v_c_swing, ...v_p_swing].some((value) => value !== 0);
}

export class StructureCamera extends PointCamera {
  constructor(model, memory) {
    super(model, memory, 3, "make its start ȳ3 positive");
  }

  kinks(settings) {
    return isSampled(settings) ? this.model.samples.times : breaksOf(this.model, settings.motion);
  }

  /** Known and unknown velocities at some times, in rows of w_c, v_c, v_p; one row if they do not change. */
  velocities(settings, { swinging, typed }, times) {
    if (isSampled(settings)) return sampledAt(this.model.samples, times);
    const { w_c, v_c, v_p, v_c_swing, v_p_swing, rate } = settings;
    const { phases } = this.model;
    const [constant, swing, phase] = [[...v_c, ...v_p], [...v_c_swing, ...v_p_swing], [...phases.v_c, ...phases.v_p]];
    const varying = varies(settings);
    const count = varying ? times.length : 1;
    const rows = new Float64Array(9 * count);
    const x = new Float64Array(5);
    const out = new Float64Array(1);
    const given = new Float64Array(10);
    const moved = new Float64Array(9);
    for (let k = 0; k < count; k++) {
      rows.set(w_c, 9 * k);
      for (let i = 0; i < 6; i++) {
        x[0] = constant[i];
        x[1] = swing[i];
        x[2] = rate;
        x[3] = phase[i];
        x[4] = varying ? times[k] : 0;
        rows[9 * k + 3 + i] = swinging(x, out)[0];
      }
      if (!typed) continue;
      given[0] = times[k];
      given.set(rows.subarray(9 * k, 9 * k + 9), 1);
      typed(given, moved);
      typed.columns.forEach((column, c) => (rows[9 * k + column] = moved[c]));
    }
    return { rows, varying };
  }

  path(settings, functions, lines) {
    const { ybar, scale } = settings;
    const depth = 1 / (scale * ybar[2]);
    const make = (read) => this.velocities(read, functions, instants(lines.grid));
    const known = this.memory.once("velocities", settings, make, lines.grid);
    return { start: [ybar[0] * depth, ybar[1] * depth, depth], known, shape: [] };
  }

  /** As of any point, but with an inverse depth that is scaled. */
  look(settings, functions, lines, found) {
    const inFront = super.look(settings, functions, lines, found);
    const { scale } = settings;
    for (let k = 2; k < found.length; k += 3) found[k] /= scale;
    return inFront;
  }

  sampled({ time, truth }, { noise: { kind, size, depth }, bias, drift }, { shape }) {
    const count = time.length;
    const outputs = new Float64Array(3 * count);
    for (let k = 0; k < count; k++) {
      outputs[3 * k] = truth[3 * k] + errorOf(kind, size, shape[2 * k]);
      outputs[3 * k + 1] = truth[3 * k + 1] + errorOf(kind, size, shape[2 * k + 1]);
      const error = errorOf(kind, depth, shape[2 * count + k]);
      outputs[3 * k + 2] = truth[3 * k + 2] + bias + drift * time[k] + error;
    }
    return outputs;
  }
}
