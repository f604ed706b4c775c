// What time charts are put together from: lines, ranges, and the same in words.

import { settled } from "../engine/errors.js";
import { linearScale, logScale, readable } from "./scales.js";
import { DASHES, KEPT, SOLID } from "./looks.js";

/** From this ratio on, the beginning of a distance cannot be read on a scale that shows its end. */
const MANY = 50;

export function line(name, time, values, colour, dash) {
  return { name, time, values, colour, dash };
}

/** A line of what is shown, behind it the same of the kept run; `pick` gives times and values of a result. */
export function withKept(name, shown, ghost, theme, pick) {
  const kept = ghost ? [line(`kept ${name}`, ...pick(ghost), theme.kept, KEPT)] : [];
  return [...kept, line(name, ...pick(shown), theme.ink, SOLID)];
}

/**
 * A range around the lines that are sure, which holds others as far as they leave it by its height.  As all scales of
 * charts it is a function of `bounds`, which says between what a line stays in the time that is in sight.
 */
export function rangeAround(lines, certain) {
  return (bounds) => {
    const found = lines.map((l) => [l, bounds(l)]).filter(([, b]) => b);
    const sure = found.filter(([l]) => certain(l)).map(([, b]) => b);
    const all = found.map(([, b]) => b);
    if (!all.length) return linearScale(0, 1);
    let [low, high] = hull(sure.length ? sure : all);
    if (sure.length) {
      const room = Math.max(high - low, 0.1 * Math.abs(high), 1e-6);
      const [least, most] = hull(all);
      [low, high] = [Math.max(least, low - room), Math.min(most, high + room)];
    }
    return linearScale(low, high, 3);
  };
}

/** A range for distances, in decades where the truth goes through several, so that both its ends can be read. */
export function distancesAround(lines, certain) {
  return (bounds) => {
    const sure = lines.filter(certain).map((l) => bounds(l)).filter(Boolean);
    const [low, high] = sure.length ? hull(sure) : [1, 1];
    return low > 0 && high > MANY * low ? logScale(low / 2, high * 2) : rangeAround(lines, certain)(bounds);
  };
}

/** A logarithmic range for a level and the lines' positive values, as far as these lie between a least and a most. */
export function decades(lines, least, most, level = NaN) {
  const named = level > 0 ? [[0.9 * level, 1.1 * level]] : [];
  return (bounds) => {
    const positive = [...lines.map((l) => bounds(l, { above: 0 })), ...named].filter(Boolean);
    if (!positive.length) return logScale(1e-3, 1);
    const [low, high] = hull(positive);
    const top = Math.min(Math.max(high, least * 10), most);
    return logScale(Math.min(Math.max(low, least), top / 10), top);
  };
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
  const own = ({ title, order }, values) =>
    line(`${title} ${label}`, shown.time, values, theme.lines[order], DASHES[order]);
  return [...(ghost?.runs ?? []).map(kept), ...shown.runs.map((run) => own(run, pick(shown, run)))];
}

/** Lines of the kept run, of the truth and of the runs, by what is picked of rows of numbers. */
export function linesOf(shown, ghost, theme, label, pick) {
  const lines = runLines(shown, ghost, theme, label, (result, run) => pick(result, run.estimate));
  const truth = shown.truth ? [line(`true ${label}`, shown.time, pick(shown, shown.truth), theme.ink, SOLID)] : [];
  return lines.toSpliced(lines.length - shown.runs.length, 0, ...truth);
}

/** When observers were reset, in their colours. */
export function marksOf({ runs }, theme) {
  const text = ({ length }) => (length === 1 ? "1 reset" : `${length} resets`);
  const reset = runs.filter((run) => run.resets.length);
  return reset.map(({ resets, order }) => ({ times: resets, colour: theme.lines[order], text: text(resets) }));
}

/** The tolerance, and since when errors stay in it, where they do so long enough to be sure of. */
export function toleranceOf({ runs, time, tolerance, settledPart }, theme) {
  const length = time.at(-1) - time[0];
  const events = runs
    .filter(({ settling }) => settling > 0 && settled(settling, length, settledPart))
    .map(({ settling, order }) => {
      return { time: time[0] + settling, text: `${readable(settling)} s`, colour: theme.lines[order] };
    });
  return { level: tolerance, events };
}

/** Which lines of a point are sure: the truth, or where there is none the samples. */
export function sureOf(shown) {
  return (l) => l.name.startsWith("true") || (!shown.truth && l.name.endsWith("sampled"));
}

/** A range around the truth, or where there is none around the samples; at least as far as `reach` to both sides. */
export function around(lines, shown, reach = 0) {
  const range = rangeAround(lines, sureOf(shown));
  return (bounds) => {
    const scale = range(bounds);
    const middle = (scale.low + scale.high) / 2;
    return scale.high - scale.low < 2 * reach ? linearScale(middle - reach, middle + reach, 3) : scale;
  };
}
