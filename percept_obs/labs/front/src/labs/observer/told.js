// What the first screen of the observer lab tells: the chart, the sentence, and its controls.

import { linesOf } from "../../draw/lines.js";
import { places, range, select } from "../../ui/controls.js";
import { derived } from "../../engine/derived.js";
import { indicesIn, spansOf } from "../../engine/tables.js";
import { between } from "../../engine/between.js";
import { element } from "../../draw/dom.js";
import { readable } from "../../draw/scales.js";
import { changeAt, same, valueAt } from "../../state/settings.js";
import { claimedDistances } from "../../engine/errors.js";
import { percent } from "../../ui/words.js";
import { firstOf } from "../../ui/sentences.js";
import { courseOf, distancesOf, FAR, metres, SENTENCES } from "./sentences.js";

export { metres };

const OUTPUTS = [
  { text: "y1", spoken: "y1 only", value: ["y1"] },
  { text: "both", spoken: "y1 and y2", value: ["y1", "y2"] },
  { text: "y2", spoken: "y2 only", value: ["y2"] },
];
/** Half an interval, as a part of the distance, from which on its ends are written. */
const WIDE = 0.3;

export function chartOf(screen, scene) {
  const { shown, theme, secret, now, chosen, span } = scene;
  const { time, truth } = shown;
  const { other } = screen.seen;
  const [from, to] = indicesIn(time, span);
  const distances = (result, rows) => distancesOf(screen.lab.kernels, result, rows);
  const actual = truth?.length ? distances(shown, truth) : null;
  const all = linesOf(scene, (result, { estimate }) => distances(result, estimate), () => actual);
  const lines = screen.bare ? all.slice(-1) : all;
  const own = lines.filter(({ id }) => id !== "true" && id !== "kept");
  const found = own.map(({ values }) => values.subarray(from, to + 1));
  const most = actual ? greatest(actual.subarray(from, to + 1)) : median(found.at(-1)) * 2;
  const since = actual && !screen.bare ? time[0] + courseOf(screen.lab.kernels, shown, chosen).found : Infinity;
  const told = since > time[0] && (secret ? since <= now : since < Infinity);
  const value = told ? distances(shown, chosen.estimate)[between(time, since).sample] : 0;
  const text = `within ${percent(shown.tolerance, 6)} from ${since.toFixed(1)} s`;
  return {
    scale: { low: 0, high: 1.2 * Math.max(most, ...found.map((values) => greatest(values, 2.1 * most))) },
    unit: "m",
    lines: [
      ...lines,
      ...(other ? [{ id: "other", text: other.name, ...other, colour: theme.ink, width: 1.6 }] : []),
    ],
    // It would give the answer away.
    spans: screen.questions.asking ? [] : unseenSpans(shown),
    found: told ? [{ time: since, value, text, colour: theme.lines[chosen.order] }] : [],
  };
}

/** Times in which what is measured moves too little with the distance. */
function unseenSpans(shown) {
  return derived(shown, "unseen", () => {
    const { time, truth, foe, measured } = shown;
    const radius = radiusOf(shown);
    if (!truth?.length || !foe || !radius) return [];
    const text = `${measured.length > 1 ? "" : measured[0] ? "row " : "column "}too near the focus`;
    const spans = spansOf(time.length, (k) => measuredApart(truth, k, foe, measured, shown.radius) < radius);
    return spans.map(({ first, last }) => ({ begin: time[first], end: time[last], text }));
  });
}

export function sentence(screen, scene) {
  const { shown, now, chosen } = scene;
  const { seen, moved, lab: { kernels, model: { verdicts } } } = screen;
  const unseen = unseenSpans(shown).some(({ begin, end }) => begin <= now && now <= end);
  const course = seen.truth && courseOf(kernels, shown, chosen);
  return firstOf(SENTENCES, { ...scene, ...seen, verdicts, moved, unseen, course });
}

