// The charts of the observer lab besides that of the distance: lines, scale, and what is marked.

import { columnOf, derived } from "../../engine/derived.js";
import {
  around, called, coordinateLines, decades, inPercent, keptLine, levelOf, linesOf, resetsOf,
} from "../../draw/lines.js";
import { BOUND } from "../../draw/looks.js";
import { readable } from "../../draw/scales.js";

/** Titles of the charts, by their names. */
export const CHARTS = {
  error: "Relative error",
  inverse: "Inverse distance",
  outputs: "Image coordinates",
  innovation: "Innovation",
  excitation: "Excitation",
};

/** Measured output less its estimate. */
const innovationOf = ({ outputs, sampled, width }, { estimate }, c) => {
  const [seen, expected] = [columnOf(outputs, sampled, c), columnOf(estimate, width, c)];
  return derived(estimate, `innovation ${c}`, () => seen.map((value, k) => value - expected[k]));
};

const BUILD = {
  error(scene, span) {
    const { shown, theme } = scene;
    const lines = shown.truth ? linesOf(scene, (_, run) => inPercent(run.error)) : [];
    if (shown.bound) {
      const look = { colour: theme.warning, width: 2, dash: BOUND };
      lines.push({ id: "bound", text: "bound", time: shown.time, values: inPercent(shown.bound), ...look });
    }
    const level = levelOf(shown.tolerance);
    const { low, high } = decades(lines, span, 0.1, 100, level.value);
    return { lines, unit: "%", level, scale: { low: Math.min(low, 0.1), high: Math.max(high, 100), log: true } };
  },
  inverse(scene, span) {
    const { shown, chosen, theme } = scene;
    const c = shown.width - 1;
    const lines = coordinateLines(scene, c);
    const band = chosen?.deviation ? bandOf(shown, chosen, c, theme) : null;
    return { lines, unit: "1/m", band, scale: around(lines, span) };
  },
  outputs(scene, span) {
    const { shown, theme } = scene;
    const lines = [0, 1].flatMap((c) => {
      const named = coordinateLines(scene, c).map((line) => called(line, shown.names[c]));
      const values = columnOf(shown.outputs, shown.sampled, c);
      const samples = { id: "sampled", time: shown.time, values, colour: theme.sample };
      return shown.measured.includes(c) ? [samples, ...named] : named;
    });
    return { lines, unit: "", scale: around(lines, span) };
  },
  innovation(scene) {
    const { shown: { measured, names, settings } } = scene;
    const lines = measured.flatMap((c) => {
      const own = linesOf(scene, (result, run) => innovationOf(result, run, c));
      return own.map((line) => ({ ...called(line, names[c]), width: 1 }));
    });
    const { kind, size } = settings.noise;
    const [reach, text] = kind === "uniform" ? [size, "bound of the noise"] : [2 * size, "2σ of the noise"];
    const high = size > 0 ? 2 * reach : 0.01;
    return { lines, unit: "", level: size > 0 ? { value: reach, text } : undefined, scale: { low: -high, high } };
  },
  excitation(scene, span) {
    const { shown, ghost, theme, kept } = scene;
    const { window, time, smallest, begun } = shown.excitation;
    const line = (id, text, [times, values], colour) => ({ id, text, time: times, values, colour });
    const lines = [
      ...(ghost ? [keptLine(kept, ghost.excitation.time, ghost.excitation.smallest, theme)] : []),
      line("begun", "since the first sample", [begun.time, begun.smallest], theme.muted),
      line("estimate", `over ${readable(window)} s`, [time, smallest], theme.ink),
    ].filter((each) => each.time.length);
    return { lines, unit: "", scale: decades(lines, span, 1e-12, 1e4) };
  },
};

/** The chart of a name; null while what it shows is not read off the result yet. */
export function chartOf(name, scene, span) {
  const { shown } = scene;
  if (name === "excitation" && !shown.excitation) return null;
  const spans = (shown.inside ?? []).map(([begin, end]) => ({ begin, end, text: "" }));
  const resets = name === "excitation" ? [] : resetsOf(scene);
  return { title: CHARTS[name], spans, resets, ...BUILD[name](scene, span) };
}

/** The band of two deviations that a filter claims. */
function bandOf(shown, run, c, theme) {
  const middle = columnOf(run.estimate, shown.width, c);
  const deviation = columnOf(run.deviation, shown.width, c);
  const bound = (factor) =>
    derived(deviation, `bound ${factor}`, () => middle.map((value, k) => value + factor * deviation[k]));
  return { time: shown.time, low: bound(-2), high: bound(2), colour: theme.lines[run.order] };
}
