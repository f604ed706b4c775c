// How far an estimate is from the truth, and since when it has settled.

/**
 * |estimated distance / true distance - 1| at each sample, from inverse distances, as OnePoint.relative_error():
 * infinite where the estimate is not in front of the camera, NaN where there is none.
 */
export function distanceError(truth, estimate, width, inverseOf) {
  const error = new Float64Array(truth.length / width);
  for (let k = 0; k < error.length; k++) {
    const row = estimate.subarray(k * width, (k + 1) * width);
    const found = inverseOf(estimate, k);
    if (!row.every(Number.isFinite)) error[k] = NaN;
    else error[k] = found > 0 ? Math.abs(inverseOf(truth, k) / found - 1) : Infinity;
  }
  return error;
}

/** When the error entered the tolerance for good, in seconds since the first sample. */
export function settlingTime(time, error, tolerance) {
  let last = error.length - 1;
  if (!(error[last] < tolerance)) return Infinity;
  while (last >= 0 && error[last] < tolerance) last--;
  return last < 0 ? 0 : time[last + 1] - time[0];
}
