// Why it happened, and the pictures in words.

import { readable, short } from "../../draw/scales.js";
import { filled } from "../../state/texts.js";
import { leavingInWords } from "../../ui/words.js";
import { quantityOf } from "./quantities.js";

const ONE_GAIN = ["identifier_based", "de_luca"];

export function reasons(shown, model) {
  if (shown.problem) return [shown.problem];
  if (shown.refusal)
    return ["The charts show what is measured. It cannot tell the unknowns apart, so nothing is estimated."];
  const { settings, choice } = shown;
  const found = shown.limits.map(({ name, time, rate, step, remedy, shorter }) => {
    const numbers = { time: short(time), rate: short(rate, 4), step: short(step), shorter: short(shorter, 2) };
    const values = { ...numbers, limit: short(model.largestStepRate, 6), remedy, name: "integral sliding mode" };
    return `${model.observers[name].title}: ${filled(model.tooLong, values)}.`;
  });
  found.push(...leavingInWords(shown));
  for (const run of shown.runs) if (run.divergedAt === null) found.push(endOf(run, shown));
  if (choice.unknown.includes("d_s") && settings.noise.size + settings.noise.depth > 0) {
    const { sizes, determinants } = shown.guard;
    const most = sizes.reduce((largest, size, k) => Math.max(largest, size / Math.abs(determinants[k])), 0);
    found.push(`Dividing by Ωg makes an error of the rate up to ${readable(most, 2)} times larger, about 1/ȳ3² ` +
      `times, and noise with it.`);
  }
  if (choice.unknown.includes("d_s") && shown.runs.some(({ name }) => ONE_GAIN.includes(name))) {
    found.push("The identifier-based observer and De Luca's have one gain for all unknowns. But the columns of Ωg " +
      "differ in size by a factor of ȳ3: with the gain that fits the others, d_s hardly moves.");
  }
  if (settings.bias !== 0 || settings.drift !== 0) {
    found.push("ȳ3 is measured with a bias or a drift, which no observer can know: it becomes an error of the " +
      "unknowns.");
  }
  if (settings.hold === "zero" && settings.period >= 1e-3) {
    found.push("The last sample is held: until the next one the innovation grows, and that shifts what ISMO finds.");
  }
  return found;
}

function endOf(run, shown) {
  const parts = shown.choice.unknown.map((name) => {
    const [found, right] = [run.estimate, shown.truth].map((rows) => plain(quantityOf(shown, rows, name).at(-1)));
    return `${name} = ${found} (true ${right})`;
  });
  return `${run.title} ends with ${parts.join(", ")}.`;
}

/** A quantity to a micrometre a second, so that what is nothing reads as nothing. */
function plain(value) {
  return readable(Number(value.toFixed(6)), 4);
}
