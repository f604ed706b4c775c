// A text becomes formulas: what each rule of the grammar means.

import { CannotRead, treeOf } from "./parser.js";
import { Words } from "./words.js";
import { applied, decimal, degree, inverse, isNumber, isZero, letter } from "./formula.js";
import { negative, number, power, product, sum } from "./formula.js";

/** The lines of a text: name and formula of each; null for what is no formula of numbers. */
export function read(known, text) {
  return new Reader(known, text).lines();
}

class Reader {
  constructor(known, text) {
    this.words = new Words(known, text);
    this.known = known;
    this.limits = known.tables.limits;
    /** @type {Map<string, any>} */
    this.meant = new Map([...known.letters].map((name) => [name, letter(name)]));
  }

  lines() {
    const { words, known } = this;
    let tree;
    try {
      tree = treeOf(known.tables, words.all());
    } catch (error) {
      if (error instanceof CannotRead && error.reason === "word") words.refuse("word", error.at, error.parts);
      throw error;
    }
    if (!tree.parts.length) words.refuse("empty", undefined);
    return tree.parts.flatMap((line) => this.value(line));
  }

  refuse(reason, { at }) {
    return this.words.refuse(reason, at);
  }

  value(node) {
    if (node.rule) {
      const { [node.rule]: rule } = RULES;
      if (!rule) this.refuse("python", node);
      return rule(this, node, ...node.parts);
    }
    if (node.type === "NUMBER") return decimal(node.text);
    if (node.type === "PI") return applied("pi");
    return this.meant.has(node.text) ? this.meant.get(node.text) : this.refuse("transpose", node);
  }

  /** A number's formula. */
  scalar(node) {
    return this.value(node) ?? this.refuse("matrix", node);
  }

  divisor(node) {
    const value = this.scalar(node);
    return isZero(value) ? this.refuse("divisor", node) : value;
  }

  power(node, base, exponent) {
    const { limits } = this;
    if (!isNumber(exponent) || exponent.d > 2n || abs(exponent.n) > BigInt(limits.power) * exponent.d)
      this.refuse("exponent", node);
    const size = Math.abs(Number(exponent.n) / Number(exponent.d));
    if (isZero(base) && exponent.n <= 0n) this.refuse("zero", node);
    const digits = isNumber(base) ? Math.max(`${base.n}`.length, `${base.d}`.length) : 0;
    if (degree(base) * size > limits.degree || digits * size > limits.integer) this.refuse("large", node);
    return power(base, exponent);
  }
}

const abs = (n) => (n < 0n ? -n : n);
const isMinus = ({ type }) => type === "MINUS";
const isSign = (part) => part?.type === "MINUS" || part?.type === "PLUS";

/** Read a matrix, which is no formula of numbers. */
function listed(reader, entries) {
  for (const entry of entries) reader.value(entry);
  return null;
}

/** @type {Record<string, (reader: Reader, node: any, ...parts: any[]) => any>} */
const RULES = {
  named(reader, node, { text: name }, ...sides) {
    const values = sides.map((side) => reader.value(side));
    const { labels, letters } = reader.known;
    if (name.split(",").every((part) => labels.has(part) || letters.has(part)))
      return values.map((formula) => ({ name, formula }));
    reader.meant.set(name, values[values.length - 1]);
    return [];
  },
  unnamed: (reader, node, side) => [{ name: "", formula: reader.value(side) }],
  equation: (reader, node, left, right) => {
    reader.value(left);
    reader.value(right);
    return [{ name: "", formula: null }];
  },
  relation: (reader, node, left, sign, right) => {
    reader.scalar(left);
    reader.scalar(right);
    return [{ name: "", formula: null }];
  },
  sum(reader, node, ...parts) {
    const terms = parts.flatMap((part, k) => {
      if (isSign(part)) return [];
      const value = reader.value(part);
      return [value && k && isMinus(parts[k - 1]) ? negative(value) : value];
    });
    if (terms.includes(null)) return terms.every((term) => term === null) ? null : reader.refuse("matrix", node);
    return sum(terms);
  },
  product(reader, node, ...parts) {
    const factors = parts.map((part, k) => {
      if (k && parts[k - 1].rule === "over" && !["times", "over"].includes(part.rule)) reader.refuse("below", part);
      return reader.value(part);
    });
    return factors.includes(null) ? null : product(factors);
  },
  times: (reader, node, factor) => reader.value(factor),
  over: (reader, node, factor) => inverse(reader.divisor(factor)),
  negative(reader, node, sign, factor) {
    const value = reader.value(factor);
    return value && negative(value);
  },
  raised(reader, node, base, exponent) {
    const value = reader.value(base);
    if (value === null) return null;
    if (exponent.type === "RAISED") {
      const digits = exponent.text.normalize("NFKC").slice(0, 4);
      return reader.power(node, value, number(BigInt(digits)));
    }
    return reader.power(node, value, reader.scalar(exponent));
  },
  exponential: (reader, node, base, exponent) => applied("exp", reader.scalar(exponent)),
  absolute: (reader, node, inner) => applied("abs", reader.scalar(inner)),
  fraction(reader, node, above, below) {
    const [numerator, divisor] = [reader.value(above), reader.divisor(below)];
    return numerator && product([numerator, inverse(divisor)]);
  },
  root: (reader, node, inner) => power(reader.scalar(inner), number(1n, 2n)),
  function(reader, node, { text }, ...parts) {
    const inner = reader.scalar(parts[parts.length - 1]);
    const name = reader.known.tables.functions[text];
    const value = name === "sqrt" ? power(inner, number(1n, 2n)) : applied(name, inner);
    return parts.length > 1 ? reader.power(node, value, reader.scalar(parts[0])) : value;
  },
  matrix: (reader, node, ...entries) => listed(reader, entries),
  printed_matrix: (reader, node, ...rows) => listed(reader, rows.flatMap(({ parts }) => parts)),
};
