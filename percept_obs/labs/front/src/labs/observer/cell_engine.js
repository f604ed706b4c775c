// The engine of a map's cells: the same runs, of which nothing is kept but when they settle and how they end.

import { errorOfOne, settlingTime } from "../../engine/errors.js";
import { argumentsAt, startState } from "../../engine/runner.js";
import { Engine, NOWHERE } from "./engine.js";

export class CellEngine extends Engine {
  /** @type {{of: any[], inputs: any}} what was laid out last, and of what */
  laid = { of: [], inputs: null };

  geometry() {
    return NOWHERE;
  }

  /** No run is kept: two cells seldom have the same. */
  kept(_name, settings, make) {
    return make(settings);
  }

  /** Most cells share their recording, and all that is known besides. */
  layOut(result, lines, known, hold, exact, own) {
    const of = [result.outputs, result.measured, lines, known, hold, exact?.[0], own];
    if (!of.every((part, k) => part === this.laid.of[k]))
      this.laid = { of, inputs: super.layOut(result, lines, known, hold, exact, own) };
    return this.laid.inputs;
  }

  /**
   * As `follow` of any run, but errors are read from the last one back until one is outside of the tolerance.
   *
   * @returns {any} of a run, what a cell holds
   */
  follow(name, chosen, result, inputs, kernel, functions, asked) {
    if (functions.gap || !result.truth) return super.follow(name, chosen, result, inputs, kernel, functions, asked);
    const { width, time, truth, tolerance } = result;
    const { grid, steps, last, held, arriving, known: table } = inputs;
    const gains = Float64Array.from(kernel.gains, (gain) => chosen[gain]);
    const states = this.room(`states of ${name}`, grid.length * kernel.states);
    const resets = this.room("resets", grid.length);
    const start = startState(inputs, kernel, functions, gains, asked);
    const diverged = functions.run(start, steps, held, table.rows, arriving, gains, table.varying, states, resets);
    if (diverged >= 0) return { divergedAt: grid[diverged], settling: Infinity, error: [NaN] };
    const x = this.room("x", last.length + table.width + gains.length + kernel.states);
    const out = this.room("out", width);
    const fill = argumentsAt(inputs, kernel, states, gains, x);
    const errorAt = (k) => {
      fill(k);
      functions.estimate(x, out);
      return errorOfOne(truth[(k + 1) * width - 1], out[width - 1], out, 0, width);
    };
    const settling = settlingTime(time, errorAt, tolerance);
    return { divergedAt: null, settling, error: [errorAt(time.length - 1)] };
  }
}
