// @ts-check
// The loop over points and steps, as in points/kernel.py: the same layouts, the same numbers.

import { LARGEST_SQUARED_STATE } from "../../engine/integrator.js";
import { stepper } from "../../engine/runge_kutta.js";
import { derived } from "../../engine/derived.js";
import { EACH } from "../../engine/tables.js";
import { entriesOf } from "./sparse.js";

/**
 * Step an estimate, and P where it is computed, by the Runge-Kutta method.
 *
 * layout    where the coefficients stand: rows, columns, which; begins, axes, states, entries of the points
 * functions point: what one point tells, printed from its block; those of sparse.js, printed for the layout
 * law       {computed, information, forgetting, pull} of P
 * x, P      at the start, P with no more entries than `entriesOf` finds; it is null where it is given
 * tables    {steps, coefficients, width, inverses, images, points, first}: coefficients have a row of `width` numbers
 * for each instant of a step, whose end is the next one's start; inverses {entries, constant, rows} of a given P
 *           have a diagonal for each instant likewise, or one if it is constant; images have a row for each instant of
 *           each step, of all `points`, of which the layout's begin with `first`
 * path      takes the estimates
 * Returns the first row of the path at which the estimate was no longer finite, or -1; P holds its last value.
 */
export function advance(layout, functions, law, x, P, tables, path) {
  const { steps, coefficients, width, inverses, images, points, first } = tables;
  const n = x.length;
  const { pairs } = entriesOfP(layout, n);
  const now = new Float64Array(law.computed ? n + pairs.length : n);
  now.set(x);
  for (let k = n; k < now.length; k++) now[k] = P[pairs[k - n][0] * n + pairs[k - n][1]];
  const rate = rateOf(layout, functions, law, inverses, n);
  const step = stepper(now.length);
  path.set(x);
  let failed = -1;
  for (let k = 0; k < steps.length && failed < 0; k++) {
    step(now, steps[k], (instant, stage, out) => {
      const row = EACH * k + instant;
      const inverse = inverses.constant ? 0 : row * inverses.entries;
      const at = (((EACH + 1) * k + instant) * points + first) * 2;
      rate(stage, inverse, coefficients, row * width, images, at, out);
    });
    let squared = 0;
    for (let i = 0; i < n; i++) squared += (path[(k + 1) * n + i] = now[i]) ** 2;
    if (!(squared < LARGEST_SQUARED_STATE)) failed = k + 1;
  }
  for (let k = n; k < now.length; k++) {
    const [i, j] = pairs[k - n];
    P[i * n + j] = P[j * n + i] = now[k];
  }
  return failed;
}

function entriesOfP(layout, n) {
  return derived(layout, "entries of P", () => entriesOf(layout, n));
}

/** A function that fills the rates of an estimate and, behind it, of P's entries. */
function rateOf(layout, functions, { computed, information, forgetting, pull }, { entries, rows }, n) {
  const { point, moveX, place, correct, moveP, solveP } = functions;
  const points = layout.begins.length - 1;
  const correction = new Float64Array(n);
  const places = new Float64Array(3 * points);
  const given = new Float64Array(5);
  const told = new Float64Array(12 * points);
  const toldOf = Array.from({ length: points }, (_, k) => told.subarray(12 * k, 12 * k + 12));
  const constant = Float64Array.from(entriesOfP(layout, n).pairs, ([i, j]) => (computed ? pull[i * n + j] : 0));
  return (now, inverse, known, offset, images, at, out) => {
    moveX(now, known, offset, out);
    place(now, places);
    let anything = false;
    for (let k = 0; k < points; k++) {
      given[0] = images[at + 2 * k];
      given[1] = images[at + 2 * k + 1];
      if (Number.isNaN(given[0] + given[1])) {
        toldOf[k].fill(0);
        continue;
      }
      anything = true;
      given[2] = places[3 * k];
      given[3] = places[3 * k + 1];
      given[4] = places[3 * k + 2];
      point(given, toldOf[k]);
    }
    if (computed) moveP(now, known, offset, told, information, forgetting, constant, out);
    if (!anything) return;
    correct(told, correction);
    if (computed) solveP(now, correction);
    for (let i = 0; i < n; i++) out[i] += computed ? correction[i] : rows[inverse + (i % entries)] * correction[i];
  };
}
