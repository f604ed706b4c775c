// What charts are put together from: lines of the runs, of the truth and of the kept run, and scales around them.

import { indicesIn } from "../engine/tables.js";
import { columnOf, derived } from "../engine/derived.js";
import { KEPT } from "./looks.js";
import { linearScale, logScale, readable, short, spread } from "./scales.js";

/** From this ratio on, the beginning of a distance cannot be read on a scale that shows its end. */
const MANY = 50;

/**
 * The lines of one quantity: of the kept run, of each observer, of the truth.
 *
 * @param {any} scene  what is shown, with the chosen run
 * @param {(result: any, run: any) => ArrayLike<number>} pick  values of a run
 * @param {((result: any) => ArrayLike<number> | null) | null} [truth]  the true values
 */
export function linesOf({ shown, ghost, theme, chosen, kept, secret }, pick, truth = null) {
  const { time } = shown;
  const name = (run) => (shown.runs.length > 1 ? run.title : "estimate");
  const others = shown.runs.filter((run) => run !== chosen);
  const own = (run, more) => {
    return { text: name(run), time, values: pick(shown, run), colour: theme.lines[run.order], ...more };
  };
  const before = ghost?.runs.find((run) => run.name === chosen?.name) ?? ghost?.runs[0];
  const right = truth?.(shown);
  return [
    ...(before ? [keptLine(kept, ghost.time, pick(ghost, before), theme)] : []),
    ...others.map((run) => own(run, { id: run.name, run: run.name, width: 1.8, secret })),
    ...(chosen ? [own(chosen, { id: "estimate", width: 3, secret })] : []),
    ...(right ? [{ id: "true", text: "true", time, values: right, colour: theme.ink, width: 1.6 }] : []),
  ];
}

/** A line of the kept run. */
export function keptLine(text, time, values, theme) {
  return { id: "kept", text, time, values, colour: theme.kept, dash: KEPT };
}

/** The lines of a coordinate of the runs and of the truth. */
export function coordinateLines(scene, c) {
  const column = ({ width }, rows) => columnOf(rows, width, c);
  return linesOf(scene, (result, { estimate }) => column(result, estimate), (result) =>
    result.truth?.length ? column(result, result.truth) : null,
  );
}

/** Between what a line stays in a span of time; null where it has no value there. */
function boundsIn(span, { time, values }, options) {
  const [first, last] = indicesIn(time, span);
  return spread("subarray" in values ? values.subarray(first, last + 1) : values.slice(first, last + 1), options);
}

/** The range that holds all of these. */
function hull(bounds) {
  return [Math.min(...bounds.map(([low]) => low)), Math.max(...bounds.map(([, high]) => high))];
}

const isTrue = ({ id }) => id === "true";

/** A range around the truth, which holds others as far as they leave it by its height; at least as far as `reach`. */
export function around(lines, span, reach = 0) {
  const found = lines.map((line) => [line, boundsIn(span, line)]).filter(([, bounds]) => bounds);
  if (!found.length) return linearScale(0, 1);
  const sure = found.filter(([line]) => isTrue(line)).map(([, bounds]) => bounds);
  const all = found.map(([, bounds]) => bounds);
  let [low, high] = hull(sure.length ? sure : all);
  if (sure.length) {
    const room = Math.max(high - low, 0.1 * Math.abs(high), 1e-6);
    const [least, most] = hull(all);
    [low, high] = [Math.max(least, low - room), Math.min(most, high + room)];
  }
  const short = reach - (high - low) / 2;
  return short > 0 ? linearScale(low - short, high + short) : linearScale(low, high);
}

/** A range for distances, in decades where the truth goes through several, so that both its ends can be read. */
export function distancesAround(lines, span) {
  const sure = lines.filter(isTrue).map((line) => boundsIn(span, line)).filter(Boolean);
  const [low, high] = sure.length ? hull(sure) : [1, 1];
  return low > 0 && high > MANY * low ? logScale(low / 2, high * 2) : around(lines, span);
}

/** A logarithmic range for the lines' positive values, and a level, as far as these lie between a least and a most. */
export function decades(lines, span, least, most, level = NaN) {
  const named = level > 0 ? [[0.9 * level, 1.1 * level]] : [];
  const positive = [...lines.map((line) => boundsIn(span, line, { above: 0 })), ...named].filter(Boolean);
  if (!positive.length) return logScale(1e-3, 1);
  const [low, high] = hull(positive);
  const top = Math.min(Math.max(high, least * 10), most);
  return logScale(Math.min(Math.max(low, least), top / 10), top);
}

/** The text equivalent of a chart: where each line begins and ends, and between what it stays. */
export function chartInWords(/** @type {import("./chart.js").Chart} */ { title, lines }) {
  const parts = lines.map(({ text, id, values }) => {
    const finite = Array.from(values).filter(Number.isFinite);
    if (!finite.length) return `${text ?? id}: nothing to show`;
    const [least, most] = [Math.min, Math.max].map((pick) => finite.reduce((a, b) => pick(a, b)));
    const [first, last, low, high] = [finite[0], finite.at(-1), least, most].map((value) => readable(value));
    return `${text ?? id}: from ${first} to ${last}, between ${low} and ${high}`;
  });
  return `${title ? `${title}. ` : ""}${parts.join("; ")}.`;
}

export const inPercent = (values) => derived(values, "percent", () => values.map((value) => 100 * value));

/** The level of a tolerance in a chart of errors in per cent. */
export function levelOf(tolerance) {
  return { value: 100 * tolerance, text: `tolerance ${short(100 * tolerance, 6)} %` };
}

/** A line of one of several outputs. */
export const called = (line, name) => ({ ...line, text: line.text && `${name} ${line.text}` });

/** When observers were reset, in their colours. */
export function resetsOf({ shown: { runs }, theme }) {
  const text = ({ length }) => (length === 1 ? "1 reset" : `${length} resets`);
  const reset = runs.filter((run) => run.resets.length);
  return reset.map(({ resets, order }) => ({ times: resets, colour: theme.lines[order], text: text(resets) }));
}
