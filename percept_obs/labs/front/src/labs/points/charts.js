// The charts of many points besides the first: lines, scale, bars where a point is not seen.

import { columnOf, derived } from "../../engine/derived.js";
import { decades, distancesAround, inPercent, keptLine, levelOf } from "../../draw/lines.js";

/** Titles of the charts, by their names. */
export const CHARTS = {
  error: "Error of the whole state",
  points: "Relative error of each point",
  depth: "Depth of each point",
  gramian: "Smallest eigenvalue of the Gramian",
};

const FLOOR = 1e-9;

const BUILD = {
  error({ shown, ghost, theme, kept, secret }, span, bound) {
    const { size, fit, time } = shown;
    const end = time.at(-1);
    const lines = [
      ...(ghost ? [keptLine(kept, ghost.time, ghost.size, theme)] : []),
      { id: "estimate", text: "error", time, values: size, colour: theme.lines[0], width: 3, secret },
    ];
    const straight = (id, text, times, values, colour) => ({ id, text, time: times, values, colour, dash: [5, 3] });
    if (fit) {
      const ends = [fit.begin, end];
      const values = ends.map((t) => Math.exp(fit.level - fit.rate * t));
      lines.push(straight("fit", "fitted decay", ends, values, theme.lines[1]));
    }
    if (bound !== null)
      lines.push(straight("bound", "guaranteed", [0, end], [size[0], size[0] * Math.exp(-bound * end)], theme.warning));
    return { lines, unit: "m", scale: decades(lines, span, 1e-8, 1e6) };
  },
  points({ shown, theme, secret }, span) {
    const { time, relative, tolerance } = shown;
    const lines = relative.map((values, k) => ({
      ...{ id: `point ${k}`, text: `point ${k + 1}`, time, colour: theme.lines[k], secret },
      values: inPercent(values),
    }));
    const level = levelOf(tolerance);
    return { lines, unit: "%", level, scale: decades(lines, span, 1e-6, 1e6, level.value) };
  },
  depth({ shown, theme, secret }, span) {
    const { time, points, depths, estimated } = shown;
    const lines = Array.from({ length: points }, (_, k) => {
      const [found, right] = [estimated.depths, depths].map((rows) => columnOf(rows, points, k));
      const both = { time, colour: theme.lines[k] };
      const estimate = { id: `point ${k}`, values: found, width: 3, secret, ...both };
      return [estimate, { id: "true", text: `point ${k + 1}`, values: right, width: 1.2, ...both }];
    }).flat();
    return { title: "Depth of each point; thick: estimated", lines, unit: "m", scale: distancesAround(lines, span) };
  },
  gramian({ shown, ghost, theme, kept }, span, _bound, unseen) {
    const { time, smallest, largest } = shown.gramian;
    const floored = (values) => derived(values, "floored", () => values.map((value) => Math.max(value, FLOOR)));
    const limit = derived(largest, "limit", () => largest.map((value) => unseen * value));
    const lines = [
      ...(ghost?.gramian ? [keptLine(kept, ghost.gramian.time, floored(ghost.gramian.smallest), theme)] : []),
      { id: "estimate", text: "smallest", time, values: floored(smallest), colour: theme.ink },
      { id: "limit", text: "too little is seen", time, values: limit, colour: theme.warning },
    ];
    return { lines, unit: "", scale: decades(lines, span, FLOOR, 1e6) };
  },
};

/** The chart of a name. */
export function chartOf(name, scene, span, lab) {
  const { shown } = scene;
  if (name === "gramian" && !shown.gramian) return null;
  const away = shown.absences.map((spans) => spans.map(({ begin, end }) => [begin, end]));
  const bars = name !== "gramian" && away.some((spans) => spans.length) ? { text: "seen", rows: away } : null;
  return { title: CHARTS[name], bars, ...BUILD[name](scene, span, lab.guaranteed(), lab.model.unseen) };
}
