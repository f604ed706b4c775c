// Symmetric matrices, row by row in flat arrays: their extreme eigenvalues, all of them with vectors, least squares.

const PRECISION = 1e-13;
const SWEEPS = 30;

/**
 * Smallest and largest eigenvalue, and how many lie below a share of the largest: reflections make the matrix
 * tridiagonal, and halving an interval finds them by counting.
 *
 * @param {number[][]} parts  numbers of rows that have no entry with those of another part: each part is a matrix by
 *   itself
 */
export function spectrum(matrix, n, share, parts) {
  const found = parts.map((rows) => tridiagonal(partOf(matrix, n, rows), rows.length));
  const ends = found.map(extremes);
  const smallest = Math.min(...ends.map(([least]) => least));
  const largest = Math.max(...ends.map(([, most]) => most));
  const limit = share * Math.max(largest, 1e-300);
  const missed = found.reduce((sum, { diagonal, beside }) => sum + countBelow(diagonal, beside, limit), 0);
  return { smallest, largest, missed };
}

function partOf(matrix, n, rows) {
  const found = new Float64Array(rows.length ** 2);
  let at = 0;
  for (const i of rows) for (const j of rows) found[at++] = matrix[i * n + j];
  return found;
}

/** Smallest and largest eigenvalue of a tridiagonal matrix. */
function extremes({ diagonal, beside }) {
  const n = diagonal.length;
  let [low, high] = [Infinity, -Infinity];
  for (let i = 0; i < n; i++) {
    const reach = Math.abs(beside[i - 1] ?? 0) + Math.abs(beside[i] ?? 0);
    low = Math.min(low, diagonal[i] - reach);
    high = Math.max(high, diagonal[i] + reach);
  }
  const precision = PRECISION * Math.max(Math.abs(low), Math.abs(high));
  return [0, n - 1].map((which) => {
    let [from, to] = [low, high];
    while (to - from > precision) {
      const middle = (from + to) / 2;
      if (middle === from || middle === to) break;
      if (countBelow(diagonal, beside, middle) > which) to = middle;
      else from = middle;
    }
    return (from + to) / 2;
  });
}

/** Diagonal, and entries beside it, of a tridiagonal matrix with the same eigenvalues; the matrix is used up. */
function tridiagonal(a, n) {
  const v = new Float64Array(n);
  const w = new Float64Array(n);
  for (let k = 0; k + 2 < n; k++) {
    let norm = 0;
    for (let i = k + 1; i < n; i++) norm += a[i * n + k] ** 2;
    norm = Math.sqrt(norm);
    if (norm === 0) continue;
    // The unit vector v whose reflection puts all of the column below the diagonal into its first entry.
    const end = a[(k + 1) * n + k] > 0 ? -norm : norm;
    const size = Math.sqrt(2 * end * (end - a[(k + 1) * n + k]));
    for (let i = k + 1; i < n; i++) v[i] = (a[i * n + k] - (i === k + 1 ? end : 0)) / size;
    let product = 0;
    w.fill(0, k + 1);
    // Only the lower triangle is kept.
    for (let i = k + 1; i < n; i++) {
      const row = i * n;
      const part = v[i];
      let sum = a[row + i] * part;
      for (let j = k + 1; j < i; j++) {
        sum += a[row + j] * v[j];
        w[j] += a[row + j] * part;
      }
      w[i] += sum;
    }
    for (let i = k + 1; i < n; i++) product += v[i] * w[i];
    for (let i = k + 1; i < n; i++) w[i] = 2 * (w[i] - product * v[i]);
    for (let i = k + 1; i < n; i++) {
      const row = i * n;
      const one = v[i];
      const other = w[i];
      for (let j = k + 1; j <= i; j++) a[row + j] -= one * w[j] + other * v[j];
    }
    a[(k + 1) * n + k] = end;
  }
  const diagonal = Float64Array.from({ length: n }, (_, i) => a[i * n + i]);
  return { diagonal, beside: Float64Array.from({ length: n - 1 }, (_, i) => a[(i + 1) * n + i]) };
}

