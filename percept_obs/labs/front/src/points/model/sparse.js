// @ts-check
// A symmetric matrix most of whose entries stay 0, as P's between points that share nothing: where the others stand, how
// they move, and how P x = b is solved with them.  What is done is laid out once, as lists that flat loops walk along.

/**
 * @typedef {{begins: Int32Array, one: Int32Array, other: Int32Array}} Lists  pairs of indices, those of list k from
 *   begins[k] to begins[k + 1]
 */

/** @returns {Lists} */
function flat(/** @type {number[][][]} */ lists) {
  const begins = Int32Array.from([0, ...lists.map((list) => list.length)]);
  for (let k = 1; k < begins.length; k++) begins[k] += begins[k - 1];
  const all = lists.flat();
  return { begins, one: Int32Array.from(all, ([a]) => a), other: Int32Array.from(all, ([, b]) => b) };
}

/**
 * Where the entries of P stand that ever differ from 0, when it begins as a diagonal matrix: those of one state, those of
 * two states that a point has, and what A carries these to.  One of a pair is kept: `at` says where, or -1.
 */
export function entriesOf({ rows, columns, begins, states }, n) {
  const there = new Uint8Array(n * n);
  const put = (i, j) => (there[i * n + j] = there[j * n + i] = 1);
  for (let i = 0; i < n; i++) put(i, i);
  for (let p = 0; p + 1 < begins.length; p++) {
    const own = states.slice(begins[p], begins[p + 1]);
    for (const i of own) for (const j of own) put(i, j);
  }
  for (let found = true; found; ) {
    found = false;
    for (let e = 0; e < rows.length; e++) {
      for (let k = 0; columns[e] < n && k < n; k++) {
        if (!there[rows[e] * n + k] || there[columns[e] * n + k]) continue;
        put(columns[e], k);
        found = true;
      }
    }
  }
  const at = new Int32Array(n * n).fill(-1);
  const pairs = /** @type {number[][]} */ ([]);
  for (let i = 0; i < n; i++) {
    for (let j = 0; j <= i; j++) {
      if (!there[i * n + j]) continue;
      at[i * n + j] = at[j * n + i] = pairs.length;
      pairs.push([i, j]);
    }
  }
  return { at, pairs };
}

/** For each entry of A^T P + P A its terms: a coefficient of A, and the entry of P that it multiplies. */
export function termsOf({ rows, columns, which }, { at, pairs }, n) {
  return flat(
    pairs.map(([i, j]) => {
      const terms = [];
      for (let e = 0; e < rows.length; e++) {
        if (columns[e] === i && at[rows[e] * n + j] >= 0) terms.push([which[e], at[rows[e] * n + j]]);
        if (columns[e] === j && at[rows[e] * n + i] >= 0) terms.push([which[e], at[rows[e] * n + i]]);
      }
      return terms;
    }),
  );
}

/** For each point what it adds to P' for each entry of its P: the entry, that of its 3 x 3 information, a factor. */
export function informationOf({ begins, axes, states, entries }, { at }, n) {
  const factors = /** @type {number[]} */ ([]);
  const lists = Array.from({ length: begins.length - 1 }, (_, p) => {
    const list = [];
    for (let e = begins[p]; e < begins[p + 1]; e++) {
      for (let f = begins[p]; f < begins[p + 1]; f++) {
        if (states[f] > states[e]) continue;
        list.push([at[states[e] * n + states[f]], 3 * axes[e] + axes[f]]);
        factors.push(entries[e] * entries[f]);
      }
    }
    return list;
  });
  return { ...flat(lists), factors: Float64Array.from(factors) };
}

/**
 * A function that solves P x = right in place by Cholesky's method, the entries of P behind n other numbers; NaN where P
 * is not positive definite.  States with the fewest neighbours go first, so that little is filled in.
 */
export function solverOf({ at }, n) {
  const neighbours = Array.from({ length: n }, (_, i) => at.subarray(i * n, i * n + n).reduce((sum, k) => sum + (k >= 0 ? 1 : 0), 0));
  const order = Int32Array.from({ length: n }, (_, i) => i).sort((i, j) => neighbours[i] - neighbours[j] || i - j);
  const place = filledIn(n, (p, q) => at[order[p] * n + order[q]] >= 0);
  const cells = /** @type {number[][]} */ ([]);
  for (let p = 0; p < n; p++) for (let q = 0; q <= p; q++) if (place[p * n + q]) place[p * n + q] = cells.push([p, q]);
  const L = new Float64Array(cells.length + 1); // the first is no cell
  const source = Int32Array.from(cells, ([p, q]) => at[order[p] * n + order[q]]);
  const column = Int32Array.from(cells, ([, q]) => q);
  const ends = Int32Array.from({ length: n }, (_, p) => place[p * n + p]);
  const { begins, one, other } = flat(
    cells.map(([p, q]) => {
      const before = Array.from({ length: q }, (_, k) => [place[p * n + k], place[q * n + k]]);
      return before.filter(([left, right]) => left && right);
    }),
  );
  const y = new Float64Array(n);
  return (/** @type {Float64Array} */ now, /** @type {Float64Array} */ x) => {
    for (let p = 0, cell = 1; p < n; p++) {
      let value = x[order[p]];
      for (; cell < ends[p]; cell++) {
        let total = source[cell - 1] < 0 ? 0 : now[n + source[cell - 1]];
        for (let t = begins[cell - 1]; t < begins[cell]; t++) total -= L[one[t]] * L[other[t]];
        L[cell] = total / L[ends[column[cell - 1]]];
        value -= L[cell] * y[column[cell - 1]];
      }
      let total = now[n + source[cell - 1]];
      for (let t = begins[cell - 1]; t < begins[cell]; t++) total -= L[one[t]] * L[other[t]];
      L[cell] = total > 0 ? Math.sqrt(total) : NaN;
      y[p] = value / L[cell++];
    }
    for (let p = n - 1; p >= 0; p--) {
      const value = y[p] / L[ends[p]];
      for (let cell = p ? ends[p - 1] + 1 : 1; cell < ends[p]; cell++) y[column[cell - 1]] -= L[cell] * value;
      x[order[p]] = value;
    }
  };
}

/** 1 where Cholesky's factor has an entry, row by row; `has` says where the matrix has one. */
function filledIn(n, has) {
  const there = new Int32Array(n * n);
  for (let p = 0; p < n; p++) for (let q = 0; q <= p; q++) there[p * n + q] = has(p, q) ? 1 : 0;
  for (let k = 0; k < n; k++) {
    for (let p = k + 1; p < n; p++) {
      for (let q = k + 1; there[p * n + k] && q <= p; q++) if (there[q * n + k]) there[p * n + q] = 1;
    }
  }
  return there;
}
