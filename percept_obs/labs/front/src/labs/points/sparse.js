// @ts-check
// Rates of a layout are printed line by line, for loops over so few numbers take four times as long.  P between points
// that share nothing stays 0: printed are the rates of its other entries, and how P x = b is solved with them.

/** Statements of a function at most; engines give up on longer ones. */
const LONGEST = 400;

/**
 * Where the entries of P stand that ever differ from 0, when it begins as blocks of 3 x 3: those of one vector, those
 * of two states that a point has, and what A carries these to. One of a pair is kept: `at` says where, or -1.
 */
export function entriesOf({ rows, columns, begins, states }, n) {
  const there = new Uint8Array(n * n);
  const put = (i, j) => (there[i * n + j] = there[j * n + i] = 1);
  for (let i = 0; i < n; i++) for (let j = i - (i % 3); j <= i; j++) put(i, j);
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
    for (let j = 0; j <= i; j++) if (there[i * n + j]) at[i * n + j] = at[j * n + i] = pairs.push([i, j]) - 1;
  }
  return { at, pairs };
}

/**
 * Texts of the functions of an estimate for a layout: `moveX` fills its rates without any correction, `place` the
 * points' coordinates, and `correct` what all points together say of the state.
 */
export function textsOfX({ rows, columns, which, begins, axes, states, entries }, n) {
  const sums = (count) => Array.from({ length: count }, () => /** @type {string[]} */ ([]));
  const [rates, places, corrections] = [sums(n), sums(3 * (begins.length - 1)), sums(n)];
  const times = (factor, text) => (factor === 1 ? text : `${factor} * ${text}`);
  rows.forEach((row, e) =>
    rates[row].push(`known[at + ${which[e]}]${columns[e] === n ? "" : ` * now[${columns[e]}]`}`),
  );
  for (let p = 0; p + 1 < begins.length; p++) {
    for (let e = begins[p]; e < begins[p + 1]; e++) {
      places[3 * p + axes[e]].push(times(entries[e], `now[${states[e]}]`));
      corrections[states[e]].push(times(entries[e], `told[${12 * p + axes[e]}]`));
    }
  }
  const filled = (name, found) => found.map((terms, i) => `${name}[${i}] = ${terms.join(" + ") || "0"};`);
  return {
    moveX: inParts("moveX", "now, known, at, out", filled("out", rates)),
    place: inParts("place", "now, places", filled("places", places)),
    correct: inParts("correct", "told, correction", filled("correction", corrections)),
  };
}

/** Texts of the functions of P for a layout: `move` fills its rates, `solve` solves P x = right in place. */
export function textsOfP(layout, n) {
  const found = entriesOf(layout, n);
  return { moveP: moveText(layout, found, n), solveP: solveText(found, n) };
}

/** A function that runs statements one after the other, in parts that are not too long; `first` begins each part. */
function inParts(name, parameters, statements, { before = "", first = "" } = {}) {
  const parts = [];
  for (let k = 0; k < statements.length; k += LONGEST) parts.push(statements.slice(k, k + LONGEST).join("\n"));
  const calls = parts.map((_, k) => `part${k}(${parameters});`).join(" ");
  const functions = parts.map((text, k) => `function part${k}(${parameters}) {\n${first}\n${text}\n}`);
  return [`function ${name}(${parameters}) { ${calls} }`, before, ...functions].join("\n");
}

/** P' = pull - forgetting P - A^T P - P A + information S: of an estimate and P's entries behind it, in `now`. */
function moveText({ rows, columns, which, begins, axes, states, entries }, { at, pairs }, n) {
  const learnt = pairs.map(() => /** @type {string[]} */ ([]));
  for (let p = 0; p + 1 < begins.length; p++) {
    for (let e = begins[p]; e < begins[p + 1]; e++) {
      for (let f = begins[p]; f < begins[p + 1]; f++) {
        if (states[f] > states[e]) continue;
        const told = `told[${12 * p + 3 + 3 * axes[e] + axes[f]}]`;
        const factor = entries[e] * entries[f];
        learnt[at[states[e] * n + states[f]]].push(factor === 1 ? told : `${factor} * ${told}`);
      }
    }
  }
  const statements = pairs.map(([i, j], k) => {
    const term = (e, other) =>
      at[rows[e] * n + other] < 0 ? [] : [`a${which[e]} * now[${n + at[rows[e] * n + other]}]`];
    const moved = rows.flatMap((_, e) => [
      ...(columns[e] === i ? term(e, j) : []),
      ...(columns[e] === j ? term(e, i) : []),
    ]);
    const less = moved.length ? ` - (${moved.join(" + ")})` : "";
    const more = learnt[k].length ? ` + information * (${learnt[k].join(" + ")})` : "";
    return `out[${n + k}] = pull[${k}] - forgetting * now[${n + k}]${less}${more};`;
  });
  const first = [...new Set(which)].map((k) => `const a${k} = known[at + ${k}];`).join("\n");
  return inParts("moveP", "now, known, at, told, information, forgetting, pull, out", statements, { first });
}

/**
 * Cholesky's method; not finite where P is not positive definite. States with the fewest neighbours go first, so that
 * little is filled in.
 */
function solveText({ at }, n) {
  const neighbours = Array.from({ length: n }, (_, i) => at.subarray(i * n, i * n + n).filter((k) => k >= 0).length);
  const order = Array.from({ length: n }, (_, i) => i).sort((i, j) => neighbours[i] - neighbours[j] || i - j);
  const has = filledIn(n, (p, q) => at[order[p] * n + order[q]] >= 0);
  const before = (p) => Array.from({ length: p }, (_, q) => q).filter((q) => has[p * n + q]);
  const L = (p, q) => `L[${(p * (p + 1)) / 2 + q}]`;
  const forwards = order.flatMap((state, p) => {
    const cell = (q) => {
      const entry = at[state * n + order[q]];
      const products = before(q).filter((k) => has[p * n + k]).map((k) => ` - ${L(p, k)} * ${L(q, k)}`);
      return `${entry < 0 ? "0" : `now[${n + entry}]`}${products.join("")}`;
    };
    const products = before(p).map((q) => ` - ${L(p, q)} * y[${q}]`).join("");
    return [
      ...before(p).map((q) => `${L(p, q)} = (${cell(q)}) * D[${q}];`),
      `D[${p}] = 1 / Math.sqrt(${cell(p)});`,
      `y[${p}] = (x[${state}]${products}) * D[${p}];`,
    ];
  });
  const backwards = order.map((state, p) => {
    const products = order.flatMap((_, q) => (q > p && has[q * n + p] ? [` - ${L(q, p)} * y[${q}]`] : [])).join("");
    return `x[${state}] = y[${p}] = (y[${p}]${products}) * D[${p}];`;
  });
  const room = `const [L, D, y] = [${(n * (n + 1)) / 2}, ${n}, ${n}].map((size) => new Float64Array(size));`;
  return inParts("solveP", "now, x", [...forwards, ...backwards.reverse()], { before: room });
}

/** 1 where Cholesky's factor has an entry, row by row; `has` says where the matrix has one. */
function filledIn(n, has) {
  const there = new Uint8Array(n * n);
  for (let p = 0; p < n; p++) for (let q = 0; q <= p; q++) there[p * n + q] = has(p, q) ? 1 : 0;
  for (let k = 0; k < n; k++) {
    for (let p = k + 1; p < n; p++) {
      for (let q = k + 1; there[p * n + k] && q <= p; q++) if (there[q * n + k]) there[p * n + q] = 1;
    }
  }
  return there;
}
