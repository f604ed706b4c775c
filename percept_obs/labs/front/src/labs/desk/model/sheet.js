// What the page says of a line by itself: the line as mathematics, and a verdict by numbers.

import { compared, compiled, rootsOf, same, secretPoints } from "./judging.js";
import { piecesOf } from "./markup.js";
import { read } from "./reading.js";

/** @typedef {import("./judging.js").Point} Point */

/** Most findings that are kept for a line, and most of its beginnings that are shown; what could not be printed. */
const [KEPT, MOST_TERMS] = [64, 24];
const NOTHING = { kind: "number", n: NaN, parts: [] };

/** The name by which a sheet is found; it holds what the sheet depends on. */
export function sheetName({ student, motion, surface, outputs, observer, part }, own) {
  const whose = own ? "own" : student.trim() ? `student ${student.trim()}` : `${motion} ${surface}`;
  const needed = { rate: [], form: [outputs.join(" ")] }[part] ?? [outputs.join(" "), observer];
  return [whose, part, ...needed].join(", ");
}

/** A sheet whose formulas are read when they are asked for. */
export class Sheet {
  constructor(printed, markup, said) {
    this.printed = printed;
    this.said = said;
    this.markup = { ...markup, ...printed.markup };
    this.known = new Set(printed.known);
    /** @type {Map<string, string>} lines that Python has read, by what is typed */
    this.heard = new Map();
    this.kept = new Map();
    this.printable = new Set([...printed.known, ...Array.from({ length: 40 }, (_, k) => `q${k + 1}`)]);
    /** @type {{name: string, key: string, label: string, formula: string}[]} */
    this.lines = printed.steps.flatMap(({ lines }) => lines);
    /** @returns {[string, any][]} */
    const all = (formulas) => Object.entries(formulas).map(([name, text]) => [name, this.formula(text)]);
    this.meant = all(printed.meant);
    this.conventions = printed.conventions.map(({ words, changes }) => ({ words, changes: all(changes) }));
    this.free = printed.known.filter((name) => !(name in printed.meant));
  }

  /** What was once found, by what it was made of. */
  once(key, make) {
    if (this.kept.size > KEPT * this.lines.length) this.kept.clear();
    if (!this.kept.has(key)) this.kept.set(key, make());
    return this.kept.get(key);
  }

  /** A formula that Python has printed. */
  formula(text) {
    const { tree = NOTHING } = read(text, this.printable);
    return { tree, value: compiled(tree) };
  }

  /** The formula that a line should be. */
  asked(row) {
    return this.once(`asked ${row}`, () => this.formula(this.lines[row].formula));
  }

  /** A point with other values of some letters, and with the letters whose meaning is given. @returns {Point} */
  changed(/** @type {Point} */ at, changes = /** @type {[string, any][]} */ ([])) {
    const point = new Map(at);
    for (const [name, { value }] of changes) point.set(name, value(at)[0]);
    for (const [name, { value }] of this.meant) point.set(name, value(point)[0]);
    return point;
  }

  points(row) {
    return this.once(`points ${row}`, () => secretPoints(this.free, this.asked(row).value, (at) => this.changed(at)));
  }

  /** Rows of a step, which is counted from 1. */
  rows(step) {
    const { steps } = this.printed;
    const first = steps.slice(0, step - 1).flatMap(({ lines }) => lines).length;
    return steps[step - 1].lines.map((_, k) => first + k);
  }

  /** Keys of the lines in the settings. */
  keys(part) {
    return this.printed.steps.flatMap(({ lines }, k) => lines.map(({ name }) => `${part} ${k + 1} ${name}`));
  }

  /** Take the lines of a step as Python has read them. */
  hear(lines, { part, step, typed }) {
    const keys = this.keys(part);
    const rows = this.rows(Math.min(step, this.printed.steps.length));
    rows.forEach((row, k) => lines[k]?.plain && this.heard.set(`${row} ${typed[keys[row]]}`, lines[k].plain));
  }

  /** A line that somebody typed, as a formula; else where it was no plain arithmetic. */
  entry(row, text) {
    const found = this.readIn(row, text);
    return found.tree ? found : this.readIn(row, this.heard.get(`${row} ${text}`) ?? text);
  }

  readIn(row, text) {
    return this.once(`entry ${row} ${text}`, () => {
      const { name, key } = this.lines[row];
      const left = text.indexOf("=") + 1;
      const from = [name, key].includes(text.slice(0, Math.max(left - 1, 0)).replace(/[\s_]/g, "")) ? left : 0;
      const { tree, terms, position = 0 } = read(text.slice(from), this.known);
      const parts = terms.map(({ part }) => part);
      const begun = terms.slice(0, MOST_TERMS).map(({ at }, k) => {
        const beginning = k ? { kind: "sum", parts: parts.slice(0, k + 1) } : parts[0];
        return { tree: beginning, value: compiled(beginning), end: text.slice(0, from + at).trimEnd().length };
      });
      return { tree, value: tree && compiled(tree), position: from + position, begun };
    });
  }

  /** Whether a line is a formula of this sheet: the one that is asked for, or that in another convention. */
  compare(row, { tree, value }, truth = this.asked(row).value) {
    const roots = [this.asked(row), ...this.meant.map(([, each]) => each)].flatMap((each) => rootsOf(each.tree));
    return same(tree, value, truth, roots, this.points(row));
  }

  /** A line that can be read, with its mark, a note, and how it differs; undefined for any other. */
  judged(row, text) {
    const entry = this.entry(row, text);
    const asked = this.asked(row);
    return entry.tree && this.once(`judged ${row} ${text}`, () => {
      const right = this.compare(row, entry);
      const none = { row, note: "", lacks: 0, wrong: [], times: NaN };
      if (right !== false) return { ...none, mark: right ? "right" : "unknown" };
      const letters = new Set(namesIn(asked.tree));
      const convention = this.conventions.find(({ changes }) => {
        // one letter alone with the other sign is a slip
        const several = changes.filter(([name]) => letters.has(name)).length > 1;
        return several && this.compare(row, entry, (at) => asked.value(this.changed(at, changes)));
      });
      if (convention) return { ...none, mark: "right", note: convention.words };
      return { ...none, mark: "wrong", ...compared(entry.tree, asked.tree, this.points(row)) };
    });
  }

  /** What follows from the typed lines of a step for a line of its result; undefined if nothing is known. */
  followed(step, texts, row) {
    const { [row]: text } = this.printed.steps[step - 1].onward;
    const values = this.rows(step).map((r) => (texts.has(r) ? this.entry(r, texts.get(r)) : this.asked(r)));
    if (text === undefined || values.some(({ value }) => !value)) return undefined;
    const onward = this.once(`onward ${step} ${row}`, () => this.formula(text));
    /** @type {[string, any][]} */
    const changes = values.map((each, k) => [`q${k + 1}`, each]);
    return { value: (at) => onward.value(this.changed(at, changes)) };
  }

  /** A formula as mathematics; nothing of one that could not be read. */
  pieces(tree, wrong) {
    return tree ? piecesOf(tree, this.markup, wrong) : [];
  }
}

const namesIn = ({ kind, name, parts }) => (kind === "name" ? [name] : parts.flatMap(namesIn));
