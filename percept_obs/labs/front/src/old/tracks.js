// @ts-check
// Where a point is and where observers think it is, as a scene shows it: image coordinates and distances at the
// samples.

/**
 * @typedef {object} Track
 * @property {Float64Array} rows     rows of `width` numbers, with y1, y2 from `first` on
 * @property {number} width
 * @property {number} [first]
 * @property {ArrayLike<number>} distances  at the samples; NaN where there is none
 * @property {ArrayLike<number>} [inverse]  of an estimate: its inverse distances, and the deviations that it claims
 * @property {ArrayLike<number> | null} [deviation]
 * @property {string} [colour]
 * @property {number[]} [dash]
 * @property {Track | {} | null} [of]  of an estimate: the true track
 * @property {boolean} [kept]
 * @property {number[]} [range]    the first and the last sample of the path that is drawn
 */

/**
 * The tracks of one point: of its truth, where that is known, of each observer, and of those of a kept run.
 *
 * @param {(result: any, rows: Float64Array, run: any) => {distances: any, inverse?: any, deviation?: any}} distancesOf
 * @returns {Track[]}
 */
export function tracksOfPoint(shown, ghost, distancesOf, lookOf) {
  const track = (result, rows, run) => ({ rows, width: result.width, ...distancesOf(result, rows, run) });
  const truth = shown.truth?.length ? { ...track(shown, shown.truth, null), ...lookOf(null) } : null;
  const kept = ghost?.runs.map((run) => ({ ...track(ghost, run.estimate, run), of: {}, kept: true })) ?? [];
  const estimates = shown.runs.map((run) => ({
    ...track(shown, run.estimate, run),
    ...lookOf(run.order),
    of: truth ?? {},
  }));
  return [...(truth ? [truth] : []), ...kept, ...estimates];
}
