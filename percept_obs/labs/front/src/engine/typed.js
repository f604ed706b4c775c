// @ts-check
// Motions that somebody typed: Python read them, and printed each as a function of time and of the numbers that a lab
// sets.

import { NO_BREAKS } from "./camera.js";
import { instants } from "./tables.js";

/** The function that a typed motion is, as a module of functions; nothing of settings without one. */
export function typedModule({ written }, text) {
  if (!text?.trim()) return [];
  const answer = written?.[text];
  if (!answer?.source) {
    const why =
      answer?.refusal ??
      "only Python reads it, and it has not: open the lab in a notebook, and run its cell";
    return [{ key: `motion ${text}`, texts: {}, refusal: `"${text}" cannot be shown: ${why}` }];
  }
  const { source, columns, uses } = answer;
  const typed = `${source}\nObject.assign(evaluate, ${JSON.stringify({ columns, uses })});`;
  return [{ key: `motion ${text}`, texts: { typed } }];
}

/** Times between which a typed motion is smooth. */
export function breaksOf({ written }, text) {
  return written?.[text]?.breaks ?? NO_BREAKS;
}

/** Python's answers to the texts in settings and in the kept ones. */
export function readOf(settings, { written = {} }) {
  const texts = [settings, settings.kept].flatMap((each) => Object.values(each ?? {}));
  return Object.fromEntries(
    texts.filter((text) => typeof text === "string" && written[text]).map((text) => [text, written[text]]),
  );
}

/** Rows of numbers at some times, those of a typed motion as it was typed. */
export function typedRows(typed, numbers, times) {
  const rows = new Float64Array(numbers.length * times.length);
  numbers.forEach((value, p) => fillColumn(rows, numbers.length, p, value));
  evaluate(typed, numbers, times, rows);
  return rows;
}

/**
 * Rows at the instants of a grid's steps, which are kept: while a hand moves a number, only its column is
 * written again, and what was typed is evaluated again only if it uses that number.
 */
export function typedAlong(kept, typed, numbers, grid) {
  let there = kept.get(grid);
  if (there?.typed !== typed || there.numbers.length !== numbers.length) {
    const times = instants(grid);
    there = { typed, times, numbers: [], rows: new Float64Array(numbers.length * times.length) };
    kept.set(grid, there);
  }
  const { rows, times } = there;
  const fresh = !there.numbers.length;
  const changed = [...numbers.keys()].filter((p) => numbers[p] !== there.numbers[p]);
  for (const p of changed) if (!typed.columns.includes(p)) fillColumn(rows, numbers.length, p, numbers[p]);
  if (fresh || changed.some((p) => typed.uses.includes(p))) evaluate(typed, numbers, times, rows);
  there.numbers = [...numbers];
  return rows;
}

function fillColumn(rows, width, p, value) {
  for (let at = p; at < rows.length; at += width) rows[at] = value;
}

function evaluate(typed, numbers, times, rows) {
  const { columns } = typed;
  const width = numbers.length;
  const x = Float64Array.of(0, ...numbers);
  const out = new Float64Array(columns.length);
  for (let k = 0, at = 0; k < times.length; k++, at += width) {
    x[0] = times[k];
    typed(x, out);
    for (let c = 0; c < columns.length; c++) rows[at + columns[c]] = out[c];
  }
}

/** True if settings have a typed motion. */
export function isTyped({ motion }) {
  return motion.trim() !== "";
}
