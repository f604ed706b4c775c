// Whether two formulas are the same: their values modulo primes at secret points, and else real ones with their errors.

/** How many primes there are, and how many points must agree; of roots and signs more, for each turns at random. */
const [PRIMES, POINTS, TURNED] = [3, 3, 60];
/** How many real points must agree, and the largest relative error of a value that counts. */
const [REAL_POINTS, TRUST] = [120, 1e-6];
const TRIALS = 320;
const BITS = 61n;
const EPSILON = 2 ** -52;

/** No value at a point. */
class NoValue extends Error {}

/** A whole number of so many random bits, which nobody can foresee. */
function secret(bits) {
  const parts = [...crypto.getRandomValues(new Uint32Array(Math.ceil(Number(bits) / 32)))];
  return parts.map(BigInt).reduce((found, part) => (found << 32n) | part, 0n) & ((1n << bits) - 1n);
}

/** @param {bigint} base @param {bigint} exponent @param {bigint} p */
function raised(base, exponent, p) {
  let found = 1n;
  for (let square = ((base % p) + p) % p; exponent; exponent >>= 1n, square = (square * square) % p)
    if (exponent & 1n) found = (found * square) % p;
  return found;
}

/** A prime of 61 bits, drawn at random; 3 modulo 4, so that roots of squares are powers. */
export function drawnPrime() {
  for (;;) {
    const p = secret(BITS) | (1n << (BITS - 1n)) | 3n;
    if (isPrime(p)) return p;
  }
}

/** True for primes; of other numbers that are 3 modulo 4 each base finds three of four. */
function isPrime(p) {
  const small = [3n, 5n, 7n, 11n, 13n, 17n, 19n, 23n, 29n, 31n, 37n];
  if (small.some((each) => p % each === 0n)) return false;
  return [2n, ...small].every((base) => [1n, p - 1n].includes(raised(base, p >> 1n, p)));
}

/**
 * A point modulo a prime: letters have random values.  Functions have random values too, equal ones for equal
 * arguments, that obey r^2 = x for a root, s^2 + c^2 = 1 for sine and cosine, and so on: what is the same here is the
 * same.  `free` is set where such a value was drawn, so that a difference says nothing, and `turned` where a root or a
 * sign has one of two values.
 */
export class ModularPoint {
  free = false;
  turned = false;

  /** @param {bigint} prime */
  constructor(prime, definitions = new Map()) {
    this.p = prime;
    this.definitions = definitions;
    this.drawn = new Map();
    this.known = new Map();
  }

  /** @returns {bigint} */
  value(formula) {
    let found = this.known.get(formula);
    if (found === undefined) {
      found = this.found(formula);
      this.known.set(formula, found);
    }
    return found;
  }

  /** @param {any} formula */
  found({ kind, parts, n, d, name }) {
    const { p } = this;
    if (kind === "number") return this.over(n, d);
    if (kind === "letter")
      return this.definitions.has(name) ? this.value(this.definitions.get(name)) : this.draw(name);
    /** @type {bigint[]} */
    const inner = parts.map((part) => this.value(part));
    if (kind === "sum") return inner.reduce((all, part) => all + part, 0n) % p;
    if (kind === "product") return inner.reduce((all, part) => (all * part) % p, 1n);
    if (kind === "function") return this.applied(name, inner);
    const base = d === 2n ? this.root(inner[0]) : inner[0];
    const found = raised(base, abs(n), p);
    return n < 0n ? this.over(1n, found) : found;
  }

  /** @param {bigint} above @param {bigint} below */
  over(above, below) {
    const { p } = this;
    if (below % p === 0n) throw new NoValue();
    const inverse = raised(below, p - 2n, p);
    return (((above % p) + p) * inverse) % p;
  }

  /** @returns {bigint} */
  draw(name) {
    let found = this.drawn.get(name);
    if (found === undefined) {
      found = secret(BITS + 32n) % this.p;
      this.drawn.set(name, found);
    }
    return found;
  }

