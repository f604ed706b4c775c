// @ts-nocheck
// Python's own functions and methods, as far as the reader uses them, for what Python prints of it (printed.js).
// Lists and tuples are arrays, dictionaries Maps, tokens texts with a kind and a place.

/** A text that is no formula: why, and where, counted in characters from 0. */
export class CannotRead extends Error {
  constructor(text, position, message) {
    super(message);
    this.position = position;
  }
}

/** A sign of which no word of a formula begins. */
export class UnexpectedCharacters extends Error {
  constructor(at) {
    super("unexpected character");
    this.pos_in_stream = at;
  }
}

/** A word of a formula. */
export class Token {
  constructor(type, value, start, given = {}) {
    this.type = type;
    this.value = value;
    this.start_pos = start;
    this.end_pos = given.end_pos ?? null;
  }

  update({ type = this.type, value = this.value }) {
    return new Token(type, value, this.start_pos, { end_pos: this.end_pos });
  }

  toString() {
    return this.value;
  }
}

const plain = (x) => (x instanceof Token ? x.value : x);
const isText = (x) => typeof x === "string" || x instanceof Token;

/** A slice of a list or a text. */
class Slice {
  constructor(start, stop, step) {
    Object.assign(this, { start, stop, step });
  }
}

/** A regular expression with Python's methods. */
class Pattern {
  constructor(pattern) {
    this.pattern = pattern;
  }

  made(flags, around = (text) => text) {
    return new RegExp(around(this.pattern ?? lexer.tables.constants[this.name]), flags);
  }

  get all() {
    this.compiled ??= this.made("g");
    this.compiled.lastIndex = 0;
    return this.compiled;
  }

  search(text) {
    return matched(this.all.exec(plain(text)));
  }

  match(text, start = 0) {
    const sticky = (this.sticky ??= this.made("y"));
    sticky.lastIndex = start;
    return matched(sticky.exec(plain(text)));
  }

  fullmatch(text) {
    return matched((this.whole ??= this.made("", (pattern) => `^(?:${pattern})$(?![^])`)).exec(plain(text)));
  }

  finditer(text) {
    return [...plain(text).matchAll(this.all)].map(matched);
  }

  findall(text) {
    return [...plain(text).matchAll(this.all)].map((found) => {
      if (found.length === 1) return found[0];
      return found.length === 2 ? (found[1] ?? "") : found.slice(1).map((part) => part ?? "");
    });
  }

  sub(by, text, { count = Infinity } = {}) {
    let left = count;
    const put = typeof by === "function" ? (found) => by(found) : (found) => filled(plain(by), found);
    return plain(text).replace(this.all, (...parts) => {
      if (left-- <= 0) return parts[0];
      const groups = parts.slice(0, parts.findIndex((part) => typeof part === "number"));
      const at = parts[groups.length];
      return plain(put(new Match(groups, at)));
    });
  }

  split(text) {
    return plain(text).split(this.all);
  }
}

const filled = (by, found) =>
  by.replace(/\\(\d|\\)/g, (_, which) => (which === "\\" ? "\\" : (found.parts[which] ?? "")));

class Match {
  constructor(parts, at) {
    this.parts = parts;
    this.at = at;
  }

  groups() {
    return this.parts.slice(1).map((part) => part ?? null);
  }

  start() {
    return this.at;
  }

  end() {
    return this.at + this.parts[0].length;
  }

  span() {
    return [this.start(), this.end()];
  }
}

const matched = (found) => found && new Match([...found], found.index);

/** @type {Map<string, Pattern>} */
const PATTERNS = new Map();

function pattern(text) {
  if (text instanceof Pattern) return text;
  if (!PATTERNS.has(text)) PATTERNS.set(text, new Pattern(text));
  return /** @type {Pattern} */ (PATTERNS.get(text));
}

const place = (k, size) => (k < 0 ? k + size : k);

