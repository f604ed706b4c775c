// What each time chart shows of a run: lines, scale, bars where a point is not seen.

import { columnOf } from "../../engine/derived.js";
import { readable } from "../../draw/scales.js";
import { percent } from "../../state/words.js";
import { decades, distancesAround, line, withKept } from "../../draw/lines.js";
import { BOUND, DASHES, FIT, KEPT, SOLID } from "../../draw/looks.js";

export const LABELS = {
  error: "Norm of the error over time",
  depth: "Depth of each point over time",
  points: "Error of each point over time",
  gramian: "Smallest eigenvalue of the Gramian over time",
};

const FLOOR = 1e-9;

export function chartOf(name, shown, ghost, theme, more) {
  return { ...BUILD[name](shown, ghost, theme, more), bars: name === "gramian" ? [] : barsOf(shown, theme) };
}

const BUILD = {
  error(shown, ghost, theme, { bound }) {
    const { size, fit } = shown;
    const lines = withKept("error", shown, ghost, theme, (result) => [result.time, result.size]);
    const end = shown.time.at(-1);
    if (fit) {
      const ends = [fit.begin, end];
      const values = ends.map((t) => Math.exp(fit.level - fit.rate * t));
      lines.push(line("fitted decay", ends, values, theme.lines[1], FIT));
    }
    if (bound !== null) {
      const values = [size[0], size[0] * Math.exp(-bound * end)];
      lines.push(line("guaranteed decay", [0, end], values, theme.lines[2], BOUND));
    }
    return { title: "Error |ρ| of the whole state, in m", lines, scale: decades(lines, 1e-8, 1e6) };
  },
  depth(shown, ghost, theme) {
    const each = (called, { time, points }, rows, styleOf) =>
      Array.from({ length: points }, (_, k) =>
        line(`${called} of point ${k + 1}`, time, columnOf(rows, points, k), ...styleOf(k)),
      );
    const kept = ghost ? each("kept depth", ghost, ghost.estimated.depths, () => [theme.kept, KEPT]) : [];
    const certain = each("true depth", shown, shown.depths, (k) => [theme.lines[k], SOLID]);
    const estimated = each("depth", shown, shown.estimated.depths, (k) => [theme.lines[k], DASHES[k]]);
    const lines = [...kept, ...certain, ...estimated];
    const scale = distancesAround(lines, (l) => certain.includes(l));
    return { title: "Depth in m, true (solid) and estimated", lines, scale };
  },
  points({ time, relative, tolerance, settling }, ghost, theme) {
    const lines = relative.map((values, k) => line(`error of point ${k + 1}`, time, values, theme.lines[k], DASHES[k]));
    ghost?.relative.forEach((values, k) => {
      lines.unshift(line(`kept error of point ${k + 1}`, ghost.time, values, theme.kept, KEPT));
    });
    const settled = settling > 0 && settling < Infinity;
    const event = { time: time[0] + settling, text: `all in: ${readable(settling)} s`, colour: theme.ink };
    const events = settled ? [event] : [];
    const title = `Relative error of each point; tolerance ${percent(tolerance, 6)}`;
    return { title, lines, scale: decades(lines, 1e-8, 1e6, tolerance), level: tolerance, events };
  },
  gramian(shown, ghost, theme, { unseen }) {
    const { time, smallest, largest, window } = shown.gramian;
    const floored = ({ gramian }) => [gramian.time, gramian.smallest.map((value) => Math.max(value, FLOOR))];
    const limit = line("limit of what is seen", time, largest.map((value) => unseen * value), theme.warning, BOUND);
    const lines = withKept("smallest eigenvalue", shown, ghost, theme, floored);
    const low = smallest.some((value, k) => value < 100 * unseen * largest[k]);
    const scale = decades(low ? [...lines, limit] : lines, FLOOR, 1e6);
    const what = low ? "; dotted: too little is seen" : ", smallest eigenvalue";
    const title = `Gramian (14) over ${readable(window)} s${what}`;
    return { title, lines: [...lines, limit], scale };
  },
};

function barsOf({ absences }, theme) {
  return absences.flatMap((spans, k) => spans.map(({ begin, end }) => ({ begin, end, colour: theme.lines[k] })));
}