  /** One of the roots of a square, the same one each time. */
  root(x) {
    const { p } = this;
    this.free = this.turned = true;
    const found = raised(x, (p + 1n) >> 2n, p);
    if ((found * found) % p !== x) throw new NoValue();
    return this.draw(`root ${x}`) & 1n ? found : (p - found) % p;
  }

  /** A random sign, of opposite numbers opposite ones. */
  sign(x) {
    const { p } = this;
    this.free = this.turned = true;
    if (!x) return 0n;
    const turned = x > p >> 1n;
    const minus = Boolean(this.draw(`sign ${turned ? p - x : x}`) & 1n);
    return turned === minus ? 1n : p - 1n;
  }

  applied(name, inner) {
    const { p } = this;
    const [x] = inner;
    this.free = true;
    if (name === "sqrt") return this.root(x);
    if (name === "sign") return this.sign(x);
    if (name === "abs") return (this.sign(x) * x) % p;
    if (["sin", "cos", "tan"].includes(name)) {
      const turned = x > p >> 1n;
      const t = x ? this.draw(`half ${turned ? p - x : x}`) : 0n;
      const [sine, cosine] = [(turned ? p - 2n : 2n) * t, 1n + p * p - t * t];
      return this.over(name === "cos" ? cosine : sine, name === "tan" ? cosine : 1n + t * t);
    }
    if (["exp", "sinh", "cosh", "tanh", "sech"].includes(name)) {
      const turned = x > p >> 1n;
      const drawn = x ? this.draw(`power ${turned ? p - x : x}`) : 1n;
      const e = turned ? this.over(1n, drawn) : drawn;
      if (name === "exp") return e;
      const square = (e * e) % p;
      if (name === "sech") return this.over(2n * e, square + 1n);
      const above = name === "cosh" ? square + 1n : square - 1n;
      return this.over(above, name === "tanh" ? square + 1n : 2n * e);
    }
    return this.draw(`${name} ${inner}`);
  }
}

const RISING = { tan: Math.tan, atan: Math.atan, asin: Math.asin, acos: (x) => Math.acos(x), sinh: Math.sinh };
const MONOTONE = { ...RISING, tanh: Math.tanh, exp: Math.exp, log: Math.log, sqrt: Math.sqrt };

/** A real point: a value is a pair of a number and a bound of its error. */
export class RealPoint {
  constructor(values, definitions = new Map()) {
    this.values = values;
    this.definitions = definitions;
    this.known = new Map();
  }

  value(formula) {
    let found = this.known.get(formula);
    if (!found) {
      found = this.found(formula);
      if (!Number.isFinite(found[0]) || !Number.isFinite(found[1])) throw new NoValue();
      this.known.set(formula, found);
    }
    return found;
  }

  found({ kind, parts, n, d, name }) {
    if (kind === "number") return rounded(Number(n) / Number(d));
    if (kind === "letter") {
      if (this.definitions.has(name)) return this.value(this.definitions.get(name));
      return [this.values(name), 0];
    }
    const inner = parts.map((part) => this.value(part));
    if (kind === "sum") {
      const size = inner.reduce((all, [x]) => all + Math.abs(x), 0);
      const error = inner.reduce((all, [, e]) => all + e, 0);
      return [inner.reduce((all, [x]) => all + x, 0), error + size * inner.length * EPSILON];
    }
    if (kind === "product")
      return inner.reduce(([a, f], [b, e]) => rounded(a * b, Math.abs(a) * e + Math.abs(b) * f + e * f));
    if (kind === "function") return this.applied(name, inner[0]);
    const exponent = Number(n) / Number(d);
    const [base, error] = inner[0];
    if (d === 1n && n > 0n && !error) return rounded(base ** exponent);
    // a power rises or falls on one side of zero only
    if (Math.abs(base) <= error) throw new NoValue();
    return between((x) => x ** exponent, base, error);
  }