function sliced(x, { start, stop, step }) {
  const values = plain(x);
  if (step !== null) throw new Error("no slice with steps");
  return values.slice(start ?? 0, stop ?? values.length);
}

/** @type {Record<string, (x: any, ...given: any[]) => any>} */
const METHODS = {
  strip: (x, signs) => METHODS.rstrip(METHODS.lstrip(x, signs), signs),
  lstrip: (x, signs) => trimmed(plain(x), signs, 0),
  rstrip: (x, signs) => trimmed(plain(x), signs, -1),
  split: (x, by) => (x instanceof Pattern ? x.split(by) : plain(x).split(by)),
  join: (x, parts) => [...py.iter(parts)].map(plain).join(plain(x)),
  startswith: (x, begin) => [begin].flat().some((each) => plain(x).startsWith(each)),
  endswith: (x, end) => [end].flat().some((each) => plain(x).endsWith(each)),
  removesuffix: (x, end) => (end && plain(x).endsWith(end) ? plain(x).slice(0, -end.length) : plain(x)),
  removeprefix: (x, begin) => (plain(x).startsWith(begin) ? plain(x).slice(begin.length) : plain(x)),
  replace: (x, one, other, count) => {
    const [text, by] = [plain(x), plain(other)];
    return count === 1 ? text.replace(one, () => by) : text.replaceAll(one, () => by);
  },
  isdigit: (x) => /^\d+$/.test(plain(x)),
  isalpha: (x) => /^\p{L}+$/u.test(plain(x)),
  isspace: (x) => /^\s+$/.test(plain(x)),
  isascii: (x) => /^[\0-\x7f]*$/.test(plain(x)),
  lower: (x) => plain(x).toLowerCase(),
  count: (x, part) => (isText(x) ? plain(x).split(part).length - 1 : x.filter((each) => py.eq(each, part)).length),
  index: (x, part) => (isText(x) ? plain(x).indexOf(plain(part)) : x.findIndex((each) => py.eq(each, part))),
  append: (x, value) => void x.push(value),
  pop: (x, k) => (k === undefined ? x.pop() : x.splice(place(k, x.length), 1)[0]),
  items: (x) => [...x.entries()],
  values: (x) => [...x.values()],
  get: (x, key, other = null) => (x.has(plain(key)) ? x.get(plain(key)) : other),
  setdefault(x, key, other = null) {
    if (!x.has(plain(key))) x.set(plain(key), other);
    return x.get(plain(key));
  },
  add: (x, value) => void x.add(plain(value)),
  fromkeys: (x, keys, value = null) => new Map([...py.iter(keys)].map((key) => [plain(key), value])),
};

function trimmed(text, signs, at) {
  const gone = (sign) => sign !== undefined && (signs === undefined ? /\s/.test(sign) : signs.includes(sign));
  while (gone(text.at(at))) text = at ? text.slice(0, -1) : text.slice(1);
  return text;
}

const BOUND = new WeakMap();
/** Dictionaries that are filled once the tables are there. */
const FILLED = new Map();

