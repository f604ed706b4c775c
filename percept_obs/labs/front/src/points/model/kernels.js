// @ts-check
// The functions that settings need: a state's coefficients over time, and the place of a point that is seen.

import { PrintedKernels } from "../../common/model/kernels.js";
import { typedModule } from "../../common/model/typed.js";

/** The name of a state that somebody brought. */
export const OWN = "own";

/** All functions of a model; none follow after it has been opened. */
export class PointsKernels extends PrintedKernels {
  needed({ state, motion, weight, P }) {
    const { states, locate, point, written } = this.model;
    const [typed] = typedModule(this.model, motion);
    const coefficients = typed ? written?.[motion]?.states?.[state] : states[state].coefficients;
    const moved = { ...typed, key: typed ? `${state} ${typed.key}` : state, texts: { coefficients } };
    return [{ key: "points", texts: { locate, point } }, moved, ...(weight === "typed" ? typedModule(this.model, P) : [])];
  }
}
