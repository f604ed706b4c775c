// A text becomes formulas: what each rule of the grammar means.

import { applied, decimal, degree, inverse, isNumber, isZero, letter, negative, number } from "./formula.js";
import { ONE, power, product, size, substituted, sum, ZERO } from "./formula.js";
import { placeOf, treeOf, UnexpectedToken, wordsOf } from "./parser.js";
import { about_token, Words } from "./printed.js";
import { same } from "./proving.js";
import { py, Token, useTables } from "./python.js";

/**
 * @typedef {{tables: any, refusals: Record<string, string>, letters: Map<string, any>, labels: string[]}} Known  what
 *   may stand in a text
 */

/** The words of a text, with names told apart; the last is "END". */
export function wordsIn(/** @type {Known} */ { tables, letters, labels }, text, strict = true) {
  useTables(tables, (plain) => wordsOf(tables, plain));
  return new Words(text, letters, labels, new Map()).tokens(strict);
}

/** The lines of a text: name and formula of each; null for what is no formula of numbers. */
export function read(/** @type {Known} */ known, text) {
  return new Reader(known, text).lines();
}

/** Where a text was refused, counted as JavaScript counts. */
export function placeIn(text, position) {
  return [...text].slice(0, position).join("").length;
}

class Reader {
  constructor(known, text) {
    const { tables, letters, labels } = known;
    useTables(tables, (plain) => wordsOf(tables, plain));
    this.known = known;
    /** @type {any} */
    this.words = new Words(text, letters, labels, new Map());
    const tokens = this.words.tokens();
    try {
      this.tree = treeOf(tables, tokens);
    } catch (error) {
      if (!(error instanceof UnexpectedToken)) throw error;
      this.words.refuse(about_token(error.token, error.accepted), error.token);
    }
    if (!this.tree.children.length) this.refuse("empty", undefined);
    /** @type {Map<string, any[]>} */
    this.sides = new Map();
    for (const { data, children } of this.tree.children) {
      if (data !== "named") continue;
      const [label, ...rest] = children;
      if (this.sides.has(label.value) && this.isNew(label.value)) this.refuse("twice", label, label.value);
      this.sides.set(label.value, pairs(rest).filter(({ equal }) => equal).map(({ side }) => side));
    }
    this.values = new Map();
    /** @type {string[]} */
    this.within = [];
    this.rates = new Set();
  }

  refuse(reason, node, name = "") {
    return this.words.refuse(this.known.refusals[reason].replace("{name}", name), node && placeOf(node).start_pos);
  }

  /** True if a left side is a letter that the text gives a meaning. */
  isNew(label) {
    const { letters, labels } = this.known;
    return !label.split(",").every((part) => letters.has(part) || labels.includes(part));
  }

  lines() {
    const found = this.tree.children.flatMap((line) => this.line(line));
    for (const label of this.sides.keys()) if (this.isNew(label)) this.side(label, this.tree);
    return found;
  }

  line({ data, children: [first, ...rest] }) {
    if (data === "unnamed") return [{ name: "", formula: this.settled(this.value(first), first) }];
    if (data === "named") {
      if (this.isNew(first.value)) return [];
      return pairs(rest).map(({ equal, side }) => {
        const value = this.value(side);
        return equal ? { name: first.value, formula: this.settled(value, side) } : { name: "", formula: null };
      });
    }
    let left = this.value(first);
    return pairs(rest).map(({ equal, side }) => {
      const right = this.value(side);
      const solved = equal && left && right ? this.solved(left, right, side) : { name: "", formula: null };
      left = right;
      return solved;
    });
  }

  /** A formula without a rate that no line gives. */
  settled(value, node) {
    for (const name of this.rates) if (value && holds(value, name)) this.refuse("rate", node, name);
    return value;
  }

  /** An equation solved for the only rate in it. */
  solved(left, right, node) {
    const rates = [...this.rates].filter((name) => holds(left, name) || holds(right, name));
    if (!rates.length) return { name: "", formula: null };
    const difference = sum([left, negative(right)]);
    const [rest, one, two] = [ZERO, ONE, number(2n)].map((x) => substituted(difference, new Map([[rates[0], x]])));
    const slope = sum([one, negative(rest)]);
    const linear = same(sum([two, negative(one)]), slope) && same(slope, ZERO) === false;
    if (rates.length > 1 || !linear) this.refuse("unsolved", node, rates[0]);
    return { name: rates[0], formula: negative(product([rest, inverse(slope)])) };
  }

  /** The value of a line by its name, computed once; the last one of a chain. */
  side(name, node) {
    if (this.within.includes(name)) this.refuse("itself", node, name);
    if (this.within.length >= this.known.tables.limits.power) this.refuse("large", node);
    if (!this.values.has(name)) {
      this.within.push(name);
      const values = (this.sides.get(name) ?? []).map((side) => this.value(side));
      this.values.set(name, values[values.length - 1]);
      this.within.pop();
    }
    return this.values.get(name);
  }

  value(node) {
    const found = node instanceof Token ? this.word(node) : this.ruled(node);
    if (found && size(found) > this.known.tables.limits.size) this.refuse("large", node);
    return found;
  }

