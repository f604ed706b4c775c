// The bound over the image, as percept_obs/observability/maps.py computes it and says what it means.

/**
 * Least relative standard deviation of the distance of points, NaN where one comes behind the camera on the way.
 *
 * @param {Record<"begin" | "gather" | "finish", (x: Float64Array, out: Float64Array) => Float64Array>} kernel
 *   The printed functions of a surface and its measured outputs.
 * @param {object} given
 * @param {ArrayLike<number>} given.points Where the points begin, three numbers each.
 * @param {ArrayLike<number>} given.Phi Nine numbers for each sample: X = Phi X0 + moved.
 * @param {ArrayLike<number>} given.moved Three numbers for each sample.
 * @param {number} given.noiseVariance
 * @param {number} given.hiddenVariance
 * @param {ArrayLike<number>} [given.shape] What shapes the surface.
 * @returns {Float64Array} One number a point.
 */
export function boundMap({ begin, gather, finish }, given) {
  const { points, Phi, moved, noiseVariance, hiddenVariance, shape = [] } = given;
  const samples = moved.length / 3;
  const J = 6; // entries of the information, on and above its diagonal
  const whole = new Float64Array(J + 15 + shape.length);
  const place = whole.subarray(J);
  const start = new Float64Array(3 + shape.length);
  place.set(shape, 15);
  start.set(shape, 3);
  const share = new Float64Array(J + 1);
  const last = new Float64Array(1);
  const found = new Float64Array(points.length / 3);
  for (let i = 0; i < found.length; i++) {
    for (let j = 0; j < 3; j++) start[j] = place[12 + j] = points[3 * i + j];
    begin(start, share);
    for (let j = 0; j < J; j++) whole[j] = share[j] / hiddenVariance;
    let seen = true;
    for (let k = 0; k < samples && seen; k++) {
      for (let j = 0; j < 9; j++) place[j] = Phi[9 * k + j];
      for (let j = 0; j < 3; j++) place[9 + j] = moved[3 * k + j];
      gather(place, share);
      for (let j = 0; j < J; j++) whole[j] += share[j] / noiseVariance;
      seen = share[J] > 0;
    }
    found[i] = seen ? finish(whole, last)[0] : NaN;
  }
  return found;
}
