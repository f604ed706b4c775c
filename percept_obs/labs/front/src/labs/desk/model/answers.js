// What the page says of a sheet by itself: lines as mathematics, verdicts, and how the image moves by them.

import { CannotRead, sp } from "./python.js";
import { placeIn, read, wordsIn } from "./reading.js";
import { substituted } from "./formula.js";
import { lacking } from "./polynomials.js";
import { same } from "./proving.js";
import { markupOf } from "./markup.js";
import { grownOf, pictureOf } from "./arrows.js";

const [WRONG, RIGHT] = ["wrong", "right"];
/** The last hint; Python says whether there is one. */
const LAST = 4;

/** The name by which a sheet is found; it holds what the sheet depends on. */
export function sheetName({ student, motion, surface, outputs, observer, part }, own) {
  const whose = own ? "own" : student.trim() ? `student ${student.trim()}` : `${motion} ${surface}`;
  const needed = { rate: [], form: [outputs.join(" ")] }[part] ?? [outputs.join(" "), observer];
  return [whose, part, ...needed].join(", ");
}

/** Words with values in place of what stands in braces. */
const filled = (text, values) => text.replace(/\{(\w+)\}/g, (_, name) => values[name]);

const KEPT = 64;

/** A sheet whose formulas are read when they are asked for. */
export class Sheet {
  constructor(printed, { tables, letters }, said) {
    this.printed = printed;
    this.said = said;
    this.markups = { ...letters, ...printed.markup };
    const { labels } = printed;
    const lettersOf = (names) => new Map(names.map((name) => [name, sp.Symbol(name)]));
    const known = (names) => ({ tables, refusals: said.refusals, letters: lettersOf(names), labels });
    this.known = known(printed.known);
    this.anything = known([...printed.known, ...Array.from({ length: 40 }, (_, k) => `q${k + 1}`)]);
    this.meant = new Map();
    for (const [name, text] of Object.entries(printed.meant)) this.meant.set(name, this.formula(text));
    this.conventions = printed.conventions.map(({ words, changes }) => ({
      words,
      changes: new Map(Object.entries(changes).map(([name, text]) => [name, this.formula(text)])),
    }));
    /** @type {{name: string, key: string, label: string, formula: string}[]} */
    this.lines = printed.steps.flatMap(({ lines }) => lines);
    this.kept = new Map();
  }

  /** What was once found, by what it was made of. */
  once(key, make) {
    if (!this.kept.has(key)) {
      if (this.kept.size > KEPT * this.lines.length) this.kept.clear();
      this.kept.set(key, make());
    }
    return this.kept.get(key);
  }

  /** A printed formula; null where only Python reads it. */
  formula(text) {
    try {
      return read(this.anything, text)[0].formula;
    } catch (error) {
      if (error instanceof CannotRead) return null;
      throw error;
    }
  }

  /** The formula that a line should be. */
  asked(row) {
    return this.once(`asked ${row}`, () => this.formula(this.lines[row].formula));
  }

  /** Rows of a step, which is counted from 1. */
  rows(step) {
    const { steps } = this.printed;
    const first = steps.slice(0, step - 1).reduce((all, { lines }) => all + lines.length, 0);
    return steps[step - 1].lines.map((_, k) => first + k);
  }

  /** A line that somebody typed: as mathematics, and as a formula or why it is none. */
  entry(row, text) {
    return this.once(`entry ${row} ${text}`, () => {
      const { said, lines } = this;
      let markup = "";
      try {
        markup = markupOf(wordsIn(this.known, text, false), this.markups);
        const found = read(this.known, text);
        if (found.length !== 1 || !found[0].formula)
          return { markup, refusal: said["one formula"], position: text.length };
        if (!["", lines[row].key].includes(found[0].name))
          return { markup, refusal: filled(said["other line"], { name: lines[row].name }), position: 0 };
        return { markup, formula: found[0].formula };
      } catch (error) {
        if (!(error instanceof CannotRead)) throw error;
        return { markup, refusal: error.message, position: placeIn(text, error.position) };
      }
    });
  }

