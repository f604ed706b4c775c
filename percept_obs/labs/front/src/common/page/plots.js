// @ts-check
// What the charts of observers show: truth and estimates, resets, and a range around them.

import { line, rangeAround } from "./chart_parts.js";
import { DASHES, KEPT, SOLID } from "./lines.js";
import { linearScale } from "../model/scales.js";

/** Lines of the kept run and of the runs, by what is picked of each in its result. */
export function runLines(shown, ghost, theme, label, pick) {
  const kept = (run) => line(`kept ${run.title} ${label}`, ghost.time, pick(ghost, run), theme.kept, KEPT);
  const own = ({ title, order }, values) => line(`${title} ${label}`, shown.time, values, theme.lines[order], DASHES[order]);
  return [...(ghost?.runs ?? []).map(kept), ...shown.runs.map((run) => own(run, pick(shown, run)))];
}

/** The same with the truth between them, of what is picked of rows of numbers. */
export function linesOf(shown, ghost, theme, label, pick) {
  const lines = runLines(shown, ghost, theme, label, (result, run) => pick(result, run.estimate));
  const truth = shown.truth ? [line(`true ${label}`, shown.time, pick(shown, shown.truth), theme.ink, SOLID)] : [];
  return lines.toSpliced(lines.length - shown.runs.length, 0, ...truth);
}

/** A tick for each reset. */
export function marksOf(shown, theme) {
  return shown.runs.flatMap((run) => run.resets.map((time) => ({ time, colour: theme.lines[run.order] })));
}

/** A range around the truth, or where there is none around the samples; at least as far as `reach` to both sides. */
export function around(lines, shown, reach = 0) {
  const certain = (l) => l.name.startsWith("true") || (!shown.truth && l.name.endsWith("sampled"));
  const scale = rangeAround(lines, lines.filter(certain));
  const middle = (scale.low + scale.high) / 2;
  return scale.high - scale.low < 2 * reach ? linearScale(middle - reach, middle + reach, 3) : scale;
}
