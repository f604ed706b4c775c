// @ts-check
// The loop over points and steps, as in points/kernel.py: the same layouts, the same numbers.

import { LARGEST_SQUARED_STATE } from "../../common/model/integrator.js";
import { stepper } from "../../common/model/runge_kutta.js";
import { EACH } from "../../common/model/tables.js";

/**
 * Step an estimate, and P where it is computed, by the Runge-Kutta method.
 *
 * layout    where the coefficients stand: rows, columns, which; begins, axes, states, entries of the points
 * point     what one point tells, printed from its block
 * law       {computed, information, forgetting, pull} of P
 * x, P      at the start; P is null where it is given
 * tables    {steps, coefficients, width, inverses, images, points, first}: coefficients have a row of `width` numbers
 *           for each instant of a step, whose end is the next one's start; inverses of a P that is a multiple of the
 *           identity likewise, or one; images have a row for each instant of each step, of all `points`, of which the
 *           layout's begin with `first`
 * path      takes the estimates
 * Returns the first row of the path at which the estimate was no longer finite, or -1; P holds its last value.
 */
export function advance(layout, point, law, x, P, tables, path) {
  const { steps, coefficients, width, inverses, images, points, first } = tables;
  const n = x.length;
  const now = new Float64Array(law.computed ? n + n * n : n);
  now.set(x);
  if (law.computed) now.set(P, n);
  const rate = rateOf(layout, point, law, n);
  const step = stepper(now.length);
  path.set(x);
  let failed = -1;
  for (let k = 0; k < steps.length && failed < 0; k++) {
    step(now, steps[k], (instant, stage, out) => {
      const row = EACH * k + instant;
      const inverse = law.computed ? 0 : inverses[inverses.length > 1 ? row : 0];
      const at = (((EACH + 1) * k + instant) * points + first) * 2;
      rate(stage, inverse, coefficients, row * width, images, at, out);
    });
    let squared = 0;
    for (let i = 0; i < n; i++) squared += (path[(k + 1) * n + i] = now[i]) ** 2;
    if (!(squared < LARGEST_SQUARED_STATE)) failed = k + 1;
  }
  if (law.computed) P.set(now.subarray(n));
  return failed;
}

/** A function that fills the rates of an estimate and, behind it, of P. */
function rateOf(layout, point, law, n) {
  const { begins } = layout;
  const [rows, columns, which, axes, states] = ["rows", "columns", "which", "axes", "states"].map((name) => Int32Array.from(layout[name]));
  const entries = Float64Array.from(layout.entries);
  const { computed, information, forgetting, pull } = law;
  const correction = new Float64Array(n);
  const given = new Float64Array(5);
  const told = new Float64Array(12);
  const solve = solver(n);
  // A^T P, whose transpose is P A, for P is symmetric.
  const AP = new Float64Array(computed ? n * n : 0);
  const ratesOfP = (now, known, offset, out) => {
    AP.fill(0);
    for (let e = 0; e < rows.length; e++) {
      if (columns[e] === n) continue;
      const a = known[offset + which[e]];
      const [from, to] = [n + rows[e] * n, columns[e] * n];
      for (let k = 0; k < n; k++) AP[to + k] += a * now[from + k];
    }
    for (let i = 0, at = 0; i < n; i++) {
      for (let j = 0; j < n; j++, at++) out[n + at] = pull[at] - forgetting * now[n + at] - AP[at] - AP[j * n + i];
    }
  };
  return (now, inverse, known, offset, images, at, out) => {
    out.fill(0, 0, n);
    correction.fill(0);
    for (let e = 0; e < rows.length; e++) {
      const a = known[offset + which[e]];
      out[rows[e]] += columns[e] === n ? a : a * now[columns[e]];
    }
    if (computed) ratesOfP(now, known, offset, out);
    let anything = false;
    for (let k = 0; k + 1 < begins.length; k++) {
      given[0] = images[at + 2 * k];
      given[1] = images[at + 2 * k + 1];
      if (Number.isNaN(given[0] + given[1])) continue;
      anything = true;
      given.fill(0, 2);
      for (let e = begins[k]; e < begins[k + 1]; e++) given[2 + axes[e]] += entries[e] * now[states[e]];
      point(given, told);
      for (let e = begins[k]; e < begins[k + 1]; e++) {
        correction[states[e]] += entries[e] * told[axes[e]];
        for (let f = begins[k]; computed && f < begins[k + 1]; f++) {
          const S = told[3 + 3 * axes[e] + axes[f]];
          out[n + states[e] * n + states[f]] += information * entries[e] * entries[f] * S;
        }
      }
    }
    if (!anything) return;
    if (computed) solve(now, correction);
    for (let i = 0; i < n; i++) out[i] += computed ? correction[i] : inverse * correction[i];
  };
}

/** Solve P x = right in place by Cholesky's method, P behind n other numbers; NaN where P is not positive definite. */
function solver(n) {
  const L = new Float64Array(n * n);
  return (now, x) => {
    for (let i = 0; i < n; i++) {
      const row = i * n;
      for (let j = 0; j <= i; j++) {
        const other = j * n;
        let total = now[n + row + j];
        for (let k = 0; k < j; k++) total -= L[row + k] * L[other + k];
        if (j < i) L[row + j] = total / L[other + j];
        else L[row + i] = total > 0 ? Math.sqrt(total) : NaN;
      }
      let value = x[i];
      for (let k = 0; k < i; k++) value -= L[row + k] * x[k];
      x[i] = value / L[row + i];
    }
    for (let i = n - 1; i >= 0; i--) {
      let value = x[i];
      for (let k = i + 1; k < n; k++) value -= L[k * n + i] * x[k];
      x[i] = value / L[i * n + i];
    }
  };
}
