// @ts-check
// Velocities in the image: of a point, and of copies at other distances on its ray; where they differ, distance shows.

/** Distances of the copies, as parts of the point's own: nearer, where it is, farther. */
export const COPIES = [0.5, 1, 2];

/** A step that is small beside a point's distance, whose error and rounding are about as large. */
const SMALL = 1e-6;

/**
 * The image velocities of a point and of copies nearer and farther on its ray, by central differences.
 *
 * @param {number[]} place  of the point, in metres
 * @param {(place: number[], part: number) => number[]} velocityAt  of a copy that is there, in m/s
 * @param {(place: number[]) => ArrayLike<number>} project  whose first two numbers are y1, y2
 */
export function imageVelocities(place, velocityAt, project) {
  return COPIES.map((part) => {
    const copy = place.map((value) => part * value);
    const velocity = velocityAt(copy, part);
    const speed = Math.hypot(...velocity);
    if (!(speed > 0)) return speed === 0 ? [0, 0] : [NaN, NaN];
    const step = (SMALL * Math.hypot(...copy)) / speed;
    const [after, before] = [step, -step].map((h) => {
      const [y1, y2] = Array.from(project(copy.map((value, i) => value + h * velocity[i])));
      return [y1, y2];
    });
    return [0, 1].map((c) => (after[c] - before[c]) / (2 * step));
  });
}

/** A x + v for a matrix in rows. */
export function affine(A, v, x) {
  return A.map((row, i) => row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + v[i]);
}