  word(node) {
    const { type, value: name } = node;
    if (type === "NUMBER") return decimal(name);
    if (type === "PI") return applied("pi");
    if (this.known.letters.has(name)) return letter(name);
    if (py.t(this.words.column(name))) return null;
    if (this.sides.has(name)) return this.side(name, node);
    if (!this.known.labels.includes(name)) this.refuse("transpose", node);
    this.rates.add(name);
    return letter(name);
  }

  ruled(node) {
    const { [node.data]: rule } = RULES;
    return rule ? rule(this, node, ...node.children) : this.refuse("python", node);
  }

  /** A number's formula. */
  scalar(node) {
    return this.value(node) ?? this.refuse("matrix", node);
  }

  divisor(node) {
    const value = this.scalar(node);
    return isZero(value) ? this.refuse("divisor", node) : value;
  }

  exponent(node) {
    if (node.type !== "RAISED") return this.scalar(node);
    return number(BigInt(node.value.slice(0, 4).normalize("NFKC").replace("−", "-")));
  }

  power(node, base, exponent) {
    const { limits } = this.known.tables;
    if (!isNumber(exponent) || exponent.d > 2n || abs(exponent.n) > BigInt(limits.power) * exponent.d)
      this.refuse("exponent", node);
    const times = Math.abs(Number(exponent.n) / Number(exponent.d));
    if (isZero(base) && exponent.n <= 0n) this.refuse("zero", node);
    const digits = isNumber(base) ? Math.max(`${base.n}`.length, `${base.d}`.length) : 0;
    if (degree(base) * times > limits.degree || digits * times > limits.integer) this.refuse("large", node);
    return power(base, exponent);
  }

  /** Refuse a/b c, but not 1/2 (a + b): behind a number and a blank, a bracket stands beside the fraction. */
  beside(over, part) {
    const [divisor] = over.children;
    const between = this.words.plain.slice(placeOf(divisor).end_pos, placeOf(part).start_pos);
    if (divisor.type !== "NUMBER" || !/^\s+(\\[A-Za-z]+\s*)?[([]/.test(between)) this.refuse("below", part);
  }
}

const abs = (n) => (n < 0n ? -n : n);
const isSign = (part) => part?.type === "MINUS" || part?.type === "PLUS";
const half = number(1n, 2n);

/** Sides of a line with what stands before each. */
function pairs(rest) {
  return rest.filter((_, k) => k % 2).map((side, k) => ({ side, equal: rest[2 * k].children[0].type === "EQUAL" }));
}

function holds({ kind, name, parts }, letter_) {
  return (kind === "letter" && name === letter_) || parts.some((part) => holds(part, letter_));
}

/** Read a matrix, which is no formula of numbers unless it has one entry. */
function listed(reader, entries) {
  const values = entries.map((entry) => reader.value(entry));
  return values.length === 1 ? values[0] : null;
}

const QUOTIENTS = {
  sec: (x) => inverse(applied("cos", x)),
  csc: (x) => inverse(applied("sin", x)),
  cot: (x) => product([applied("cos", x), inverse(applied("sin", x))]),
  coth: (x) => product([applied("cosh", x), inverse(applied("sinh", x))]),
  sqrt: (x) => power(x, half),
};

/** @type {Record<string, (reader: Reader, node: any, ...parts: any[]) => any>} */
const RULES = {
  sum(reader, node, ...parts) {
    const terms = parts.flatMap((part, k) => {
      if (isSign(part)) return [];
      const value = reader.value(part);
      return [value && k && parts[k - 1].type === "MINUS" ? negative(value) : value];
    });
    if (terms.includes(null)) return terms.every((term) => term === null) ? null : reader.refuse("matrix", node);
    return sum(terms);
  },
  product(reader, node, ...parts) {
    const factors = parts.map((part, k) => {
      const before = parts[k - 1];
      if (before?.data === "over" && !["times", "over"].includes(part.data)) reader.beside(before, part);
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
    if (exponent.value === "T" && (!value || !reader.known.letters.has("T"))) return value; // of a number, itself
    return value && reader.power(node, value, reader.exponent(exponent));
  },
  exponential: (reader, node, base, exponent) => applied("exp", reader.scalar(exponent)),
  absolute: (reader, node, inner) => applied("abs", reader.scalar(inner)),
  norm: (reader, node, inner) => applied("abs", reader.scalar(inner)),
  fraction(reader, node, above, below) {
    const [numerator, divisor] = [reader.value(above), reader.divisor(below)];
    return numerator && product([numerator, inverse(divisor)]);
  },
  root: (reader, node, inner) => power(reader.scalar(inner), half),
  function(reader, node, { value: text }, ...parts) {
    const inner = reader.scalar(parts[parts.length - 1]);
    const name = text === "norm" ? "abs" : reader.known.tables.functions[text];
    const value = QUOTIENTS[name]?.(inner) ?? applied(name, inner);
    return parts.length > 1 ? reader.power(node, value, reader.exponent(parts[0])) : value;
  },
  matrix: (reader, node, ...lists) => listed(reader, lists.flatMap(({ children }) => children)),
  listed: (reader, node, ...entries) => listed(reader, entries),
  printed_matrix: (reader, node, ...rows) => listed(reader, rows.flatMap(({ children }) => children)),
};
