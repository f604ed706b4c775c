// @ts-check
// The functions that settings need: a state's coefficients over time, and the place of a point that is seen.

import { PrintedKernels } from "../../common/model/kernels.js";

/** All functions of a model; none follow after it has been opened. */
export class PointsKernels extends PrintedKernels {
  needed({ state }) {
    const { states, locate, point } = this.model;
    return [{ key: state, texts: { coefficients: states[state].coefficients, locate, point } }];
  }
}
