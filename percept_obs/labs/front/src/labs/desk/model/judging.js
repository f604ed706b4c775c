// Whether two formulas are the same, by their values at secret points; a value comes with the error of its rounding.

/**
 * @typedef {import("./reading.js").Tree} Tree  @typedef {Map<string, number>} Point  @typedef {[number, number]} Value
 * @typedef {(at: Point, seen?: Set<Tree>) => Value} Formula  notes the terms that make a difference
 */

const [EPSILON, MARGIN, PRECISE, VISIBLE] = [2 ** -52, 16, 1e-7, 1e-9];
/** Exponents of ten of the largest letters at points of three sizes; how many points there are, and must be usable. */
const [SIZES, POINTS, USABLE, TRIALS] = [[0.3, 1, 2], 120, 60, 1200];
const MOST_TERMS = 250;
const MINUS = { kind: "number", n: -1, parts: [] };
/** @type {Record<string, ((x: number) => number)[]>} functions and their slopes */
const CALLED = {
  ...{ sin: [Math.sin, Math.cos], cos: [Math.cos, Math.sin] },
  ...{ tan: [Math.tan, (x) => 1 + Math.tan(x) ** 2], exp: [Math.exp, Math.exp] },
};

/** A tree as a function of the letters; one divided by something is its power -1. @returns {Formula} */
export function compiled({ kind, parts, n = -1, name = "" }) {
  const inner = parts.map(compiled);
  const [of] = inner;
  if (kind === "number") return () => [n, EPSILON * Math.abs(n)];
  if (kind === "name") return (at) => [at.get(name) ?? NaN, 0];
  if (kind === "minus") return (at, seen) => times([-1, 0], of(at, seen));
  if (kind === "sum") return (at, seen) => total(inner.map((part) => part(at, seen)), parts, seen);
  if (kind === "product") return (at, seen) => inner.map((part) => part(at, seen)).reduce(times);
  if (kind === "call" && name !== "sqrt") return (at, seen) => grown(of(at, seen), CALLED[name][0], CALLED[name][1]);
  const power = kind === "call" ? 0.5 : n;
  return (at, seen) => grown(of(at, seen), (x) => x ** power, (x) => power * x ** (power - 1), power < 1);
}

/** @type {(a: Value, b: Value) => Value} */
const times = ([a, da], [b, db]) => [a * b, Math.abs(a) * db + Math.abs(b) * da + EPSILON * Math.abs(a * b)];

/** @returns {Value} */
function total(values, parts, seen) {
  const size = values.reduce((all, [value]) => all + Math.abs(value), 0);
  if (seen) values.forEach(([value], k) => Math.abs(value) > VISIBLE * size && seen.add(parts[k]));
  const [sum, error] = values.reduce((all, each) => all.map((value, k) => value + each[k]), [0, 0]);
  return [sum, error + EPSILON * size * values.length];
}

/** @returns {Value} */
function grown([x, error], f, slope, pole = false) {
  if (pole && Math.abs(x) <= MARGIN * error) return [NaN, NaN];
  return [f(x), Math.abs(slope(x)) * error + 4 * EPSILON * Math.abs(f(x))];
}

/** Secret points at which a formula has a value; `define` adds letters that others give. @returns {Point[]} */
export function secretPoints(/** @type {string[]} */ letters, formula, define) {
  const points = [];
  for (let k = 0; k < TRIALS && points.length < POINTS; k++) {
    const drawn = [...crypto.getRandomValues(new Int32Array(letters.length))];
    const values = drawn.map((each) => Math.sign(each) * 10 ** (SIZES[k % 3] * (Math.abs(each) / 2 ** 30 - 1)));
    const at = define(new Map(letters.map((name, j) => [name, values[j]])));
    if (Number.isFinite(formula(at)[0])) points.push(at);
  }
  return points;
}

/** Whether a tree is a formula, beside which these stand below roots: true, false, or null if numbers cannot tell. */
export function same(tree, mine, /** @type {Formula} */ truth, roots, points) {
  const seen = new Set();
  let usable = 0;
  for (const at of points) {
    const [[value, error], [known, trueError]] = [mine(at, seen), truth(at)];
    const bound = MARGIN * (error + trueError);
    if (Math.abs(value - known) > bound) return false;
    usable += Number(bound <= PRECISE * Math.max(1, Math.abs(known)));
  }
  // What stands below a root is the same as something else on one side of a point only.
  const met = (root) => roots.some((other) => same(root, compiled(root), compiled(other), [], points));
  return usable >= USABLE && termsOf(tree).every((term) => seen.has(term)) && rootsOf(tree).every(met) ? true : null;
}

const isRoot = ({ kind, n, name }) => name === "sqrt" || (kind === "power" && !Number.isInteger(n));
const termsOf = ({ kind, parts }) => [...(kind === "sum" ? parts : []), ...parts.flatMap(termsOf)];
/** @returns {Tree[]} */
export const rootsOf = (tree) => [...(isRoot(tree) ? tree.parts : []), ...tree.parts.flatMap(rootsOf)];

/**
 * How a formula differs from the true one, where both can be multiplied out: how many terms it lacks if it is right as
 * far as it goes, and else the wrong terms, and how many times what they should be they are, if all are alike.
 */
export function compared(mine, true_, points) {
  const [own, whole] = [mine, true_].map((tree) => collected(tree, points.slice(0, 3)));
  const each = [...own].map(([key, { sum, from }]) => ({ from, times: sum / (whole.get(key)?.sum ?? NaN) }));
  const off = each.filter(({ times }) => !(Math.abs(times - 1) <= 1e-6));
  const common = off[0]?.from.findLast((term) => off.every(({ from }) => from.includes(term)));
  const wrong = common ? [common] : off.map(({ from }) => from.at(-1)).filter(Boolean);
  const [times, ...others] = new Set(off.map((term) => Number(term.times.toPrecision(6))));
  return { lacks: off.length || !own.size ? 0 : whole.size - own.size, wrong, times: others.length ? NaN : times };
}

/** The terms that a tree becomes, by how each changes from point to point; none if they are too many. */
function collected(tree, points) {
  const found = new Map();
  for (const { at: [first, ...rest], from } of expanded(tree, points, []) ?? []) {
    const key = rest.map((value) => (value / first).toPrecision(7)).join();
    const { sum, size } = found.get(key) ?? { sum: 0, size: 0 };
    found.set(key, { sum: sum + first, size: size + Math.abs(first), from });
  }
  return new Map([...found].filter(([, { sum, size }]) => !(Math.abs(sum) <= VISIBLE * size)));
}

/** Values at points of the terms that a tree becomes, each with the terms of the tree that it comes from. */
function expanded(tree, points, from) {
  const { kind, parts } = tree;
  if (kind === "minus") return expanded({ kind: "product", parts: [MINUS, ...parts] }, points, from);
  if (kind !== "sum" && kind !== "product") return [{ at: points.map((at) => compiled(tree)(at)[0]), from }];
  const inner = parts.map((part) => expanded(part, points, kind === "sum" ? [...from, part] : from));
  if (inner.some((terms) => !terms)) return undefined;
  return kind === "sum" ? inner.flat() : inner.reduce(crossed);
}

function crossed(some, others) {
  if (!some || some.length * others.length > MOST_TERMS) return undefined;
  const product = (one, other) => one.at.map((value, k) => value * other.at[k]);
  return some.flatMap((a) => others.map((b) => ({ at: product(a, b), from: [...new Set([...a.from, ...b.from])] })));
}
