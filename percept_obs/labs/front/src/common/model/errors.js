// How far an estimate is from the truth, and since when it has settled.

/**
 * |estimated distance / true distance - 1| at each sample, from inverse distances, as OnePoint.relative_error():
 * infinite where the estimate is not in front of the camera, NaN where one of its coordinates is not finite.
 *
 * @param {ArrayLike<number>} right  the true inverse distances
 * @param {ArrayLike<number>} found  those of the estimate
 * @param {Float64Array} estimate    rows of `width` coordinates
 */
export function distanceError(right, found, estimate, width) {
  const error = new Float64Array(right.length);
  for (let k = 0; k < error.length; k++) {
    let sum = 0;
    for (let at = k * width; at < (k + 1) * width; at++) sum += estimate[at] - estimate[at];
    if (sum !== 0) error[k] = NaN;
    else error[k] = found[k] > 0 ? Math.abs(right[k] / found[k] - 1) : Infinity;
  }
  return error;
}

/** Whether an error has been in its tolerance for long enough, as a part of the run, to be sure of it. */
export function settled(settling, length, part) {
  return length - settling >= part * length;
}

/** When the error entered the tolerance for good, in seconds since the first sample. */
export function settlingTime(time, error, tolerance) {
  let inside = 0;
  for (let k = 0; k < error.length; k++) if (!(error[k] < tolerance)) inside = k + 1;
  if (inside === error.length) return Infinity;
  return inside === 0 ? 0 : time[inside] - time[0];
}
