// Where the points of a state are at a time, and how fast they would move if all of the state were nearer or farther.

import { valueBetween } from "../../engine/between.js";
import { coefficientsAt } from "./camera.js";
import { kindsOf, placed } from "./flow.js";

/** Position of each point, and velocity of a copy so many times as far under the same A(t) and v(t). */
export function motionAt(lab, shown, at) {
  const { settings, n, points, truth, time } = shown;
  const layout = lab.model.states[settings.state].layouts[points - 1];
  const known = coefficientsAt(lab.model, settings, lab.kernels.of(settings), [valueBetween(time, 1, 0, at)]);
  const { kinds, kindOf } = kindsOf(layout, n);
  const state = Array.from({ length: n }, (_, i) => valueBetween(truth, n, i, at));
  const [linear, constant] = [new Float64Array(n), new Float64Array(n)];
  for (let vector = 0; vector < n / 3; vector++) {
    for (const [entry, index] of kinds[kindOf[vector]]) {
      const [row, column] = [3 * vector + ((entry / 4) | 0), entry % 4];
      if (column === 3) constant[row] += known[index];
      else linear[row] += known[index] * state[3 * vector + column];
    }
  }
  const pointOf = (values, k) => placed(layout, values, 0, k, [0, 0, 0]);
  return (k) => {
    const [moved, pushed] = [pointOf(linear, k), pointOf(constant, k)];
    const velocityAt = (_, part) => moved.map((value, i) => part * value + pushed[i]);
    return { place: pointOf(state, k), velocityAt };
  };
}
