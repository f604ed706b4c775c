// Share of an error that is due to noise: the same run without noise, and the difference of both.

import { columnOf, derived } from "../../engine/derived.js";

/** Parts into which a run is divided; over two of them each mean square is taken. */
const PARTS = 400;
/** Samples that a mean square needs at least. */
const FEWEST = 10;

/** True if a run's error is shown with its parts: one observer, samples with noise, a known truth. */
export function divides({ observers, noise, pictures, scenario }, { recordings }) {
  return observers.length === 1 && noise.size > 0 && pictures.includes("error") && !(scenario in recordings);
}

/** The settings of the same run without noise, and with nothing else to compute. */
export function withoutNoise(settings) {
  return { ...settings, noise: { ...settings.noise, size: 0 }, pictures: [], bound: [], kept: null };
}

/**
 * The relative error without noise, and the root mean square of what noise adds: the difference of both estimated
 * distances, over the true one.
 *
 * @param {any} shown  a result with one run
 * @param {any} quiet  the same without noise
 * @returns {import("../../types.js").Shares}
 */
export function sharesOf({ time, truth, width, runs: [run] }, quiet) {
  const [right, noisy, still] = [truth, run.estimate, quiet.runs[0].estimate].map((rows) =>
    columnOf(rows, width, width - 1),
  );
  const each = Math.max(FEWEST, Math.ceil(time.length / PARTS));
  const parts = Math.max(1, Math.floor(time.length / each) - 1);
  const [times, added] = [new Float64Array(parts), new Float64Array(parts)];
  for (let part = 0; part < parts; part++) {
    let [sum, count] = [0, 0];
    const end = Math.min((part + 2) * each, time.length);
    for (let k = part * each; k < end; k++) {
      if (!(noisy[k] > 0 && still[k] > 0)) continue;
      sum += (right[k] / noisy[k] - right[k] / still[k]) ** 2;
      count += 1;
    }
    times[part] = time[Math.min((part + 1) * each, time.length - 1)];
    added[part] = count ? Math.sqrt(sum / count) : NaN;
  }
  return { quiet: quiet.runs[0].error, time: times, added };
}

/** Error by noise in the second half, as the median of its mean squares; NaN where there is none. */
export function lateNoise({ added }) {
  const late = Array.from(added.subarray(Math.floor(added.length / 2))).filter(Number.isFinite).sort((a, b) => a - b);
  return late.length ? late[Math.floor(late.length / 2)] : NaN;
}

/** Change of the estimated inverse distance at each sample, less that of the true one, where it is known. */
export function stepOf({ truth, width }, { estimate }) {
  return derived(estimate, "step", () => {
    const [found, right] = [estimate, truth].map((rows) => rows && columnOf(rows, width, width - 1));
    return found.map((value, k) => (k ? value - found[k - 1] - (right ? right[k] - right[k - 1] : 0) : NaN));
  });
}

/** Measured output less its estimate. */
export function innovationOf({ outputs, sampled, width }, { estimate }, c) {
  const [seen, expected] = [columnOf(outputs, sampled, c), columnOf(estimate, width, c)];
  return derived(estimate, `innovation ${c}`, () => seen.map((value, k) => value - expected[k]));
}
