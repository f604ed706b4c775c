// @ts-check
// The geometry of a scene in the camera's X, Y, Z: how it is looked at, how much of it, and where a point comes to lie.

/** View of a scene when it opens: from the side and a little from above, so that depths do not hide each other. */
export const OPENING_LOOK = { turn: 0.95, tilt: 0.35 };

const STEEPEST = Math.PI / 2;

/**
 * Right, up and away of somebody who looks at the scene, as rows of X, Y, Z.  Neither turned nor tilted it is what the
 * image shows: y1 to the right, y2 upwards.  `turn` then goes around Y, and `tilt` lifts the eye.
 */
export function lookFrom({ turn, tilt }) {
  const [s, c, sine, cosine] = [Math.sin(turn), Math.cos(turn), Math.sin(tilt), Math.cos(tilt)];
  return [[c, 0, s], [-s * sine, cosine, c * sine], [-s * cosine, -sine, c * cosine]];
}

/** A look turned and tilted further, by no more than straight from above or below. */
export function turned({ turn, tilt }, across, upwards) {
  return { turn: turn + across, tilt: Math.min(Math.max(tilt + upwards, -STEEPEST), STEEPEST) };
}

/** The ray of a plain camera: through the image point in the plane at depth 1. */
export function straight(y1, y2, out) {
  out[0] = y1;
  out[1] = y2;
  out[2] = 1;
  return out;
}

/** Where a track's points are: its rays, reached as far as its distances say, at most about so many of the samples. */
export function positionsOf({ rows, width, first = 0, distances }, ray, [from, to], most = 300) {
  const every = Math.max(1, Math.ceil((to - from + 1) / most));
  const count = Math.floor((to - from) / every) + 1;
  const found = new Float64Array(3 * count);
  const out = new Float64Array(3);
  for (let j = 0; j < count; j++) {
    // The last sample is always there, so that a path ends where the point is.
    const k = j === count - 1 ? to : from + j * every;
    ray(rows[k * width + first], rows[k * width + first + 1], out);
    for (let i = 0; i < 3; i++) found[3 * j + i] = out[i] * distances[k];
  }
  return found;
}

/** Where a track's point is between two samples. */
export function positionAt(track, ray, { sample, part }) {
  const [x, y, z, ...next] = positionsOf(track, ray, [sample, sample + (part > 0 ? 1 : 0)], 2);
  if (!next.length) return [x, y, z];
  return [x, y, z].map((value, i) => value + part * (next[i] - value));
}

/** The smallest box with the camera and all the positions in it, those that are somewhere. */
export function boxAround(tracks) {
  const [low, high] = [[0, 0, 0], [0, 0, 0]];
  for (const positions of tracks) {
    for (let k = 0; k < positions.length; k++) {
      const value = positions[k];
      if (value < low[k % 3]) low[k % 3] = value;
      if (value > high[k % 3] && value < Infinity) high[k % 3] = value;
    }
  }
  return { low, high };
}

/** A ball around a box, in which the scene stays however it is turned. */
export function ballAround({ low, high }) {
  const centre = low.map((value, i) => (value + high[i]) / 2);
  return { centre, radius: Math.max(Math.hypot(...high.map((value, i) => value - low[i])) / 2, 1e-3) };
}

/** The ball that was shown before, if the one that is wanted lies in it and is not lost there. */
export function keptBall(before, wanted) {
  if (!before) return wanted;
  const apart = Math.hypot(...before.centre.map((value, i) => value - wanted.centre[i]));
  return apart + wanted.radius <= 1.3 * before.radius && wanted.radius > 0.4 * before.radius ? before : wanted;
}

/** Where points come to lie on a picture that shows a ball: functions of X, Y, Z, and pixels a metre. */
export function frameOf(look, { centre, radius }, { width, height, edge, zoom = 1 }) {
  const [right, up] = lookFrom(look);
  const scale = (zoom * (Math.min(width, height) / 2 - edge)) / radius;
  const along = (row, x, y, z) => row[0] * (x - centre[0]) + row[1] * (y - centre[1]) + row[2] * (z - centre[2]);
  return {
    scale,
    corners: [[0, 0], [width, height]],
    x: (x, y, z) => width / 2 + scale * along(right, x, y, z),
    y: (x, y, z) => height / 2 - scale * along(up, x, y, z),
  };
}

/**
 * Where a line leaves a box of low and high corners on the way to a place outside; null if it stays inside.
 *
 * @param {number[]} from
 * @param {number[]} to
 * @param {number[][]} corners
 * @returns {{at: [number, number], angle: number} | null}
 */
export function rimOf(from, to, corners) {
  const [[x0, y0], [x1, y1], [[left, top], [right, bottom]]] = [from, to, corners];
  const shares = [
    [x1 - x0, (x1 > x0 ? right : left) - x0],
    [y1 - y0, (y1 > y0 ? bottom : top) - y0],
  ].map(([way, room]) => (way === 0 ? Infinity : Math.max(room / way, 0)));
  const share = Math.min(...shares);
  return share < 1
    ? { at: [x0 + share * (x1 - x0), y0 + share * (y1 - y0)], angle: Math.atan2(y1 - y0, x1 - x0) }
    : null;
}

/**
 * The part of a line that lies in a box of low and high corners, or null.
 *
 * @param {number[]} from
 * @param {number[]} to
 * @param {number[][]} corners
 * @returns {[number, number, number, number] | null} where it begins and ends: x, y, x, y
 */
export function partIn([x0, y0], [x1, y1], [[left, top], [right, bottom]]) {
  const [across, down] = [x1 - x0, y1 - y0];
  let [first, last] = [0, 1];
  for (const [way, room] of [[-across, x0 - left], [across, right - x0], [-down, y0 - top], [down, bottom - y0]]) {
    if (way === 0 && room < 0) return null;
    if (way < 0) first = Math.max(first, room / way);
    if (way > 0) last = Math.min(last, room / way);
  }
  return first < last ? [x0 + first * across, y0 + first * down, x0 + last * across, y0 + last * down] : null;
}

/** The distances between which an inverse distance lies that is claimed to two standard deviations. */
export function claimedDistances(inverse, deviation) {
  const [low, high] = [inverse - 2 * deviation, inverse + 2 * deviation];
  return high > 0 ? [1 / high, low > 0 ? 1 / low : Infinity] : null;
}
