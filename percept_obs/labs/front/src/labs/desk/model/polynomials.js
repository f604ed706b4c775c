// Formulas multiplied out: how many terms one lacks.

import { drawnPrime, ModularPoint, valueAt } from "./proving.js";

const MOST_TERMS = 2000;

/** Too long, or no polynomial. */
class NotExpanded extends Error {}

/** How many terms a formula lacks that is right as far as it goes; 0 for any other, or if that cannot be told here. */
export function lacking(mine, true_, meant) {
  try {
    const point = new ModularPoint(drawnPrime(), meant);
    const [own, whole] = [mine, true_].map((formula) => expanded(formula, point));
    if (!own.size) return 0;
    const differ = [...new Set([...own.keys(), ...whole.keys()])].filter((term) => own.get(term) !== whole.get(term));
    return differ.some((term) => own.has(term)) ? 0 : differ.length;
  } catch (error) {
    if (error instanceof NotExpanded) return 0;
    throw error;
  }
}

/** Coefficients modulo a prime by products of letters; functions and roots are letters, the same for equal values. */
function expanded(formula, point) {
  const { kind, parts, n, d, name } = formula;
  if (kind === "letter") return new Map([[`${name}^1`, 1n]]);
  if (kind === "sum") return parts.map((part) => expanded(part, point)).reduce((a, b) => added(a, b, point.p));
  if (kind === "product") return parts.map((part) => expanded(part, point)).reduce((a, b) => multiplied(a, b, point.p));
  if (kind === "power" && d === 1n && n > 0n) {
    const base = expanded(parts[0], point);
    return Array.from({ length: Number(n) }, () => base).reduce((a, b) => multiplied(a, b, point.p));
  }
  if (kind === "power" && d === 1n) {
    const below = expanded(parts[0], point);
    if (below.size !== 1) throw new NotExpanded();
    const [[term, coefficient]] = below;
    const inverse = powersOf(term).map(([each, power]) => `${each}^${power * Number(n)}`).join(" ");
    return new Map([[inverse, point.over(1n, coefficient) ** -n % point.p]]);
  }
  const value = valueAt(point, formula);
  if (value === undefined) throw new NotExpanded();
  return kind === "number" ? new Map(value ? [["", value]] : []) : new Map([[`${value}^1`, 1n]]);
}

const powersOf = (term) =>
  term.split(" ").filter(Boolean).map((each) => {
    const [name, power] = each.split("^");
    return /** @type {[string, number]} */ ([name, Number(power)]);
  });

function added(one, other, p) {
  const sum = new Map(one);
  for (const [term, value] of other) put(sum, term, value, p);
  return sum;
}

function multiplied(one, other, p) {
  const product = new Map();
  if (one.size * other.size > MOST_TERMS) throw new NotExpanded();
  for (const [a, x] of one) for (const [b, y] of other) put(product, joined(a, b), (x * y) % p, p);
  return product;
}

function put(terms, term, value, p) {
  const found = ((terms.get(term) ?? 0n) + value) % p;
  if (found) terms.set(term, found);
  else terms.delete(term);
}

function joined(a, b) {
  const powers = new Map(powersOf(a));
  for (const [name, power] of powersOf(b)) powers.set(name, (powers.get(name) ?? 0) + power);
  const left = [...powers].filter(([, power]) => power).sort(([x], [y]) => (x < y ? -1 : 1));
  return left.map((each) => each.join("^")).join(" ");
}