  applied(name, [x, error]) {
    if (name === "pi") return rounded(Math.PI);
    if (name === "abs") return [Math.abs(x), error];
    if (name === "sign") {
      if (Math.abs(x) <= error && error) throw new NoValue();
      return [Math.sign(x), 0];
    }
    if (name === "sin" || name === "cos") return [Math[name](x), Math.min(error, 2) + 4 * EPSILON];
    if (name === "cosh" || name === "sech") {
      const [cosh, e] = between(Math.cosh, Math.max(Math.abs(x), error), error);
      return name === "cosh" ? [cosh, e] : rounded(1 / cosh, e / cosh / Math.max(cosh - e, 1));
    }
    if (name === "sqrt" && x < error && x > -error) throw new NoValue();
    const function_ = MONOTONE[name];
    if (!function_) throw new NoValue();
    if (name === "tan" && (error > 1 || Math.tan(x - error) > Math.tan(x + error))) throw new NoValue();
    return between(function_, x, error);
  }
}

function rounded(x, error = 0) {
  return [x, error + Math.abs(x) * 4 * EPSILON];
}

function between(rising, x, error) {
  const value = rising(x);
  const off = error ? Math.max(Math.abs(rising(x + error) - value), Math.abs(rising(x - error) - value)) : 0;
  return rounded(value, off);
}

/** A value at a point, or undefined where there is none. */
export function valueAt(point, formula) {
  try {
    return point.value(formula);
  } catch (error) {
    if (error instanceof NoValue) return undefined;
    throw error;
  }
}

/**
 * Return true if two formulas are the same function of their letters, false if not, and null if that cannot be told
 * here.  Rational ones are wrongly called the same with a chance of less than 2^-100.
 */
export function same(one, other, definitions = new Map()) {
  const primes = Array.from({ length: PRIMES }, drawnPrime);
  let [agreed, enough] = [0, POINTS];
  for (let trial = 0; trial < TRIALS && agreed < enough; trial++) {
    const point = new ModularPoint(primes[trial % PRIMES], definitions);
    const [a, b] = [one, other].map((formula) => valueAt(point, formula));
    if (a === undefined || b === undefined) continue;
    if (a !== b) return point.free ? sameReal(one, other, definitions) : false;
    if (point.turned) enough = TURNED;
    agreed++;
  }
  return agreed === enough ? true : sameReal(one, other, definitions);
}

/** The same by real values: of sizes from 1e-4 to 1e4, to all digits that their errors leave. */
function sameReal(one, other, definitions) {
  let agreed = 0;
  for (let trial = 0; trial < TRIALS && agreed < REAL_POINTS; trial++) {
    const spread = [0.3, 1, 2.5, 4][trial % 4];
    const point = new RealPoint(drawnReals(spread), definitions);
    const [a, b] = [one, other].map((formula) => valueAt(point, formula));
    if (!a || !b) continue;
    const [apart, error] = [Math.abs(a[0] - b[0]), a[1] + b[1]];
    if (apart > 2 * error) return false;
    if (error <= TRUST * Math.max(Math.abs(a[0]), Math.abs(b[0]))) agreed++;
  }
  return agreed === REAL_POINTS && !delicate(one) && !delicate(other) ? true : null;
}

/** Random numbers by names: of both signs, and of sizes within so many powers of ten. */
function drawnReals(spread) {
  const drawn = new Map();
  const random = () => Number(secret(53n)) / 2 ** 53;
  return (name) => {
    if (!drawn.has(name)) drawn.set(name, (random() < 0.5 ? -1 : 1) * 10 ** (spread * (2 * random() - 1)));
    return drawn.get(name);
  };
}

/** True for formulas with parts that may be too small to be seen: far numbers, functions of numbers such as e^-100. */
function delicate(formula, seen = new Set()) {
  if (seen.has(formula)) return false;
  seen.add(formula);
  const { kind, parts, n, d, name } = formula;
  if (kind === "number") return n !== 0n && (abs(n) > 10n ** 6n * d || d > 10n ** 6n * abs(n));
  if (kind === "function" && name !== "sqrt" && name !== "pi" && parts.every((part) => !hasLetters(part))) return true;
  return parts.some((part) => delicate(part, seen));
}

function hasLetters({ kind, parts }) {
  return kind === "letter" || parts.some(hasLetters);
}

/** @param {bigint} n */
const abs = (n) => (n < 0n ? -n : n);
