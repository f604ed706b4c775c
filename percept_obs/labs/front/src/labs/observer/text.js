// Why it happened, in words.

import { readable } from "../../draw/scales.js";
import { leavingInWords, percent } from "../../ui/words.js";
import { noBound } from "./bound.js";
import { varies } from "./camera.js";

const UNEXCITED = 1e-4;

export function reasons(shown, model) {
  const { settings, measured, names, hiddenNames } = shown;
  if (shown.problem) return [shown.problem];
  const found = leavingInWords(shown);
  const least = leastOf(shown.excitation);
  if (least) {
    const over = `in any ${readable(shown.excitation.window)} s`;
    const value = `smallest eigenvalue of ∫ w wᵀ: ${readable(least.value, 2)}`;
    const hidden = hiddenNames.join(" and ");
    found.push(
      least.value < UNEXCITED
        ? `Until ${readable(least.time)} s, w alone shows next to nothing of one direction of ${hidden} (${value}). ` +
            "The motion may show it all the same."
        : `The image moves with ${hidden} ${over} (${value} or more).`,
    );
  }
  if (measured.length < hiddenNames.length) {
    const only = names[measured[0]];
    found.push(`Only ${only} is measured: one instant never tells both hidden coordinates, some seconds may.`);
  }
  if (shown.foeTowards) {
    found.push("The focus of expansion is at infinity: the translation is parallel to the image.");
  }
  const constant = !varies(settings, model);
  if (!constant && !(settings.scenario in model.recordings)) {
    found.push(
      "The motion varies over time, and so the focus of expansion moves: it is drawn where it is at the time shown.",
    );
  }
  if (constant && settings.b.every((value) => value === 0)) {
    found.push("Nothing translates, b = 0: there is no focus of expansion, and images do not tell any distance.");
  }
  const nearest = nearestToFoe(shown);
  if (nearest && shown.circle && nearest.distance < Math.abs(shown.circle[2])) {
    found.push(
      `At ${readable(nearest.time)} s the image of the point is within the circle about the focus of expansion, ` +
        "where an instant tells almost nothing of the distance.",
    );
  }
  if (settings.believed) found.push("The observers believe another motion than the true one.");
  if (settings.noise.size > 0) found.push(NOISY);
  found.push(...boundInWords(shown, model));
  const biased = shown.runs.some((run) => settings.gains[run.name].noise_variance === 0);
  if (settings.noise.size > 0 && measured.length === 1 && biased) {
    found.push("The same noise is in w and in the innovation: their product has a mean, which pushes the estimate.");
  }
  return found;
}

const NOISY =
  "Every innovation carries the noise of its sample, and gains multiply it: more gain is faster, and noisier.";

/** Sentence on the bound. */
function boundInWords({ settings, bound }, model) {
  if (!bound) return settings.noise.size > 0 ? [noBound(settings, model)].filter(Boolean) : [];
  const left = Number.isFinite(bound.at(-1)) ? ` At the end it is ${percent(bound.at(-1), 2)} of the distance.` : "";
  const uniform = settings.noise.kind === "uniform" ? " It is that of Gaussian noise of the same variance." : "";
  return ["The dotted line of the error chart is the bound: no unbiased observer has a smaller root mean square " +
    `error; one run alone may be below it at times.${left}${uniform}`];
}

function leastOf({ time, smallest }) {
  if (!smallest.length) return null;
  const at = smallest.reduce((best, value, k) => (value < smallest[best] ? k : best), 0);
  return { value: Math.max(smallest[at], 0), time: time[at] };
}

function nearestToFoe({ foe, truth, width, time }) {
  if (!foe || !truth?.length) return null;
  const apart = time.map((_, k) => Math.hypot(truth[k * width] - foe[0], truth[k * width + 1] - foe[1]));
  const distance = apart.reduce((least, value) => Math.min(least, value));
  return { distance, time: time[apart.indexOf(distance)] };
}