  /** The verdict on a line by itself: true, false, or null. */
  verdict(row, text) {
    return this.once(`verdict ${row} ${text}`, () => {
      const { formula } = this.entry(row, text);
      if (!formula) return undefined;
      return this.asked(row) && same(formula, this.asked(row), this.meant);
    });
  }

  /** How many terms a line lacks that is right as far as it goes; 0 for any other. */
  missing(row, text) {
    const found = () => lacking(this.entry(row, text).formula, this.asked(row), this.meant);
    return this.once(`missing ${row} ${text}`, found);
  }

  /** Words of another convention by which all these lines are right; empty if there is none. */
  convention(texts) {
    const letters = new Set([...texts.keys()].flatMap((row) => lettersOf(this.asked(row))));
    const found = this.conventions.find(({ changes }) => {
      // one letter alone with the other sign is a slip
      const several = [...changes.keys()].filter((name) => letters.has(name)).length > 1;
      const other = (row) => substituted(this.asked(row), changes);
      return several && [...texts].every(([row, text]) => same(this.entry(row, text).formula, other(row), this.meant));
    });
    return found?.words ?? "";
  }

  /** What follows from the typed lines of a step for a line of its result; undefined if nothing is known. */
  followed(step, texts, row) {
    const { [row]: text } = this.printed.steps[step - 1].onward;
    if (text === undefined) return undefined;
    const values = this.rows(step).map((r) => (texts.has(r) ? this.entry(r, texts.get(r)).formula : this.asked(r)));
    if (values.some((value) => !value)) return undefined;
    const onward = this.once(`onward ${step} ${row}`, () => this.formula(text));
    return substituted(onward, new Map(values.map((value, k) => [`q${k + 1}`, value])));
  }

  /** Words that say from which wrong step a line follows; empty if from none. */
  carriedFrom(row, text, texts) {
    const own = this.entry(row, text).formula;
    const step = this.printed.steps.findIndex((_, k) => {
      const rows = this.rows(k + 1);
      const wrong = rows.some((r) => r < row && texts.has(r) && this.verdict(r, texts.get(r)) === false);
      const follows = wrong && !rows.includes(row) && this.followed(k + 1, texts, row);
      return follows && same(own, follows, this.meant);
    });
    return step < 0 ? "" : filled(this.said.follows, { reason: this.printed.steps[step].reason });
  }
}

function lettersOf({ kind, name, parts }) {
  return kind === "letter" ? [name] : parts.flatMap(lettersOf);
}

/** The answer to a sheet with these settings, as Python gives it but for hints that name slips, which `alone` says. */
export function answerTo(/** @type {Sheet} */ sheet, settings, alone) {
  const { printed, lines } = sheet;
  const title = `${printed.title}, ${(printed.outputs ?? settings.outputs).join(" and ")} measured`;
  const { part } = settings;
  const step = Math.min(settings.step, printed.steps.length);
  const keys = printed.steps.flatMap(({ lines: each }, k) => each.map(({ name }) => `${part} ${k + 1} ${name}`));
  const texts = keys.map((key) => settings.typed[key] ?? "");
  /** @type {Map<number, string>} */
  const typed = new Map([...texts.entries()].filter(([, text]) => text.trim()));
  const rows = sheet.rows(step);
  const judged = judgedIn(sheet, rows, typed);
  const given = settings.hints[`${part} ${step}`] ?? 0;
  const opened = !given && judged.length === 1 && alone ? 1 : given; // the only line is the wrong one
  const wrong = judged.filter(({ mark }) => mark === WRONG);
  const summary = summaryOf(sheet, judged, rows.length);
  if (alone && opened && wrong.some(({ lacks }) => !lacks)) summary.words += ` ${sheet.said.alone}`;
  const begun = wrong.filter(({ lacks }) => lacks);
  const marked = opened > 0 || !wrong.length || begun.length === wrong.length;
  const found = new Map(judged.map((line) => [line.row, line]));
  const line = (row) => {
    if (!typed.has(row)) return { markup: "", mark: "", told: [] };
    const { markup, refusal, position } = sheet.entry(row, typed.get(row));
    if (refusal) return { markup, mark: "", told: [], refusal, position };
    const { mark, note, lacks } = /** @type {any} */ (found.get(row));
    const shown = mark === WRONG && lacks && opened < 2 ? "begun" : mark;
    return { markup, mark: marked ? shown : "", told: opened && note ? [[{ text: note }]] : [] };
  };
  const following = !opened && judged.length === 1 ? 2 : opened + 1;
  const grown = rows.filter((row) => typed.has(row)).map((row) => {
    return [keys[row], grownOf(sheet, row, typed.get(row), settings.point)];
  });
  return {
    title,
    given: printed.given,
    letters: printed.letters.map((name) => sheet.markups[name]),
    steps: printed.steps.map(({ reason, name }, k) => ({ reason, name, ...stateOf(sheet, sheet.rows(k + 1), typed) })),
    step,
    lines: rows.map((row) => ({ ...lines[row], key: keys[row], ...line(row) })),
    ...summary,
    hint: wrong.length && following < (alone ? 2 : LAST) ? following : 0,
    says: sheet.said.hints[following - 1],
    picture: pictureOf(sheet, step, typed, settings.point),
    grown: Object.fromEntries(grown),
  };
}

