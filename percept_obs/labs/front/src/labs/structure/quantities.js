// Unknown quantities and range from rows of ybar and theta, as StructureAndMotion.quantities().

import { columnOf, derived } from "../../engine/derived.js";
import { lastSamples } from "../../engine/tables.js";

/** An unknown quantity at the samples: NaN where no positive d_s follows. */
export function quantityOf(result, rows, name) {
  const { unknown, scaled } = result.choice;
  return derived(rows, name, () => {
    if (name === "d_s") return scales(result, rows);
    const i = unknown.indexOf(name);
    const values = columnOf(rows, result.width, 3 + i);
    if (!scaled[i]) return values;
    const scale = scales(result, rows);
    return values.map((value, k) => value / scale[k]);
  });
}

/** The range at the samples: NaN where there is no estimate, or none that is positive. */
export function rangeOf(result, rows) {
  return derived(rows, "range", () => {
    const [ybar3, theta] = [2, result.choice ? 3 : 2].map((c) => columnOf(rows, result.width, c));
    const scale = scales(result, rows);
    const range = new Float64Array(scale.length);
    for (let k = 0; k < range.length; k++) {
      const inverse = scale[k] * ybar3[k];
      range[k] = inverse > 0 && !Number.isNaN(theta[k]) ? 1 / inverse : NaN;
    }
    return range;
  });
}

/** d_s at the samples, estimated or known. */
function scales({ choice, scale, width, time }, rows) {
  const at = choice?.unknown.indexOf("d_s") ?? -1;
  return derived(rows, "d_s", () => {
    if (at < 0) return new Float64Array(time.length).fill(scale);
    return columnOf(rows, width, 3 + at).map((value) => (value > 0 ? value : NaN));
  });
}

/** The largest difference of a sample and its estimate. */
export function innovationOf({ outputs, width }, { estimate }) {
  return derived(estimate, "innovation", () => {
    const pairs = [0, 1, 2].map((c) => [lastSamples(columnOf(outputs, 3, c)), columnOf(estimate, width, c)]);
    return pairs[0][0].map((_, k) =>
      pairs.reduce((most, [last, found]) => Math.max(most, Math.abs(last[k] - found[k])), 0),
    );
  });
}
