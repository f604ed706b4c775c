// The answer to a sheet with its settings, by numbers: marks of lines, the wrong terms, words, and what is drawn.

import { filled } from "../../../state/texts.js";
import { grownOf, pictureOf } from "./arrows.js";

/** Number of hints from which on wrong terms are marked; without Python nothing is asked for. */
const TERM = 2;

export function answerTo(/** @type {import("./sheet.js").Sheet} */ sheet, settings, alone) {
  const { printed, lines, said } = sheet;
  const step = Math.min(settings.step, printed.steps.length);
  const keys = sheet.keys(settings.part);
  const texts = keys.map((key) => settings.typed[key] ?? "");
  const typed = new Map([...texts.entries()].filter(([, text]) => text.trim()));
  const rows = sheet.rows(step);
  const judgedIn = (some) => some.flatMap((row) => (typed.has(row) ? [sheet.judged(row, texts[row])] : []));
  const judged = judgedIn(rows).filter(Boolean);
  const named = alone || settings.hints[`${settings.part} ${step}`] >= TERM;

  const lineOf = (row) => {
    const { tree, position, begun } = sheet.entry(row, texts[row]);
    const { mark = "", note = "", lacks = 0, wrong = [], times } = judged.find((line) => line.row === row) ?? {};
    const pieces = sheet.pieces(tree ?? begun.at(-1)?.tree, named ? wrong : []);
    const unfinished = position === texts[row].length;
    const refusal = !tree && alone && typed.has(row) ? (unfinished ? said.unfinished : said.python) : undefined;
    const notes = [note, mark === "unknown" ? said.python : ""].filter(Boolean).map((text) => [{ text }]);
    const told = alone ? [...notes, ...wrong.map((term) => slipIn(sheet, term, times))] : [];
    // With Python at hand it says what is wrong, and when.
    return { pieces, mark: lacks ? "begun" : alone || mark === "right" ? mark : "", told, refusal, position };
  };
  const grown = (row) => [keys[row], grownOf(sheet, row, texts[row], settings.point)];
  return {
    ...{ given: printed.given, step, hint: 0 },
    title: `${printed.title}, ${(printed.outputs ?? settings.outputs).join(" and ")} measured`,
    steps: printed.steps.map(({ reason, name, lines: { length: asked } }, k) => {
      const there = judgedIn(sheet.rows(k + 1));
      const right = there.length && there.every((line) => line?.mark === "right");
      return { reason, name, asked, given: there.length, mark: right ? "right" : "" };
    }),
    lines: rows.map((row) => ({ ...lines[row], key: keys[row], ...lineOf(row) })),
    ...summaryOf(said, judged, rows.length),
    picture: pictureOf(sheet, step, typed, settings.point),
    grown: Object.fromEntries(rows.filter((row) => typed.has(row)).map(grown)),
  };
}

/** A wrong term in words, by how many times it is what it should be. */
function slipIn(sheet, term, times) {
  const { sign, factor, other } = sheet.said.slips;
  const words = times === -1 ? sign : Number.isFinite(times) ? factor : other;
  const [before, after] = filled(words, { times, term: "\0" }).split("\0");
  return [{ text: before }, { math: sheet.pieces(term).join("") }, { text: after }];
}

/** The verdict on a step in a sentence that names no line. */
function summaryOf(said, judged, asked) {
  const words = (name, right, values = {}) => ({ words: filled(said[name], { notes: "", asked, ...values }), right });
  const wrong = judged.filter(({ mark }) => mark === "wrong");
  const lacks = wrong.reduce((all, each) => all + each.lacks, 0);
  if (!judged.length) return { words: "", right: null };
  if (lacks && wrong.every((each) => each.lacks))
    return words(lacks === 1 ? "begun" : "begun many", false, { count: lacks });
  const which = judged.length === 1 ? "wrong" : wrong.length === 1 ? "wrong one" : "wrong many";
  if (wrong.length) return words(which, false, { count: wrong.length });
  if (judged.some(({ mark }) => mark === "unknown")) return words("unknown", null);
  return words(judged.length === asked ? "right" : "right so far", true, { count: judged.length });
}
