// Verdicts and their reasons in words. Those of verdicts come from Python, so that both say the same.

import { derived } from "../../engine/derived.js";
import { readable, short } from "../../draw/scales.js";
import { filled } from "../../state/texts.js";
import { divergedInWords, settledInWords } from "../../ui/words.js";
import { inWords, mainly } from "./directions.js";
import { eigen } from "./symmetric.js";

const MOST_ABSENCES = 3;
/** Rates below this, per second, are those of rounding. */
const NO_RATE = 1e-9;

/** Verdict on the error, as PointsRun.verdict() in Python. */
export function verdict({ time, worst, settling, divergedAt }, model) {
  const { judged, tolerance } = model;
  if (divergedAt !== null) return divergedInWords(short(divergedAt - time[0]), model);
  const error = { judged, error: worst.at(-1), tolerance };
  return settledInWords(error, settling, time.at(-1) - time[0], model);
}

/** Sentence on the decay of the error, and on the guaranteed rate. */
export function decayInWords({ fit }, bound) {
  if (!fit) return "no rate can be fitted to the last two thirds of the run";
  const measured = `${readable(Math.abs(fit.rate) < NO_RATE ? 0 : fit.rate, 2)} per second, fitted from ` +
    `${readable(fit.begin)} s on`;
  return bound === null ? measured : `${measured}; at least ${readable(bound, 2)} is guaranteed`;
}

/** Verdict on condition (14), as Gramian.verdict() in Python. */
function gramianInWords(shown, { verdicts, unseen }) {
  const { gramian, names, truth, n } = shown;
  const { weakest, window } = gramian;
  const found = derived(gramian.matrix, "eigen", () => eigen(gramian.matrix, n));
  const largest = Math.max(found.at(-1).value, 1e-300);
  const lost = found.filter(({ value }) => value <= unseen * largest).map(({ vector }) => vector);
  const words = {
    window: short(window, 6),
    begin: short(shown.time[weakest]),
    least: short(Math.min(...gramian.smallest)),
  };
  if (!lost.length) return filled(verdicts.holds, { ...words, direction: mainly(found[0].vector, names) });
  const directions = inWords(lost, names);
  const one = directions.length === 1;
  const text = filled(verdicts[one ? "one fails" : "several fail"], {
    ...words,
    count: directions.length,
    directions: directions.join("; "),
  });
  const state = truth.subarray(weakest * n, weakest * n + n);
  const size = Math.hypot(...state) || 1e-300;
  const along = Math.hypot(
    ...lost.map((vector) => vector.reduce((sum, value, i) => sum + (value * state[i]) / size, 0)),
  );
  return along > 1 - 1e-4 ? text + verdicts[one ? "the scale" : "the scale too"] : text;
}

export function reasons(shown, model) {
  const { settings } = shown;
  const found = [`${gramianInWords(shown, model)}.`, ...absencesInWords(shown)];
  if (settings.noise.size > 0 && settings.hold === "exact") {
    found.push('Between samples the observer takes the exact signal, which has no noise. Choose "the last sample" ' +
      'for Hold to see what noise does.');
  }
  if (settings.input === 0 && settings.camera_velocity.every((v) => v === 0)) {
    found.push("There is no input, v = 0. Then twice all places move to twice all places, and the images stay the " +
      "same: they never tell the scale.");
  }
  return found;
}

/** When points were not seen for half a second or longer, and what became of them meanwhile. */
function absencesInWords({ time, absences, errors, settings }) {
  return absences.flatMap((spans, k) => {
    const name = `Point ${k + 1}`;
    const long = spans.filter(({ begin, end }) => end - begin > 0.5);
    if (long.some(({ first, last }) => first === 0 && last === time.length - 1)) return [`${name} is never seen.`];
    const asked = settings.hidden[k];
    return long.slice(0, MOST_ABSENCES).map(({ first, last, begin, end }) => {
      const hidden = asked && begin >= asked[0] - 1e-9 && begin < asked[1];
      const where = hidden ? "hidden" : "out of view or behind the camera";
      const [before, after] = [errors[k][first], errors[k][last]];
      const change = after < 0.9 * before ? "shrank" : after > 1.1 * before ? "grew" : null;
      const sizes = change ? `${change} from ${readable(before, 2)} to` : "stayed about";
      const error = Number.isNaN(after) ? "" : `; its error ${sizes} ${readable(after, 2)} m meanwhile`;
      return `${name} was ${where} from ${readable(begin)} to ${readable(end)} s${error}.`;
    });
  });
}

export function summaryOf(shown, serial, model) {
  const number = (value) => (Number.isFinite(value) ? value : null);
  return {
    serial,
    samples: shown.time.length,
    verdict: verdict(shown, model),
    gramian: gramianInWords(shown, model),
    rate: shown.fit ? number(shown.fit.rate) : null,
    final: Array.from(shown.estimate.subarray(-shown.n), number),
  };
}