/** Number of eigenvalues of a tridiagonal matrix below a value, by Sturm's sequence. */
function countBelow(diagonal, beside, value) {
  let count = 0;
  let ratio = 1;
  for (let i = 0; i < diagonal.length; i++) {
    ratio = diagonal[i] - value - (i ? beside[i - 1] ** 2 / ratio : 0);
    if (ratio === 0) ratio = -Number.EPSILON * (Math.abs(value) + Number.MIN_VALUE);
    if (ratio < 0) count++;
  }
  return count;
}

/** All eigenvalues, increasing, with unit vectors, by Jacobi's rotations. */
export function eigen(matrix, n) {
  const a = Float64Array.from(matrix);
  const vectors = diagonal(n, () => 1);
  for (let sweep = 0; sweep < SWEEPS; sweep++) {
    let rotated = false;
    for (let p = 0; p < n; p++) {
      for (let q = p + 1; q < n; q++) rotated = rotate(a, vectors, n, p, q) || rotated;
    }
    if (!rotated) break;
  }
  const vectorOf = (k) => Float64Array.from({ length: n }, (_, i) => vectors[i * n + k]);
  const found = Array.from({ length: n }, (_, k) => ({ value: a[k * n + k], vector: vectorOf(k) }));
  return found.sort((one, other) => one.value - other.value);
}

function rotate(a, vectors, n, p, q) {
  const off = a[p * n + q];
  if (Math.abs(off) <= 1e-17 * Math.hypot(a[p * n + p], a[q * n + q]) || off === 0) return false;
  const ratio = (a[q * n + q] - a[p * n + p]) / (2 * off);
  const t = Math.sign(ratio || 1) / (Math.abs(ratio) + Math.hypot(1, ratio));
  const c = 1 / Math.hypot(1, t);
  const s = t * c;
  const turn = (rows, i, j) => {
    const [x, y] = [rows[i], rows[j]];
    rows[i] = c * x - s * y;
    rows[j] = s * x + c * y;
  };
  for (let k = 0; k < n; k++) turn(a, k * n + p, k * n + q);
  for (let k = 0; k < n; k++) turn(a, p * n + k, q * n + k);
  for (let k = 0; k < n; k++) turn(vectors, k * n + p, k * n + q);
  return true;
}

const NEGLIGIBLE = 1e-9;

/** The matrix, of n rows, that gives the smallest x with R x as close as can be to what is asked; R has m rows. */
export function pseudoInverse(R, m, n) {
  const square = new Float64Array(m * m);
  for (let i = 0; i < m; i++) {
    for (let j = 0; j < m; j++) for (let k = 0; k < n; k++) square[i * m + j] += R[i * n + k] * R[j * n + k];
  }
  const found = eigen(square, m);
  const inverse = new Float64Array(n * m);
  const limit = NEGLIGIBLE * found[m - 1].value;
  for (const { value, vector } of found) {
    if (value <= limit) continue;
    for (let i = 0; i < n; i++) {
      let along = 0;
      for (let k = 0; k < m; k++) along += R[k * n + i] * vector[k];
      for (let j = 0; j < m; j++) inverse[i * m + j] += (along * vector[j]) / value;
    }
  }
  return inverse;
}

/** A matrix of n rows with numbers on its diagonal. */
export function diagonal(n, at) {
  const matrix = new Float64Array(n * n);
  for (let i = 0; i < n; i++) matrix[i * n + i] = at(i);
  return matrix;
}

export function product(matrix, x, rows) {
  const width = x.length;
  return Float64Array.from({ length: rows }, (_, i) => {
    let sum = 0;
    for (let j = 0; j < width; j++) sum += matrix[i * width + j] * x[j];
    return sum;
  });
}