/** Each typed line of a step that can be read, with its mark, a note, and how many terms it lacks. */
export function judgedIn(sheet, rows, typed) {
  const texts = new Map([...typed].filter(([row, text]) => rows.includes(row) && sheet.entry(row, text).formula));
  const verdicts = new Map([...texts].map(([row, text]) => [row, sheet.verdict(row, text)]));
  const words = [...verdicts.values()].includes(false) ? sheet.convention(texts) : "";
  return [...texts].map(([row, text]) => {
    const right = verdicts.get(row);
    if (right !== false) return { row, mark: right ? RIGHT : "unknown", note: "", lacks: 0 };
    if (words) return { row, mark: RIGHT, note: words, lacks: 0 };
    const note = sheet.carriedFrom(row, text, typed);
    return { row, mark: note ? "carried" : WRONG, note, lacks: note ? 0 : sheet.missing(row, text) };
  });
}

/** The verdict on a step in a sentence that names no line. */
function summaryOf({ said }, judged, asked) {
  const count = judged.length;
  if (!count) return { words: "", right: null };
  const wrong = judged.filter(({ mark }) => mark === WRONG);
  if (wrong.length && wrong.every(({ lacks }) => lacks)) {
    const lacks = wrong.reduce((all, each) => all + each.lacks, 0);
    return { words: filled(said[lacks === 1 ? "begun" : "begun many"], { count: lacks }), right: false };
  }
  if (wrong.length) {
    const which = count === 1 ? "wrong" : wrong.length === 1 ? "wrong one" : "wrong many";
    return { words: filled(said[which], { count: wrong.length, asked: count }), right: false };
  }
  const notes = [...new Set(judged.map(({ note }) => note).filter(Boolean))].sort();
  if (judged.some(({ mark }) => mark === "carried"))
    return { words: filled(said.carried, { notes: `: ${notes.join("; ")}` }), right: false };
  if (judged.some(({ mark }) => mark === "unknown")) return { words: said.unknown, right: null };
  const told = notes.map((note) => `; ${note}`).join("");
  return { words: filled(said[count === asked ? RIGHT : "right so far"], { count, asked, notes: told }), right: true };
}

/** How many of a step's lines are typed, and whether these are right. */
function stateOf(sheet, rows, typed) {
  const verdicts = rows.filter((row) => typed.has(row)).map((row) => sheet.verdict(row, typed.get(row)));
  const mark = verdicts.includes(false) ? WRONG : verdicts.length && !verdicts.includes(undefined) ? RIGHT : "";
  return { mark, given: verdicts.length, asked: rows.length };
}
