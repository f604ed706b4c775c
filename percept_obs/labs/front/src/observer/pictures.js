// What each time chart shows of a run: lines, scale, marks, and the same in words.

import { decades, line } from "../common/chart_parts.js";
import { DASHES, KEPT, SOLID } from "../common/lines.js";
import { around, linesOf, marksOf } from "../common/plots.js";
import { readable } from "../common/scales.js";

const NAMES = { pinhole: "Depth Z", chained: "Depth Y", plane: "Depth along the normal", sphere: "Range" };

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
    const title = `Largest |error| of ${shown.hiddenNames.join(", ")}, with the tolerance ${shown.tolerance}`;
    return { title, lines, scale: decades(lines, 1e-6, 1e2), level: shown.tolerance, marks: marksOf(shown, theme) };
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
