// What time charts are put together from: lines, ranges, and the same in words.

import { linearScale, logScale, readable, spread } from "../model/scales.js";
import { DASHES, KEPT, SOLID } from "./lines.js";

export function line(name, time, values, colour, dash) {
  return { name, time, values, colour, dash };
}

/** A line of what is shown, behind it the same of the kept run; `pick` gives times and values of a result. */
export function withKept(name, shown, ghost, theme, pick) {
  const kept = ghost ? [line(`kept ${name}`, ...pick(ghost), theme.kept, KEPT)] : [];
  return [...kept, line(name, ...pick(shown), theme.ink, SOLID)];
}

/** A range around the lines that are sure, which lets others leave it by as much as it is high, and no further. */
export function rangeAround(lines, certain) {
  const bounds = lines.map((l) => [l, spread(l.values)]).filter(([, b]) => b);
  const sure = bounds.filter(([l]) => certain.includes(l)).map(([, b]) => b);
  const all = bounds.map(([, b]) => b);
  if (!all.length) return linearScale(0, 1);
  let [low, high] = hull(sure.length ? sure : all);
  if (sure.length) {
    const room = Math.max(high - low, 0.1 * Math.abs(high), 1e-6);
    const [least, most] = hull(all);
    [low, high] = [Math.max(least, low - room), Math.min(most, high + room)];
  }
  return linearScale(low, high, 3);
}

/** A logarithmic range that holds the lines' positive values, as far as they lie between a least and a most. */
export function decades(lines, least, most) {
  const positive = lines.map((l) => spread(l.values, { above: 0 })).filter(Boolean);
  if (!positive.length) return logScale(1e-3, 1);
  const [low, high] = hull(positive);
  const top = Math.min(Math.max(high, least * 10), most);
  return logScale(Math.min(Math.max(low, least), top / 10), top);
}

/** The range that holds all of these. */
export function hull(bounds) {
  return [Math.min(...bounds.map(([low]) => low)), Math.max(...bounds.map(([, high]) => high))];
}

/** The text equivalent of a chart: where each line begins and ends, and between what it stays. */
export function chartInWords({ title, lines }) {
  const parts = lines.map(({ name, values }) => {
    const finite = values.filter(Number.isFinite);
    if (!finite.length) return `${name}: nothing to show`;
    const [least, most] = [Math.min, Math.max].map((pick) => finite.reduce((a, b) => pick(a, b)));
    const [first, last] = [finite[0], finite.at(-1)];
    return `${name}: from ${readable(first)} to ${readable(last)}, between ${readable(least)} and ${readable(most)}`;
  });
  return `${title}. ${parts.join("; ")}.`;
}

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
