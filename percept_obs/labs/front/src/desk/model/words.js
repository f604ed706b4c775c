// Names of a text told apart as `percept_obs.checking.reading` does: letters, labels, functions, letters side by side.

import { CannotRead, wordsOf } from "./parser.js";

/**
 * @typedef {import("./parser.js").Word} Word
 * @typedef {{tables: any, letters: Set<string>, labels: Set<string>}} Known  what may stand in a text
 */

/** A text in plain signs, and from where in it each of them is. */
function plainOf({ replaced }, text) {
  let plain = "";
  /** @type {number[]} */
  const origin = [];
  let at = 0;
  for (const sign of text) {
    const piece = replaced[sign] ?? [...sign.normalize("NFD")].map((part) => replaced[part] ?? part).join("");
    plain += piece;
    for (let k = 0; k < piece.length; k++) origin.push(at);
    at += sign.length;
  }
  return { plain, origin };
}

/** One spelling of a letter's name: v_c1 and v_{c1} are the same letter, yhat1, y1hat and y_1hat too. */
export function keyOf({ accents }, name) {
  const marks = new RegExp(`(?<=[A-Za-z0-9])(?:${accents.join("|")})`, "g");
  const plain = name.replace(/[_{}\s\\]/g, "");
  const found = plain.match(marks) ?? [];
  return plain.replace(marks, "") + found.sort((a, b) => accents.indexOf(a) - accents.indexOf(b)).join("");
}

/** The key of a name, accents at its end. */
function nameOf(tables, text) {
  const { combining } = tables;
  const command = /\\(hat|bar|dot|tilde)/g;
  const accents = [...text.matchAll(command)].map(([, name]) => name);
  for (const sign of text) if (combining[sign]) accents.push(combining[sign]);
  const bare = [...text.replace(/\\(hat|bar|dot|tilde)\b/g, "")];
  const plain = bare.filter((sign) => !combining[sign] && sign !== "'" && sign !== ",").join("");
  return keyOf(tables, plain + accents.join("") + "dot".repeat(text.split("'").length - 1));
}

const MATRICES = { _MATRIX: 1, _CASES: 1, _END_MATRIX: -1, _END_CASES: -1 };

export class Words {
  constructor(/** @type {Known} */ known, text) {
    this.tables = known.tables;
    this.labels = known.labels;
    this.letters = known.letters;
    this.known = new Set(known.letters);
    this.text = text;
    const { plain, origin } = plainOf(this.tables, text);
    this.plain = plain;
    this.origin = origin;
  }

  /** Throw at a word, or at the end of the text. @returns {any} */
  refuse(reason, at, parts = {}) {
    throw new CannotRead(reason, this.origin[at] ?? this.text.length, parts);
  }

  /** Words with names told apart; what is refused stays as it is unless strict. */
  all(strict = true) {
    const { tables, text } = this;
    if (text.length > tables.limits.longest) throw new CannotRead("long", tables.limits.longest);
    /** @type {Word[]} */
    const raw = this.raw();
    /** @type {Word[]} */
    const found = [];
    let [depth, matrices] = [0, 0];
    for (let at = 0; at < raw.length; at++) {
      const word = raw[at];
      const starts = !depth && (!found.length || ["_LINE", "COMMA"].includes(found[found.length - 1].type));
      const label = strict && starts ? this.label(raw.slice(at)) : null;
      if (label) {
        found.push(label);
        at = raw.findIndex(({ type }, k) => k >= at && type === "EQUAL") - 1;
        continue;
      }
      depth += Number(tables.opening.includes(word.type)) - Number(tables.closing.includes(word.type));
      matrices += Number(MATRICES[word.type] ?? 0);
      try {
        if (depth > tables.limits.deepest) this.refuse("deep", word.at);
        if (matrices || !["_ROW", "_CELL"].includes(word.type))
          found.push(...this.toldApart(word, raw[at - 1]?.type ?? "", raw[at + 1]?.type ?? ""));
        else if (word.type === "_ROW") found.push({ ...word, type: "_LINE" });
      } catch (error) {
        if (strict || !(error instanceof CannotRead)) throw error;
        found.push(word);
      }
    }
    return found;
  }

