// Relative errors of estimates, and settling times.

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
  for (let k = 0; k < error.length; k++) error[k] = errorOfOne(right[k], found[k], estimate, k * width, width);
  return error;
}

/** Relative error of one estimate, whose coordinates begin at a place. */
function errorOfOne(right, found, estimate, begin, width) {
  let sum = 0;
  for (let at = begin; at < begin + width; at++) sum += estimate[at] - estimate[at];
  if (sum !== 0) return NaN;
  return found > 0 ? Math.abs(right / found - 1) : Infinity;
}

/** True if an error has been in its tolerance for a large enough part of the run. */
export function settled(settling, length, part) {
  return length - settling >= part * length;
}

/** Seconds until errors, which are read from the last one back, entered the tolerance for good. */
export function settlingTime(time, errorAt, tolerance) {
  let inside = time.length;
  while (inside > 0 && errorAt(inside - 1) < tolerance) inside--;
  if (inside === time.length) return Infinity;
  return inside === 0 ? 0 : time[inside] - time[0];
}

/** The distances between which an inverse distance lies that is claimed to two standard deviations. */
export function claimedDistances(inverse, deviation) {
  const [low, high] = [inverse - 2 * deviation, inverse + 2 * deviation];
  return high > 0 ? [1 / high, low > 0 ? 1 / low : Infinity] : null;
}
