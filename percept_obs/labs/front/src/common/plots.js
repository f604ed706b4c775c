// Lines, marks and ranges that the charts of labs are made of.

import { DASHES, KEPT, SOLID } from "./lines.js";
import { linearScale, logScale, spread } from "./scales.js";

/** A line of a chart. */
export function line(name, time, values, colour, dash) {
  return { name, time, values, colour, dash };
}

/** Lines of the kept run, the truth and the runs, by what is picked of each. */
export function linesOf(shown, ghost, theme, label, pick) {
  const lines = (ghost?.runs ?? []).map((run) =>
    line(`kept ${run.title} ${label}`, ghost.time, pick(run), theme.kept, KEPT),
  );
  if (shown.truth) lines.push(line(`true ${label}`, shown.time, pick(shown), theme.ink, SOLID));
  for (const run of shown.runs) {
    lines.push(line(`${run.title} ${label}`, shown.time, pick(run), theme.lines[run.order], DASHES[run.order]));
  }
  return lines;
}

/** A tick for each reset. */
export function marksOf(shown, theme) {
  return shown.runs.flatMap((run) => run.resets.map((time) => ({ time, colour: theme.lines[run.order] })));
}

/** A range around the truth, at least as far as `reach`, in which an estimate may leave it by the truth's own height. */
export function around(lines, shown, reach = 0) {
  const certain = lines.filter((l) => l.name.startsWith("true") || (!shown.truth && l.name.endsWith("sampled")));
  const bounds = lines.map((l) => [l, spread(l.values)]).filter(([, b]) => b);
  const sure = bounds.filter(([l]) => certain.includes(l)).map(([, b]) => b);
  const all = bounds.map(([, b]) => b);
  if (!all.length) return linearScale(0, 1);
  let [low, high] = hull(sure.length ? sure : all);
  if (sure.length) {
    const room = Math.max(high - low, 0.1 * Math.abs(high), 1e-6);
    const [least, most] = hull(all);
    [low, high] = [Math.min(low - reach, Math.max(least, low - room)), Math.max(high + reach, Math.min(most, high + room))];
  }
  return linearScale(low, high, 3);
}

function hull(bounds) {
  return [Math.min(...bounds.map(([low]) => low)), Math.max(...bounds.map(([, high]) => high))];
}

/** A logarithmic range that holds what is positive, between bounds. */
export function decades(lines, least, most) {
  const positive = lines.map((l) => spread(l.values, { above: 0 })).filter(Boolean);
  if (!positive.length) return logScale(1e-3, 1);
  const [low, high] = hull(positive);
  const top = Math.min(Math.max(high, least * 10), most);
  return logScale(Math.min(Math.max(low, least), top / 10), top);
}
