// @ts-check
// The functions that settings need: a state's coefficients over time, the place of a point that is seen, and P's rates.

import { derived } from "../../engine/derived.js";
import { PrintedKernels } from "../../engine/kernels.js";
import { typedModule } from "../../engine/typed.js";
import { textsOfP, textsOfX } from "./sparse.js";
import { isComputed, textOfP } from "./weight.js";

/** The name of a user's state. */
export const OWN = "own";

/** The layout of what is followed together: points that share nothing unknown are followed one by one. */
export function layoutFollowed(model, settings) {
  const { state, points } = settings;
  const together = state === "independent" ? 1 : points.length;
  return model.states[state].layouts[together - 1];
}

/** All functions of a model; none follow after it has been opened. */
export class PointsKernels extends PrintedKernels {
  needed(settings) {
    const { states, locate, point, written } = this.model;
    const { state, motion } = settings;
    const [typed] = typedModule(this.model, motion);
    const coefficients = typed ? written?.[motion]?.states?.[state] : states[state].coefficients;
    const moved = { ...typed, key: typed ? `${state} ${typed.key}` : state, texts: { coefficients } };
    return [
      { key: "points", texts: { locate, point } },
      moved,
      ...this.rates(settings),
      ...typedModule(this.model, textOfP(settings)),
    ];
  }

  /** The rates of what is followed together, and those of a P that is computed. */
  rates(settings) {
    const layout = layoutFollowed(this.model, settings);
    const n = layout.names.length;
    const printed = (name, textsOf) => ({
      key: `${name} of ${n} states, ${settings.state}`,
      texts: derived(layout, `texts of ${name}`, () => textsOf(layout, n)),
    });
    return [printed("x", textsOfX), ...(isComputed(settings) ? [printed("P", textsOfP)] : [])];
  }
}
