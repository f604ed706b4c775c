// What each time chart shows of a run: lines, scale, marks, and the same in words.

import { decades, line, rangeAround } from "../common/chart_parts.js";
import { DASHES, KEPT, SOLID } from "../common/lines.js";
import { readable } from "../common/scales.js";
import { TOLERANCE } from "./measures.js";

const NAMES = { pinhole: "Depth Z", chained: "Depth Y", plane: "Depth along the normal" };

export const LABELS = {
  outputs: "Image coordinates over time",
  inverse: "Inverse distance over time",
  distance: "Distance over time",
  error: "Error of the hidden coordinates over time",
  excitation: "Excitation over time",
};

/** The parts of one chart. */
export function chartOf(name, shown, ghost, theme) {
  return BUILD[name](shown, ghost, theme);
}

const BUILD = {
  outputs(shown, ghost, theme) {
    const lines = [];
    for (const c of [0, 1]) {
      const label = shown.names[c];
      if (shown.measured.includes(c)) {
        lines.push(line(`${label} sampled`, shown.time, shown.sampleOf(c), theme.sample, SOLID));
      }
      lines.push(...linesOf(shown, ghost, theme, label, (rows) => rows.columnOf(c)));
    }
    return { title: "Image coordinates y1, y2", lines, scale: around(lines, shown), marks: marksOf(shown, theme) };
  },
  inverse(shown, ghost, theme) {
    const c = shown.width - 1;
    const lines = linesOf(shown, ghost, theme, shown.names[c], (rows) => rows.columnOf(c));
    const claiming = shown.runs.find((run) => run.deviation);
    const band = claiming && bandOf(shown, claiming, c, theme);
    const title = `Inverse distance ${shown.names[c]} in 1/m${band ? ", with ±2σ that the filter claims" : ""}`;
    return { title, lines, band, scale: around(lines, shown), marks: marksOf(shown, theme) };
  },
  distance(shown, ghost, theme) {
    const lines = linesOf(shown, ghost, theme, "distance", (rows) => rows.distances());
    const title = `${NAMES[shown.settings.surface]} in m`;
    return { title, lines, scale: around(lines, shown), marks: marksOf(shown, theme) };
  },
  error(shown, ghost, theme) {
    const lines = [];
    const add = (run, time, colour, dash, who) => {
      if (run.error) lines.push(line(`${who} error`, time, run.error, colour, dash));
    };
    ghost?.runs.forEach((run) => add(run, ghost.time, theme.kept, KEPT, `kept ${run.title}`));
    shown.runs.forEach((run) => add(run, shown.time, theme.lines[run.order], DASHES[run.order], run.title));
    const title = `Largest |error| of ${shown.hiddenNames.join(", ")}, with the tolerance ${TOLERANCE}`;
    return { title, lines, scale: decades(lines, 1e-6, 1e2), level: TOLERANCE, marks: marksOf(shown, theme) };
  },
  excitation(shown, ghost, theme) {
    const { excitation } = shown;
    const lines = [line("excitation", excitation.time, excitation.smallest, theme.ink, SOLID)];
    if (ghost?.excitation) {
      lines.unshift(line("kept excitation", ghost.excitation.time, ghost.excitation.smallest, theme.kept, KEPT));
    }
    const title = `Excitation: smallest eigenvalue of ∫ w wᵀ over ${readable(excitation.window)} s`;
    return { title, lines, scale: decades(lines, 1e-12, 1e4) };
  },
};

/** Lines of the kept run, the truth and the runs, by what is picked of each. */
function linesOf(shown, ghost, theme, label, pick) {
  const lines = (ghost?.runs ?? []).map((run) =>
    line(`kept ${run.title} ${label}`, ghost.time, pick(run), theme.kept, KEPT),
  );
  if (shown.truth) lines.push(line(`true ${label}`, shown.time, pick(shown), theme.ink, SOLID));
  for (const run of shown.runs) {
    lines.push(line(`${run.title} ${label}`, shown.time, pick(run), theme.lines[run.order], DASHES[run.order]));
  }
  return lines;
}

function bandOf(shown, run, c, theme) {
  const middle = run.columnOf(c);
  const deviation = (k) => run.deviation[k * shown.width + c];
  return {
    time: shown.time,
    low: (k) => middle[k] - 2 * deviation(k),
    high: (k) => middle[k] + 2 * deviation(k),
    colour: theme.lines[run.order],
  };
}

function marksOf(shown, theme) {
  return shown.runs.flatMap((run) => run.resets.map((time) => ({ time, colour: theme.lines[run.order] })));
}

/** A range around the truth, or where there is none around the samples. */
function around(lines, shown) {
  const certain = (l) => l.name.startsWith("true") || (!shown.truth && l.name.endsWith("sampled"));
  return rangeAround(lines, lines.filter(certain));
}