export function controlsOf(lab) {
  const allowed = () => lab.model.surfaces[lab.settings.surface].outputs;
  const change = (changes) => {
    lab.screen.touch();
    lab.change(changes);
  };
  const rest = () => lab.rest();
  const { recordings } = lab.model;
  const filmed = Object.keys(recordings).filter((name) => recordings[name].film !== null);
  const track = select({
    ...{ name: "track", label: "Track", choices: Object.fromEntries(filmed.map((name) => [name, name])) },
    get: () => lab.settings.scenario,
    set: (name) => lab.screen.choose(name),
  });
  const noise = lab.schema.noise.entries.size;
  return [
    ...(filmed.length > 1 ? [track] : []),
    places({
      ...{ name: "outputs", label: "Measured", choices: OUTPUTS },
      get: () => (allowed().length < 2 ? -1 : OUTPUTS.findIndex(({ value }) => same(value, lab.settings.outputs))),
      set: (outputs) => {
        if (!allowed().some((names) => same(names, outputs))) return;
        lab.screen.touch();
        lab.change({ outputs }, true);
      },
    }),
    mainGain(lab, change, rest),
    range({
      ...{ name: "noise size", label: "Noise", low: noise.low, high: noise.high, step: noise.step, rest },
      get: () => (lab.settings.scenario in recordings ? null : lab.settings.noise.size),
      set: (size) => change({ noise: { ...lab.settings.noise, size } }),
    }),
  ];
}

/** The first gain of the chosen observer, if it has one. */
function mainGain(lab, change, rest) {
  const gain = () => lab.model.observers[lab.chosenName()].gains[0];
  const made = {};
  const row = element("div", { class: "sliding" });
  const of = () => {
    const { name, low, high } = gain();
    const observer = lab.chosenName();
    const key = [observer, name].join(".");
    if (made.key === key) return made.control;
    const place = `gains.${key}`;
    made.key = key;
    made.control = range({
      ...{ name: "gain", label: name === "gain" ? "Gain" : name.replaceAll("_", " "), low, high, rest },
      get: () => valueAt(lab.settings, place),
      set: (value) => lab.kernels.allows(observer, name, value) && change(changeAt(lab.settings, place, value)),
      text: (value) => readable(value),
    });
    row.replaceChildren(made.control.row);
    return made.control;
  };
  const show = () => {
    row.hidden = !gain();
    if (gain()) of().show();
  };
  return { row, show, name: "gain" };
}

/** Radius in the image of the circle in which an instant tells too little; a point that is seen larger leaves none. */
export function radiusOf({ circle, settings }, size = 0) {
  if (circle) return Math.abs(circle[2]);
  const radius = settings.surface === "pinhole" && settings.b[2] ? settings.threshold / Math.abs(settings.b[2]) : 0;
  return radius > size ? Math.sqrt(radius ** 2 - size ** 2) : null;
}

/** Distance in the image from the focus of expansion, as far as it is measured, and the size if that is. */
function measuredApart(truth, k, foe, measured, radius) {
  let square = (radius * truth[3 * k + 2]) ** 2;
  for (const c of measured) square += (truth[3 * k + c] - foe[c]) ** 2;
  return Math.sqrt(square);
}

/** The distance of an inverse along a ray, with the interval of two deviations that is claimed, if one is. */
export function claimed(ray, inverse, deviation) {
  const distance = inverse > 1e-4 ? ray / inverse : Infinity;
  const [low, high] = (deviation && claimedDistances(inverse, deviation)?.map((value) => ray * value)) || [];
  if (low === undefined) return metres(distance);
  const half = (high - low) / 2;
  if (!(half < WIDE * distance)) {
    const interval = high > FAR ? `over ${metres(low)}` : `${metres(low)} to ${metres(high)}`;
    return `${metres(distance)} (${interval})`;
  }
  const digits = half < 0.01 ? 3 : 2;
  return `${distance.toFixed(digits)} ± ${Math.max(half, 0.001).toFixed(digits)} m`;
}

/** The greatest of the values below a limit, or 0. */
function greatest(values, limit = Infinity) {
  let high = 0;
  for (const value of values) if (value > high && value < limit) high = value;
  return high;
}

function median(values) {
  const sorted = values.filter(Number.isFinite).sort();
  return sorted[Math.floor(sorted.length / 2)] ?? 1;
}