export const py = {
  /** Python's truth of a value. */
  t(x) {
    if (x === null || x === undefined || x === false || x === 0 || x === "") return false;
    if (Array.isArray(x)) return x.length > 0;
    if (x instanceof Token) return x.value !== "";
    return x instanceof Map || x instanceof Set ? x.size > 0 : true;
  },
  every(first, ...rest) {
    let value = first;
    for (const next of rest) {
      if (!py.t(value)) return value;
      value = next();
    }
    return value;
  },
  some(first, ...rest) {
    let value = first;
    for (const next of rest) {
      if (py.t(value)) return value;
      value = next();
    }
    return value;
  },
  eq(one, other) {
    const [a, b] = [plain(one), plain(other)];
    if (Array.isArray(a) && Array.isArray(b)) return a.length === b.length && a.every((each, k) => py.eq(each, b[k]));
    if (a instanceof Set && b instanceof Set) return a.size === b.size && [...a].every((each) => b.has(each));
    return a === b || (typeof a === "boolean" && Number(a) === b) || (typeof b === "boolean" && Number(b) === a);
  },
  is: (one, other) => (one ?? null) === (other ?? null),
  in(x, all) {
    if (isText(all)) return plain(all).includes(plain(x));
    if (all instanceof Map || all instanceof Set) return all.has(plain(x));
    return [...all].some((each) => py.eq(each, x));
  },
  compare(one, sign, other) {
    if (one instanceof Set) return sign === "<=" ? [...one].every((each) => other.has(each)) : null;
    return { "<": one < other, "<=": one <= other, ">": one > other, ">=": one >= other }[sign];
  },
  add: (one, other) => (Array.isArray(one) ? [...one, ...other] : plain(one) + plain(other)),
  iadd(one, other) {
    if (!Array.isArray(one)) return plain(one) + plain(other);
    for (const each of [...py.iter(other)]) one.push(each);
    return one;
  },
  mul(one, other) {
    const isNumber = (x) => typeof x === "number" || typeof x === "boolean";
    if (isNumber(one) && isNumber(other)) return Number(one) * Number(other);
    const [value, count] = isText(one) || Array.isArray(one) ? [one, other] : [other, one];
    const times = Math.max(Number(count), 0);
    return isText(value) ? plain(value).repeat(times) : Array.from({ length: times }, () => value).flat();
  },
  sub: (one, other) =>
    one instanceof Set ? new Set([...one].filter((each) => !other.has(each))) : Number(one) - Number(other),
  or: (one, other) => (one instanceof Map ? new Map([...one, ...other]) : new Set([...one, ...py.iter(other)])),
  key: plain,
  pattern,
  /** A dictionary or a regular expression that is among the tables. */
  constant(name, isMap) {
    const made = isMap ? new Map() : Object.assign(new Pattern(null), { name });
    if (isMap) FILLED.set(name, made);
    return made;
  },
  slice: (start, stop, step) => new Slice(start, stop, step),
  item(x, k) {
    if (k instanceof Slice) return sliced(x, k);
    if (x instanceof Match) return x.parts[k] ?? null;
    if (x instanceof Map) return x.get(plain(k));
    const values = plain(x);
    return values[place(k, values.length)];
  },
  put(x, k, value) {
    const { start, stop } = k;
    if (k instanceof Slice) x.splice(start ?? 0, Math.max((stop ?? x.length) - (start ?? 0), 0), ...py.iter(value));
    else if (x instanceof Map) x.set(plain(k), value);
    else x[place(k, x.length)] = value;
  },
  del(x, k) {
    if (k instanceof Slice) {
      const start = place(k.start ?? 0, x.length);
      x.splice(start, (k.stop === null ? x.length : place(k.stop, x.length)) - start);
    } else if (x instanceof Map) x.delete(plain(k));
    else x.splice(place(k, x.length), 1);
  },
  *gen(x, make, keeps = () => true) {
    for (const each of py.iter(x)) if (keeps(each)) yield make(each);
  },
  iter: (x) => (x instanceof Map ? x.keys() : plain(x)),
  methods: METHODS,
  /** A method of an object, the same one each time. */
  bound(owner, name) {
    const known = BOUND.get(owner) ?? new Map();
    BOUND.set(owner, known);
    if (!known.has(name)) known.set(name, owner[name].bind(owner));
    return known.get(name);
  },
  str: (x = "") => (x === null ? "None" : x.name ?? String(plain(x))),
  repr: (x) => `'${plain(x)}'`,
  len: (x) => (x instanceof Map || x instanceof Set ? x.size : plain(x).length),
  list: (x = []) => [...py.iter(x)],
  set_: (x = []) => new Set([...py.iter(x)].map(plain)),
  dict: (x = []) => Object.assign(new Map([...(x instanceof Map ? x : py.iter(x))]), {}),
  bool: (x) => py.t(x),
  int: (x) => Number.parseInt(plain(x), 10),
  any: (x) => [...py.iter(x)].some(py.t),
  all: (x) => [...py.iter(x)].every(py.t),
  sum: (x) => [...x].reduce((all, each) => all + Number(each), 0),
  max: (...x) => Math.max(...(x.length === 1 ? x[0] : x)),
  min: (...x) => Math.min(...(x.length === 1 ? x[0] : x)),
  sorted: (x) => [...py.iter(x)].sort((a, b) => (a < b ? -1 : Number(a > b))),
  reversed: (x) => [...py.iter(x)].reverse(),
  zip(...all) {
    const rows = all.map((x) => [...py.iter(x)]);
    const size = Math.min(...rows.map((row) => row.length));
    return Array.from({ length: size }, (_, k) => rows.map((row) => row[k]));
  },
  pairwise: (x) => py.zip(x, [...py.iter(x)].slice(1)),
  enumerate: (x, first = 0) => [...py.iter(x)].map((each, k) => [k + first, each]),
  range(first, last, step = 1) {
    const [start, stop] = last === undefined ? [0, first] : [first, last];
    return Array.from({ length: Math.max(Math.ceil((stop - start) / step), 0) }, (_, k) => start + k * step);
  },
  next(x, ...other) {
    const { value, done } = x.next();
    if (done && !other.length) throw new Error("StopIteration");
    return done ? other[0] : value;
  },
  map: (make, ...x) => py.zip(...x).map((each) => make(...each)),
  isinstance: (x, kind) => x instanceof kind,
  hasattr: (x, name) => x !== null && typeof x === "object" && name in x,
  re: {
    compile: pattern,
    search: (text, x) => pattern(text).search(x),
    match: (text, x) => pattern(text).match(x),
    fullmatch: (text, x) => pattern(text).fullmatch(x),
    findall: (text, x) => pattern(text).findall(x),
    sub: (text, by, x, given) => pattern(text).sub(by, x, given),
    split: (text, x) => pattern(text).split(x),
  },
  unicodedata: {
    normalize: (form, x) => plain(x).normalize(form),
    name(x, other = "") {
      if (/[\u{1D400}-\u{1D7FF}]/u.test(x)) return "MATHEMATICAL";
      return other && `U+${x.codePointAt(0).toString(16)}`;
    },
  },
  difflib: { get_close_matches: () => [] },
};

