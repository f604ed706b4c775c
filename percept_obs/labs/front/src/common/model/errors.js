// How far an estimate is from the truth, and since when it has settled.

/** Largest absolute error of the hidden coordinates at each sample. */
export function hiddenError(truth, estimate, width, hidden) {
  const error = new Float64Array(truth.length / width);
  for (let k = 0; k < error.length; k++) {
    let largest = 0;
    for (let i = 0; i < hidden.length; i++) {
      const size = Math.abs(truth[k * width + hidden[i]] - estimate[k * width + hidden[i]]);
      // Not Math.max alone: what is not a number must stay so.
      if (!(size <= largest)) largest = size;
    }
    error[k] = largest;
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
