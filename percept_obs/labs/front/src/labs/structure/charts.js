// The charts of the structure lab besides the first: lines, scale, gaps.

import { columnOf, derived } from "../../engine/derived.js";
import {
  around, called, coordinateLines, decades, distancesAround, inPercent, levelOf, linesOf, resetsOf,
} from "../../draw/lines.js";
import { innovationOf, quantityOf, rangeOf } from "./quantities.js";

/** Titles of the charts, by their names. */
export const CHARTS = {
  unknown1: "First unknown",
  unknown2: "Second unknown",
  unknown3: "Third unknown",
  error: "Relative error",
  image: "Image coordinates",
  depth: "Scaled inverse depth",
  innovation: "Innovation",
  determinant: "Determinant",
  range: "Range",
};

/** Least reach of a chart around its quantity, in m/s or 1/m. */
const ROOM = 0.05;
/** Observers that recover theta by a division, and so have gaps. */
const GUARDED = ["ideal", "layer", "sign"];

const EMPTY = { unit: "", lines: [], scale: { low: 0, high: 1 } };

const truthOf = (result) => (result.truth?.length && !result.refusal ? result.truth : null);

function unknown(scene, span, which) {
  const { shown, ghost } = scene;
  const name = shown.choice?.unknown[which];
  if (!name) return { title: `${CHARTS[`unknown${which + 1}`]}: there is none`, ...EMPTY };
  const there = ghost?.choice.unknown.includes(name) ? ghost : null;
  const of = (result, rows) => quantityOf(result, rows, name);
  const estimated = (result, run) => of(result, run.estimate);
  const lines = linesOf({ ...scene, ghost: there }, estimated, (result) => of(result, result.truth));
  return { title: name, unit: name === "d_s" ? "1/m" : "m/s", lines, scale: around(lines, span, ROOM) };
}

/** What is sampled of an output, and what observers make of it. */
function outputs(scene, c) {
  const { shown, theme } = scene;
  const values = columnOf(shown.outputs, 3, c);
  const sampled = { id: `sampled ${c}`, text: "sampled", time: shown.time, values, colour: theme.sample };
  return [sampled, ...(shown.refusal ? [] : coordinateLines(scene, c))];
}

const BUILD = {
  unknown1: (scene, span) => unknown(scene, span, 0),
  unknown2: (scene, span) => unknown(scene, span, 1),
  unknown3: (scene, span) => unknown(scene, span, 2),
  error(scene, span) {
    const { tolerance } = scene.shown;
    const lines = linesOf(scene, (_, { error }) => inPercent(error));
    const level = levelOf(tolerance);
    return { lines, unit: "%", level, scale: decades(lines, span, 1e-6, 1e5, level.value) };
  },
  image(scene, span) {
    const lines = [0, 1].flatMap((c) => outputs(scene, c).map((line) => called(line, `y${c + 1}`)));
    return { lines, unit: "", scale: around(lines, span) };
  },
  depth(scene, span) {
    const lines = outputs(scene, 2);
    return { lines, unit: "", scale: around(lines, span) };
  },
  innovation(scene, span) {
    const lines = linesOf(scene, innovationOf);
    return { title: "Innovation: largest |ȳ − ŷ|", lines, unit: "", scale: decades(lines, span, 1e-12, 10) };
  },
  determinant(scene, span) {
    const { shown, theme } = scene;
    const { determinants, sizes } = shown.guard ?? { determinants: new Float64Array(0), sizes: new Float64Array(0) };
    const values = derived(determinants, "size", () => determinants.map(Math.abs));
    const lines = [{ id: "estimate", text: "determinant", time: shown.time, values, colour: theme.ink }];
    const guarded = shown.runs.find(({ name }) => GUARDED.includes(name));
    if (guarded) {
      const largest = shown.settings.gains[guarded.name].largest_amplification;
      const least = derived(sizes, `over ${largest}`, () => sizes.map((value) => value / largest));
      const look = { time: shown.time, values: least, colour: theme.warning };
      lines.push({ id: "least", text: "least for an estimate", ...look });
    }
    const product = shown.choice?.square ? "Ωg" : "(Ωgᵀ Ωg)";
    return { title: `|det ${product}|`, lines, unit: "", scale: decades(lines, span, 1e-16, 1e6) };
  },
  range(scene, span) {
    const right = (result) => truthOf(result) && rangeOf(result, result.truth);
    const lines = linesOf(scene, (result, run) => rangeOf(result, run.estimate), right);
    return { lines, unit: "m", scale: distancesAround(lines, span) };
  },
};

/** What is measured is shown of an impossible choice as well. */
const MEASURED = ["image", "depth"];

/** The chart of a name. */
export function chartOf(name, scene, span) {
  const { shown } = scene;
  if (shown.refusal && !MEASURED.includes(name)) return { title: `${CHARTS[name]}: nothing is estimated`, ...EMPTY };
  const spans = united(shown.runs.flatMap((run) => run.gaps)).map(([begin, end]) => ({ begin, end, text: "" }));
  return { title: CHARTS[name], spans, resets: resetsOf(scene), ...BUILD[name](scene, span) };
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
