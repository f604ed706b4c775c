// The functions that settings need: a state's coefficients over time, and the place of a point that is seen.

import { Modules } from "../common/modules.js";

export class Functions {
  constructor(model, load) {
    this.model = model;
    this.modules = new Modules(load);
  }

  /** The functions of these settings, or undefined while they are not loaded. */
  of({ state }) {
    return this.modules.get(state);
  }

  prepare({ state }) {
    const { states, locate } = this.model;
    return this.modules.prepare(state, { coefficients: states[state].coefficients, locate });
  }
}
