// @ts-check
// The functions that settings need: a state's coefficients over time, the place of a point that is seen, and P's rates.

import { derived } from "../../common/model/derived.js";
import { PrintedKernels } from "../../common/model/kernels.js";
import { textsOfP } from "./sparse.js";

/** Kinds of a P that is computed as the observer goes. */
const COMPUTED = ["lyapunov", "riccati"];

/** The layout of what is followed together: points that share nothing unknown are followed one by one. */
export function layoutFollowed({ states }, { state, points }) {
  const together = state === "independent" ? 1 : points.length;
  return states[state].layouts[together - 1];
}

/** All functions of a model; none follow after it has been opened. */
export class PointsKernels extends PrintedKernels {
  needed(settings) {
    const { states, locate, point } = this.model;
    const { state, weight } = settings;
    const own = { key: state, texts: { coefficients: states[state].coefficients, locate, point } };
    if (!COMPUTED.includes(weight)) return [own];
    const layout = layoutFollowed(this.model, settings);
    const n = layout.names.length;
    return [own, { key: `P of ${n} states, ${state}`, texts: derived(layout, "texts of P", () => textsOfP(layout, n)) }];
  }
}
