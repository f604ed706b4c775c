// What the charts of observers show: truth and estimates, resets, and a range around them.

import { line, rangeAround } from "./chart_parts.js";
import { DASHES, KEPT, SOLID } from "./lines.js";
import { linearScale } from "./scales.js";

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

/** A range around the truth, or where there is none around the samples; at least as far as `reach` to both sides. */
export function around(lines, shown, reach = 0) {
  const certain = (l) => l.name.startsWith("true") || (!shown.truth && l.name.endsWith("sampled"));
  const scale = rangeAround(lines, lines.filter(certain));
  const middle = (scale.low + scale.high) / 2;
  return scale.high - scale.low < 2 * reach ? linearScale(middle - reach, middle + reach, 3) : scale;
}
