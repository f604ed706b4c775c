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

/** By how much a copy grows at most; it stays in the scene. */
const LARGEST = 1.3;

/** Copies of places, all lengths larger or smaller by a swing between -1 and 1: no image moves. */
export function scaled(places, amount) {
  const size = LARGEST ** amount;
  return places.map(({ place, ...more }) => ({ ...more, place: place.map((value) => size * value) }));
}

/**
 * The step in a hidden image coordinate and the inverse distance that w does not tell, of a size that can be seen,
 * within a reach of the image.
 */
export function unseenDirection([other, inverse], atInverse, reach = 0.5) {
  const [first, second] = other === 0 && inverse === 0 ? [0, 1] : [-inverse, other];
  const size = Math.min((0.5 * Math.abs(atInverse)) / Math.abs(second), Math.min(reach, 0.5) / Math.abs(first));
  return [size * first, size * second];
}

/** A x + v for a matrix in rows. */
export function affine(A, v, x) {
  return A.map((row, i) => row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + v[i]);
}

/** The mean speed of an image in rows of y1, y2 from one sample to another. */
export function meanSpeed(time, rows, width, first, [from, to]) {
  const every = Math.max(1, Math.floor((to - from) / 60));
  let [way, last] = [0, from];
  for (let k = from + every; k <= to; k += every) {
    const step = Math.hypot(...[0, 1].map((c) => rows[k * width + first + c] - rows[last * width + first + c]));
    if (step > 0) way += step;
    last = k;
  }
  return last > from ? way / (time[last] - time[from]) : 0;
}
