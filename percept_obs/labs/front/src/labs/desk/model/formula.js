// Formulas as trees that are shared, never changed and not simplified: numbers, letters, sums, products, powers,
// functions.  Numbers are quotients of whole numbers.

/**
 * @typedef {{kind: string, parts: Formula[], size?: number, n?: bigint, d?: bigint, name?: string}} Formula
 *   of a power n/d is the exponent, of a number its value
 */

/** @param {bigint} n @param {bigint} d @returns {Formula} */
export function number(n, d = 1n) {
  const common = divisor(n < 0n ? -n : n, d) || 1n;
  return { kind: "number", parts: [], n: n / common, d: d / common };
}

/** @param {bigint} a @param {bigint} b */
function divisor(a, b) {
  while (b) [a, b] = [b, a % b];
  return a;
}

export const [ZERO, ONE, MINUS] = [number(0n), number(1n), number(-1n)];

/** @type {(a: any, b: any) => Formula} */
const plus = (a, b) => number(BigInt(a.n * b.d + b.n * a.d), BigInt(a.d * b.d));
/** @type {(a: any, b: any) => Formula} */
const times = (a, b) => number(BigInt(a.n * b.n), BigInt(a.d * b.d));

/** The number that digits with a decimal point, and perhaps an exponent, say. */
export function decimal(text) {
  const [, whole, part = "", exponent = "0"] = /^(\d*)\.?(\d*)(?:[eE]([+-]?\d+))?$/.exec(text) ?? [];
  const size = Number(exponent) - part.length;
  const digits = BigInt(`${whole}${part}` || "0");
  return size < 0 ? number(digits, 10n ** BigInt(-size)) : number(digits * 10n ** BigInt(size));
}

export const isNumber = ({ kind }) => kind === "number";
export const isZero = ({ kind, n }) => kind === "number" && n === 0n;

/** @returns {Formula} */
export const letter = (name) => ({ kind: "letter", name, parts: [] });

/** @returns {Formula} */
export const applied = (name, ...parts) => ({ kind: "function", name, parts });

/** @returns {Formula} */
export function sum(parts) {
  if (parts.length === 1) return parts[0];
  if (parts.every(isNumber)) return parts.reduce(plus);
  return { kind: "sum", parts };
}

/** @returns {Formula} */
export function product(parts) {
  if (parts.length === 1) return parts[0];
  if (parts.some(isZero)) return ZERO;
  if (parts.every(isNumber)) return parts.reduce(times);
  return { kind: "product", parts };
}

/** A power whose exponent is a number, a whole or a half one. */
export function power(base, exponent) {
  const { n, d } = exponent;
  if (n === d) return base;
  if (!n) return ONE;
  if (d === 1n && isNumber(base)) {
    const [above, below] = n > 0n ? [base.n, base.d] : [base.d, base.n];
    const sign = below < 0n ? -1n : 1n;
    const size = n > 0n ? n : -n;
    return number((sign * above) ** size, (sign * below) ** size);
  }
  return { kind: "power", parts: [base], n, d };
}

export const negative = (part) => product([MINUS, part]);
export const inverse = (part) => power(part, MINUS);

/** An upper bound of the degree. */
export function degree(formula, known = new Map()) {
  let found = known.get(formula);
  if (found !== undefined) return found;
  const inner = formula.parts.map((part) => degree(part, known));
  const { kind, n } = formula;
  if (kind === "power") found = inner[0] * Math.max(1, Math.abs(Number(n)));
  else if (kind === "product") found = inner.reduce((a, b) => a + b, 0);
  else found = Math.max(...inner, inner.length ? 0 : 1);
  known.set(formula, found);
  return found;
}

/** How many letters, numbers and signs a formula has, each as often as it stands there. */
export function size(formula) {
  formula.size ??= formula.parts.reduce((all, part) => all + size(part), 1);
  return formula.size;
}

/** A formula with formulas in place of letters. */
export function substituted(formula, values, known = new Map()) {
  let found = known.get(formula);
  if (found) return found;
  const { kind, name, parts } = formula;
  found = kind === "letter" ? (values.get(name) ?? formula) : formula;
  const inner = parts.map((part) => substituted(part, values, known));
  if (inner.length) found = { ...formula, size: undefined, parts: inner };
  known.set(formula, found);
  return found;
}
