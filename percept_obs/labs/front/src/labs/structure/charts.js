// What each time chart shows of a run: lines, scale, gaps, and the same in words.

import { columnOf, derived } from "../../engine/derived.js";
import { percent } from "../../state/words.js";
import { around, decades, distancesAround, line, linesOf, marksOf } from "../../draw/lines.js";
import { runLines, sureOf, toleranceOf, withKept } from "../../draw/lines.js";
import { BOUND, SOLID } from "../../draw/looks.js";
import { innovationOf, quantityOf, rangeOf } from "./quantities.js";

export const LABELS = {
  unknown1: "First unknown over time",
  unknown2: "Second unknown over time",
  unknown3: "Third unknown over time",
  error: "Relative error of the unknowns over time",
  image: "Image coordinates over time",
  depth: "Scaled inverse depth over time",
  innovation: "Innovation over time",
  determinant: "Determinant over time",
  range: "Range over time",
};

/** Names of the charts that are shown; of an impossible choice those of what is measured. */
export function chartsOf({ settings, choice, problem, refusal }) {
  if (problem) return [];
  if (refusal) return MEASURED;
  return Object.keys(LABELS).filter((name) => {
    if (!name.startsWith("unknown")) return settings.pictures.includes(name);
    return settings.pictures.includes("unknowns") && Number(name.slice(7)) <= choice.unknown.length;
  });
}

const MEASURED = ["image", "depth"];

export function chartOf(name, shown, ghost, theme) {
  const gaps = united(shown.runs.flatMap((run) => run.gaps));
  const regions = gaps.map(([begin, end]) => ({ begin, end, text: "no estimate" }));
  const which = name.startsWith("unknown") ? UNKNOWN : BUILD[name];
  return { regions, marks: marksOf(shown, theme), ...which(shown, ghost, theme, Number(name.slice(7)) - 1) };
}

/** Spans of time without overlaps, so that none is shaded twice. */
function united(spans) {
  const found = [];
  for (const [begin, end] of spans.toSorted((one, other) => one[0] - other[0])) {
    if (found.length && begin <= found.at(-1)[1]) found.at(-1)[1] = Math.max(end, found.at(-1)[1]);
    else found.push([begin, end]);
  }
  return found;
}

/** Least reach of a chart around its quantity, in m/s or 1/m. */
const ROOM = 0.05;

function UNKNOWN(shown, ghost, theme, which) {
  const name = shown.choice.unknown[which];
  const there = ghost?.choice.unknown.includes(name) ? ghost : null;
  const lines = linesOf(shown, there, theme, name, (result, rows) => quantityOf(result, rows, name));
  return { title: `${name} in ${name === "d_s" ? "1/m" : "m/s"}`, lines, scale: around(lines, shown, ROOM) };
}

const BUILD = {
  error(shown, ghost, theme) {
    const title = `Relative error of all unknowns; tolerance ${percent(shown.tolerance, 6)}`;
    const lines = runLines(shown, ghost, theme, "error", (_, run) => run.error);
    return { title, lines, scale: decades(lines, 1e-8, 1e3, shown.tolerance), ...toleranceOf(shown, theme) };
  },
  image(shown, ghost, theme) {
    const lines = [0, 1].flatMap((c) => outputs(shown, ghost, theme, c));
    return { title: "Image coordinates y1, y2", lines, scale: around(lines, shown) };
  },
  depth(shown, ghost, theme) {
    const lines = outputs(shown, ghost, theme, 2);
    return { title: "Scaled inverse depth ȳ3", lines, scale: around(lines, shown) };
  },
  innovation(shown, ghost, theme) {
    const lines = runLines(shown, ghost, theme, "innovation", innovationOf);
    return { title: "Innovation: largest |ȳ − ŷ|", lines, scale: decades(lines, 1e-12, 10) };
  },
  determinant(shown, ghost, theme) {
    const size = (values) => derived(values, "size", () => values.map(Math.abs));
    const lines = withKept("determinant", shown, ghost, theme, ({ time, guard }) => [time, size(guard.determinants)]);
    const guarded = shown.runs.find((run) => run.name in GUARDED);
    if (guarded) {
      const largest = shown.settings.gains[guarded.name].largest_amplification;
      const least = shown.guard.sizes.map((value) => value / largest);
      lines.push(line("least determinant for an estimate", shown.time, least, theme.warning, BOUND));
    }
    const product = shown.choice.square ? "Ωg" : "(Ωgᵀ Ωg)";
    const title = `|det ${product}|${guarded ? "; dotted: least for an estimate" : ""}`;
    return { title, lines, scale: decades(lines, 1e-16, 1e6) };
  },
  range(shown, ghost, theme) {
    const lines = linesOf(shown, ghost, theme, "range", rangeOf);
    return { title: "Range Z in m", lines, scale: distancesAround(lines, sureOf(shown)) };
  },
};

/** Observers that recover theta by a division, and so have gaps. */
const GUARDED = { ideal: true, layer: true, sign: true };

function outputs(shown, ghost, theme, c) {
  const name = shown.names[c];
  const sampled = line(`${name} sampled`, shown.time, columnOf(shown.outputs, 3, c), theme.sample, SOLID);
  return [sampled, ...linesOf(shown, ghost, theme, name, ({ width }, rows) => columnOf(rows, width, c))];
}