  raw() {
    const { tables, plain } = this;
    const found = () => {
      try {
        return wordsOf(tables, plain);
      } catch (error) {
        if (error instanceof CannotRead) return this.refuse(error.reason, error.at);
        throw error;
      }
    };
    /** @type {Word[]} */
    const words = found();
    words.push({ type: "END", text: "", at: plain.length, end: plain.length });
    return words.map((word) => (word.type === "NAME" ? { ...word, text: nameOf(tables, word.text) } : word));
  }

  /** The left side of a line as one word, if the line begins with one. */
  label(words) {
    const { tables } = this;
    const [first] = words;
    if (!["D_DT", "NAME", "LSQB", "_MATRIX"].includes(first.type)) return null;
    const end = words.findIndex(({ type }) => type === "EQUAL" || type === "_LINE") + 1;
    const begun = words.slice(0, end).filter(({ type }) => type !== "_CELL");
    const kinds = begun.map(({ type, text }) => (type === "NAME" ? `NAME:${text}` : type));
    const line = kinds.join(" ");
    tables.labelled ??= new RegExp(`^(?:${tables.label})$`);
    if (!tables.labelled.test(line)) return null;
    let names = kinds.includes("LPAR") ? ["J"] : [...line.matchAll(/NAME:([A-Za-z0-9]+)/g)].map(([, name]) => name);
    if (kinds.includes("_POWER")) names = [names.join("")];
    const name = names.map((each) => (kinds[0] === "D_DT" ? keyOf(tables, `${each}dot`) : each)).join(",");
    if (!name.split(",").every((part) => this.labels.has(part) || this.known.has(part))) {
      const taken = ["dot", "hat", ","].some((accent) => name.includes(accent)) || tables.functions[name];
      if (taken) this.refuse("line", first.at, { name });
      this.known.add(name);
    }
    return { ...first, type: "LABEL", text: name };
  }

  /** A name as a letter, a function or several letters side by side; what has no meaning is refused. */
  toldApart(word, before, after) {
    const { tables } = this;
    const { limits, functions } = tables;
    let name = word.text;
    if (word.type === "NUMBER" && name.length > limits.number) this.refuse("number", word.at);
    if (word.type === "COMMAND") {
      name = name.replace(/\\operatorname|[^A-Za-z0-9_]/g, "");
      if (!functions[name]) this.refuse("command", word.at, { name });
      return [{ ...word, type: "FUNCTION", text: name }];
    }
    const transpose = name === "T" && ["_POWER", "LBRACE"].includes(before);
    if (word.type !== "NAME" || this.known.has(name) || transpose) return [word];
    const euler = name === "e" && after === "_POWER";
    const kind = euler ? "EULER" : functions[name] ? "FUNCTION" : name === "pi" ? "PI" : "";
    if (kind) return [{ ...word, type: kind }];
    if (name.length > limits.word) this.refuse("longword", word.at);
    const ways = this.split(name);
    if (ways.length === 1) return ways[0].map((part) => ({ ...word, text: keyOf(tables, part) }));
    if (ways.length) this.refuse("ways", word.at, { name });
    return this.refuse("letter", word.at, { name });
  }

  /** Ways to read a word as letters side by side, at most two. */
  split(name) {
    /** @type {string[][][]} */
    const ways = [[[]], ...Array.from(name, () => [])];
    for (let end = 1; end <= name.length; end++) {
      for (let start = 0; start < end; start++)
        if (this.known.has(keyOf(this.tables, name.slice(start, end))))
          ways[end].push(...ways[start].map((way) => [...way, name.slice(start, end)]));
      ways[end] = ways[end].slice(0, 2);
    }
    return ways[name.length];
  }
}
