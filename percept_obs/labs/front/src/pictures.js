// What each time chart shows of a run: lines, scale, marks, and the same in words.

import { DASHES, OBSERVER_DASHES } from "./canvas.js";
import { TOLERANCE } from "./measures.js";
import { linearScale, logScale, readable, spread } from "./scales.js";
import { column } from "./tables.js";

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
        lines.push(line(`${label} sampled`, shown.time, column(shown.outputs, 2, c), theme.sample, DASHES.samples));
      }
      lines.push(...linesOf(shown, ghost, theme, label, (rows) => column(rows, shown.width, c)));
    }
    return { title: "Image coordinates y1, y2", lines, scale: around(lines, shown), marks: marksOf(shown, theme) };
  },
  inverse(shown, ghost, theme) {
    const c = shown.width - 1;
    const lines = linesOf(shown, ghost, theme, shown.names[c], (rows) => column(rows, shown.width, c));
    const claims = shown.runs.findIndex((run) => run.deviation);
    const band = claims < 0 ? undefined : bandOf(shown, claims, c, theme);
    const title = `Inverse distance ${shown.names[c]} in 1/m${band ? ", with ±2σ that the filter claims" : ""}`;
    return { title, lines, band, scale: around(lines, shown), marks: marksOf(shown, theme) };
  },
  distance(shown, ghost, theme) {
    const far = (rows) => inverseOf(rows, shown.width);
    const lines = linesOf(shown, ghost, theme, "distance", far);
    const title = `${NAMES[shown.settings.surface]} in m`;
    return { title, lines, scale: around(lines, shown), marks: marksOf(shown, theme) };
  },
  error(shown, ghost, theme) {
    const lines = [];
    const add = (run, time, colour, dash, who) => {
      if (run.error) lines.push(line(`${who} error`, time, run.error, colour, dash));
    };
    ghost?.runs.forEach((run) => add(run, ghost.time, theme.kept, DASHES.kept, `kept ${run.title}`));
    shown.runs.forEach((run) => add(run, shown.time, theme.observers[run.order], OBSERVER_DASHES[run.order], run.title));
    const title = `Largest |error| of ${shown.hiddenNames.join(", ")}, with the tolerance ${TOLERANCE}`;
    return { title, lines, scale: decades(lines, 1e-6, 1e2), level: TOLERANCE, marks: marksOf(shown, theme) };
  },
  excitation(shown, ghost, theme) {
    const { excitation } = shown;
    const lines = [line("excitation", excitation.time, excitation.smallest, theme.ink, DASHES.truth)];
    if (ghost?.excitation) {
      lines.unshift(line("kept excitation", ghost.excitation.time, ghost.excitation.smallest, theme.kept, DASHES.kept));
    }
    const title = `Excitation: smallest eigenvalue of ∫ w wᵀ over ${readable(excitation.window)} s`;
    return { title, lines, scale: decades(lines, 1e-12, 1e4) };
  },
};

function line(name, time, values, colour, dash) {
  return { name, time, values, colour, dash };
}

function linesOf(shown, ghost, theme, label, pick) {
  const lines = [];
  ghost?.runs.forEach((run) =>
    lines.push(line(`kept ${run.title} ${label}`, ghost.time, pick(run.estimate), theme.kept, DASHES.kept)),
  );
  if (shown.truth) lines.push(line(`true ${label}`, shown.time, pick(shown.truth), theme.ink, DASHES.truth));
  shown.runs.forEach((run) =>
    lines.push(line(`${run.title} ${label}`, shown.time, pick(run.estimate), theme.observers[run.order], OBSERVER_DASHES[run.order])),
  );
  return lines;
}

/** Distances of estimates; none where the inverse distance is not positive. */
function inverseOf(rows, width) {
  const result = new Float64Array(rows.length / width);
  for (let k = 0; k < result.length; k++) {
    const inverse = rows[(k + 1) * width - 1];
    result[k] = inverse > 0 ? 1 / inverse : NaN;
  }
  return result;
}

function bandOf(shown, which, c, theme) {
  const { estimate, deviation } = shown.runs[which];
  const middle = column(estimate, shown.width, c);
  const spreadOf = column(deviation, shown.width, c);
  return {
    time: shown.time,
    low: middle.map((value, k) => value - 2 * spreadOf[k]),
    high: middle.map((value, k) => value + 2 * spreadOf[k]),
    colour: theme.observers[shown.runs[which].order],
  };
}

function marksOf(shown, theme) {
  return shown.runs.flatMap((run) => run.resets.map((time) => ({ time, colour: theme.observers[run.order] })));
}

/** A range around the truth that lets an estimate leave it by as much as the truth is high, and no further. */
function around(lines, shown) {
  const certain = lines.filter((l) => l.name.startsWith("true") || (!shown.truth && l.name.endsWith("sampled")));
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

function hull(bounds) {
  return [Math.min(...bounds.map(([low]) => low)), Math.max(...bounds.map(([, high]) => high))];
}

function decades(lines, least, most) {
  const positive = lines.map((l) => spread(l.values, { above: 0 })).filter(Boolean);
  if (!positive.length) return logScale(1e-3, 1);
  const [low, high] = hull(positive);
  const top = Math.min(Math.max(high, least * 10), most);
  return logScale(Math.min(Math.max(low, least), top / 10), top);
}