/** @type {{tables: any, words: (text: string) => any[]}} what reads words, once the tables are there */
const lexer = { tables: null, words: () => [] };

/** Let words be read by these tables. */
export function useTables(tables, words) {
  Object.assign(lexer, { tables, words });
  for (const [name, known] of FILLED)
    if (!known.size) for (const [key, value] of Object.entries(tables.constants[name])) known.set(key, value);
}

export const lexed = (text) => lexer.words(plain(text));
export const _terminal = (name) => pattern(lexer.tables.layout[name]);

const ACCENTS = ["hat", "bar", "tilde", "dot"];
const MARKS = /(?<=[A-Za-z0-9])(?:hat|bar|tilde|dot)/g;

/** One spelling of a letter's name: v_c1 and v_{c1} are the same letter, yhat1, y1hat and y_1hat too. */
export function key(name) {
  const bare = plain(name).replace(/[_{}\s\\]/g, "");
  const marks = bare.match(MARKS) ?? [];
  return bare.replace(MARKS, "") + marks.sort((a, b) => ACCENTS.indexOf(a) - ACCENTS.indexOf(b)).join("");
}

/** A letter that may stand in a formula. */
class Letter {
  is_Symbol = true;

  constructor(name) {
    this.name = name;
  }
}

/** As far as words ask for it: which letters are of numbers. */
export const sp = { Expr: Letter, MatrixExpr: class {}, Symbol: (name) => new Letter(name), oo: new Letter("oo") };
