// @ts-check
// The loop over points and steps, as in points/kernel.py: the same layouts, the same numbers.

const LARGEST_SQUARED_STATE = 1e300;

/**
 * Step an estimate, and P where it is computed, by the classical Runge-Kutta method.
 *
 * layout    where the coefficients stand: rows, columns, which; begins, axes, states, entries of the points
 * block     N and l of one point
 * law       {computed, information, forgetting, pull} of P
 * x, P      at the start; P is null where it is given
 * tables    {steps, coefficients, width, inverses, images, points, first}: coefficients have a row of `width` numbers
 *           for each start, middle and end of a step; inverses of a P that is a multiple of the identity likewise, or
 *           one; images have three rows a step, of all `points`, of which the layout's begin with `first`
 * path      takes the estimates
 * Returns the first row of the path at which the estimate was no longer finite, or -1; P holds its last value.
 */
export function advance(layout, block, law, x, P, tables, path) {
  const { steps, coefficients, width, inverses, images, points, first } = tables;
  const n = x.length;
  const rate = rateOf(layout, block, law, n);
  const [dx, stage, sum] = [0, 1, 2].map(() => new Float64Array(n));
  const [dP, stageP, sumP] = [0, 1, 2].map(() => new Float64Array(law.computed ? n * n : 0));
  const now = Float64Array.from(x);
  path.set(now);
  for (let k = 0; k < steps.length; k++) {
    sum.set(now);
    if (law.computed) sumP.set(P);
    for (let part = 0; part < 4; part++) {
      const place = (part + 1) >> 1;
      const share = 0.5 * steps[k] * place;
      const weight = steps[k] / (part % 3 === 0 ? 6 : 3);
      const row = 2 * k + place;
      for (let i = 0; i < n; i++) stage[i] = now[i] + share * dx[i];
      for (let i = 0; i < stageP.length; i++) stageP[i] = P[i] + share * dP[i];
      const inverse = law.computed ? 0 : inverses[inverses.length > 1 ? row : 0];
      const at = ((3 * k + place) * points + first) * 2;
      rate(stage, stageP, inverse, coefficients, row * width, images, at, dx, dP);
      for (let i = 0; i < n; i++) sum[i] += weight * dx[i];
      for (let i = 0; i < sumP.length; i++) sumP[i] += weight * dP[i];
    }
    now.set(sum);
    if (law.computed) P.set(sumP);
    path.set(now, (k + 1) * n);
    let squared = 0;
    for (let i = 0; i < n; i++) squared += now[i] * now[i];
    if (!(squared <= LARGEST_SQUARED_STATE)) return k + 1;
  }
  return -1;
}

/** A function that fills the rates of an estimate and of P. */
function rateOf(layout, { N, l }, law, n) {
  const { begins } = layout;
  const [rows, columns, which, axes, states] = ["rows", "columns", "which", "axes", "states"].map((name) => Int32Array.from(layout[name]));
  const entries = Float64Array.from(layout.entries);
  const { computed, information, forgetting, pull } = law;
  const correction = new Float64Array(n);
  const xi = new Float64Array(3);
  const c = new Float64Array(3);
  const S = new Float64Array(9);
  const b = new Float64Array(3);
  const solve = solver(n);
  // A^T P, whose transpose is P A, for P is symmetric.
  const AP = new Float64Array(computed ? n * n : 0);
  const ratesOfP = (P, known, offset, dP) => {
    AP.fill(0);
    for (let e = 0; e < rows.length; e++) {
      if (columns[e] === n) continue;
      const a = known[offset + which[e]];
      const [from, to] = [rows[e] * n, columns[e] * n];
      for (let k = 0; k < n; k++) AP[to + k] += a * P[from + k];
    }
    for (let i = 0, at = 0; i < n; i++) {
      for (let j = 0; j < n; j++, at++) dP[at] = pull[at] - forgetting * P[at] - AP[at] - AP[j * n + i];
    }
  };
  return (x, P, inverse, known, offset, images, at, dx, dP) => {
    dx.fill(0);
    correction.fill(0);
    for (let e = 0; e < rows.length; e++) {
      const a = known[offset + which[e]];
      dx[rows[e]] += columns[e] === n ? a : a * x[columns[e]];
    }
    if (computed) ratesOfP(P, known, offset, dP);
    let anything = false;
    for (let k = 0; k + 1 < begins.length; k++) {
      const y1 = images[at + 2 * k];
      const y2 = images[at + 2 * k + 1];
      if (Number.isNaN(y1 + y2)) continue;
      anything = true;
      xi.fill(0);
      c.fill(0);
      S.fill(0);
      for (let e = begins[k]; e < begins[k + 1]; e++) xi[axes[e]] += entries[e] * x[states[e]];
      const distance = l[0] * xi[0] + l[1] * xi[1] + l[2] * xi[2];
      for (let m = 0; m < 2; m++) {
        const y = m ? y2 : y1;
        const innovation = y * distance - N[m][0] * xi[0] - N[m][1] * xi[1] - N[m][2] * xi[2];
        for (let i = 0; i < 3; i++) {
          b[i] = N[m][i] - y * l[i];
          c[i] += b[i] * innovation;
        }
        if (!computed) continue;
        for (let i = 0; i < 3; i++) for (let j = 0; j < 3; j++) S[3 * i + j] += b[i] * b[j];
      }
      for (let e = begins[k]; e < begins[k + 1]; e++) {
        correction[states[e]] += entries[e] * c[axes[e]];
        for (let f = begins[k]; computed && f < begins[k + 1]; f++) {
          dP[states[e] * n + states[f]] += information * entries[e] * entries[f] * S[3 * axes[e] + axes[f]];
        }
      }
    }
    if (!anything) return;
    if (computed) solve(P, correction);
    for (let i = 0; i < n; i++) dx[i] += computed ? correction[i] : inverse * correction[i];
  };
}

/** Solve P x = right in place by Cholesky's method; NaN where P is not positive definite. */
function solver(n) {
  const L = new Float64Array(n * n);
  return (P, x) => {
    for (let i = 0; i < n; i++) {
      const row = i * n;
      for (let j = 0; j <= i; j++) {
        const other = j * n;
        let total = P[row + j];
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
