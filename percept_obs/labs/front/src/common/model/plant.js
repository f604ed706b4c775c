// @ts-check
// A point in motion, and where a camera sees it.

const NOTHING = new Float64Array(0);

/** Positions at a clock's times, from time 0 on, of a point that moves by a motion's known rows. */
export function move(start, run, { rows, varying }, { index, steps }, room) {
  const states = room("plant states", 3 * steps.length + 3);
  const resets = room("plant resets", steps.length + 1);
  const diverged = run(start, steps, NOTHING, rows, NOTHING, NOTHING, varying, states, resets);
  if (diverged >= 0) states.fill(NaN, 3 * diverged);
  const points = room("points", 3 * index.length - 3);
  for (let k = 1; k < index.length; k++) {
    for (let c = 0; c < 3; c++) points[3 * k - 3 + c] = states[3 * index[k] + c];
  }
  return points;
}

/** Fill in coordinates of points, the last one inverse; how many are in front of the camera from the first on. */
export function project(points, projection, shape, found) {
  const samples = points.length / 3;
  const x = new Float64Array(3 + shape.length);
  const out = new Float64Array(3);
  x.set(shape, 3);
  let count = samples;
  for (let k = 0; k < samples; k++) {
    for (let c = 0; c < 3; c++) x[c] = points[3 * k + c];
    projection(x, out);
    const distance = out[2];
    if (k < count && !(distance > 0 && distance < Infinity)) count = k;
    found[3 * k] = out[0];
    found[3 * k + 1] = out[1];
    found[3 * k + 2] = 1 / distance;
  }
  return count;
}
