// What each time chart shows of a run: lines, scale, marks, and the same in words.

import { columnOf, derived, distancesOf } from "../../engine/derived.js";
import { linearScale, readable } from "../../draw/scales.js";
import { percent } from "../../state/words.js";
import { around, decades, distancesAround, line, linesOf, marksOf } from "../../draw/lines.js";
import { runLines, sureOf, toleranceOf, withKept } from "../../draw/lines.js";
import { BOUND, KEPT, QUIET, SOLID } from "../../draw/looks.js";

import { innovationOf, stepOf } from "./shares.js";

const NAMES = {
  ...{ pinhole: "Depth Z", chained: "Depth Y", plane: "Depth along the normal", sphere: "Range" },
  unified: "Distance Z + ξR",
};

export const LABELS = {
  outputs: "Image coordinates over time",
  innovation: "Innovation over time",
  step: "Steps of the estimate over time",
  inverse: "Inverse distance over time",
  distance: "Distance over time",
  error: "Relative error of the distance over time",
  excitation: "Excitation over time",
};

export function chartOf(name, shown, ghost, theme) {
  const regions = (shown.inside ?? []).map(([begin, end]) => ({ begin, end, text: "unobservable circle" }));
  const marks = name === "excitation" ? [] : marksOf(shown, theme);
  return { regions, marks, ...BUILD[name](shown, ghost, theme) };
}

const BUILD = {
  outputs(shown, ghost, theme) {
    const lines = [];
    for (const c of [0, 1]) {
      const label = shown.names[c];
      if (shown.measured.includes(c)) {
        const samples = columnOf(shown.outputs, shown.sampled, c);
        lines.push(line(`${label} sampled`, shown.time, samples, theme.sample, SOLID));
      }
      lines.push(...linesOf(shown, ghost, theme, label, ({ width }, rows) => columnOf(rows, width, c)));
    }
    return { title: "Image coordinates y1, y2", lines, scale: around(lines, shown) };
  },
  innovation(shown, ghost, theme) {
    const { measured, names, settings } = shown;
    const of = (c) => {
      return runLines(shown, ghost, theme, `innovation of ${names[c]}`, (result, run) => innovationOf(result, run, c));
    };
    const lines = keptOnTop(measured.flatMap(of));
    const { kind, size } = settings.noise;
    const [reach, words] = kind === "uniform" ? [size, "bound of the noise"] : [2 * size, "2σ of the noise"];
    const ends = [shown.time[0], shown.time.at(-1)];
    if (size > 0) for (const side of [-reach, reach]) lines.push(line("noise", ends, [side, side], theme.noise, SOLID));
    const each = measured.map((c) => `${names[c]} − ŷ${c + 1}`).join(", ");
    const title = `Innovation, ${each}${size > 0 ? `, and the ${words}, ±${readable(reach)}` : ""}`;
    const most = size > 0 ? 2 * reach : 0.01;
    return { title, lines, scale: () => linearScale(-most, most, 3) };
  },
  step(shown, ghost, theme) {
    const lines = keptOnTop(runLines(shown, ghost, theme, "step", stepOf));
    const reach = Math.max(1e-6, ...lines.map(({ values }) => usual(values)));
    const title = `Step of the estimated ${shown.names[shown.width - 1]} at each sample, in 1/m`;
    return { title, lines, scale: () => linearScale(-2 * reach, 2 * reach, 3) };
  },
  inverse(shown, ghost, theme) {
    const c = shown.width - 1;
    const lines = linesOf(shown, ghost, theme, shown.names[c], ({ width }, rows) => columnOf(rows, width, c));
    const claiming = shown.runs.find((run) => run.deviation);
    const band = claiming && bandOf(shown, claiming, c, theme);
    const title = `Inverse distance ${shown.names[c]} in 1/m${band ? "; the filter claims ±2σ" : ""}`;
    return { title, lines, band, scale: around(lines, shown) };
  },
  distance(shown, ghost, theme) {
    const lines = linesOf(shown, ghost, theme, "distance", ({ width }, rows) => distancesOf(rows, width));
    const title = `${NAMES[shown.settings.surface] ?? "Distance"} in m`;
    return { title, lines, scale: distancesAround(lines, sureOf(shown)) };
  },
  error(shown, ghost, theme) {
    const [own, kept] = [shown, ghost].map((result) => (result?.truth ? result : null));
    const lines = runLines(own ?? { runs: [] }, kept, theme, "error", (_, run) => run.error);
    if (shown.bound) lines.push(line("bound", shown.time, shown.bound, theme.warning, BOUND));
    const title = `Relative error of ${shown.judged}; tolerance ${percent(shown.tolerance, 6)}`;
    const scale = decades(lines, 1e-6, 1e2, shown.tolerance);
    return { title, scale, ...dividedOf(shown, ghost, lines, theme), ...toleranceOf(shown, theme) };
  },
  excitation(shown, ghost, theme) {
    const { begun } = shown.excitation;
    const name = "since the first sample";
    const growing = { ...line(name, begun.time, begun.smallest, theme.muted, QUIET), text: name };
    const pick = ({ excitation: { time, smallest } }) => [time, smallest];
    const full = withKept("excitation", shown, ghost, theme, pick);
    const lines = begun.time.length ? [growing, ...full] : full;
    const title = `Excitation: smallest eigenvalue of ∫ w wᵀ over ${readable(shown.excitation.window)} s`;
    // A run that ends sooner has a shorter window, and keeps its scale.
    return { title, key: "excitation", lines, scale: decades(lines, 1e-12, 1e4) };
  },
};

/** The kept run on top and no dashes: of numbers that jump at each sample, nothing would be seen of what lies below. */
function keptOnTop(lines) {
  const isKept = ({ name }) => name.startsWith("kept");
  const kept = lines.filter(isKept);
  if (kept.length) kept.push({ ...kept.pop(), text: "kept run" });
  return [...lines.filter((each) => !isKept(each)), ...kept].map((each) => ({ ...each, dash: SOLID }));
}

/** A size that all but a tenth of the later values stay below. */
function usual(values) {
  const late = values.slice(values.length >> 1).map(Math.abs).filter(Number.isFinite).sort();
  return late[Math.floor(0.9 * late.length)] ?? 0;
}

/** Lines of an error with its parts, where it is divided: below what noise adds, and the same run without noise. */
function dividedOf({ shares, time }, ghost, lines, theme) {
  if (!shares) return { lines };
  const quiet = { ...line("without noise", time, shares.quiet, theme.muted, QUIET), text: "without noise" };
  const added = { ...line("what noise adds", shares.time, shares.added, theme.noise, SOLID), text: "what noise adds" };
  const last = ghost?.shares;
  const before = last && line("what noise added to the kept run", last.time, last.added, theme.noise, KEPT);
  const none = derived(shares.added, "none", () => new Float64Array(shares.added.length));
  const band = { time: shares.time, low: none, high: shares.added, colour: theme.noise };
  // On top, for an error with noise hides whatever lies below it.
  return { lines: [...lines, ...(before ? [{ ...before, text: "noise, kept run" }] : []), quiet, added], band };
}

function bandOf(shown, run, c, theme) {
  const middle = columnOf(run.estimate, shown.width, c);
  const deviation = columnOf(run.deviation, shown.width, c);
  const bound = (factor) => derived(deviation, `bound ${factor}`, () => {
    const values = new Float64Array(middle.length);
    for (let k = 0; k < values.length; k++) values[k] = middle[k] + factor * deviation[k];
    return values;
  });
  return { time: shown.time, low: bound(-2), high: bound(2), colour: theme.lines[run.order] };
}
