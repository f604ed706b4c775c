// What the first screen of the observer lab tells: the chart, the sentence, and its controls.

import { places, range, select } from "../../common/first/controls.js";
import { between } from "../../common/model/playback.js";
import { changeAt, same } from "../../common/model/settings.js";
import { claimedDistances } from "../../common/model/space.js";
import { percent } from "../../common/model/words.js";
import { KEPT } from "../../common/page/looks.js";
import { courseOf, distancesOf, FAR, metres, sentenceOf } from "../model/sentences.js";

export { metres };

const OUTPUTS = [
  { text: "y1", spoken: "y1 only", value: ["y1"] },
  { text: "both", spoken: "y1 and y2", value: ["y1", "y2"] },
  { text: "y2", spoken: "y2 only", value: ["y2"] },
];
/** Half an interval, as a part of the distance, from which on its ends are written. */
const WIDE = 0.3;

export function chartOf(screen, scene) {
  const { shown, ghost, theme, secret, now } = scene;
  const { time, truth, settings } = shown;
  const [run] = shown.runs;
  const { other } = screen.seen;
  const distances = (result, rows) => distancesOf(screen.lab.kernels, result, rows);
  const actual = truth?.length ? distances(shown, truth) : null;
  const found = distances(shown, run.estimate);
  const most = actual ? Math.max(...actual.filter(Number.isFinite)) : median(found) * 2;
  const near = found.filter((value) => value < 1.5 * most);
  const colour = theme.lines[run.order];
  const since = actual ? time[0] + courseOf(screen.lab.kernels, shown).found : Infinity;
  const told = since > time[0] && (secret ? since <= now : since < Infinity);
  const at = told ? between(time, since) : null;
  const within10 = `within ${percent(shown.tolerance, 6)} from ${since.toFixed(1)} s`;
  return {
    end: Math.max(settings.scenario in screen.lab.model.recordings ? 0 : settings.duration, time[time.length - 1]),
    high: 1.2 * Math.max(most, ...near),
    unit: "m",
    lines: [
      ...(ghost ? [keptLine(scene.kept, ghost.time, distances(ghost, ghost.runs[0].estimate), theme)] : []),
      { id: "estimate", text: "estimate", time, values: found, colour, width: 3, secret },
      ...(actual ? [{ id: "true", text: "true", time, values: actual, colour: theme.ink, width: 1.6 }] : []),
      ...(other ? [{ id: "other", text: other.name, ...other, colour: theme.ink, width: 1.6 }] : []),
    ],
    // It would give the answer away.
    spans: screen.questions.asking ? [] : unseenSpans(shown),
    found: at ? { time: since, value: found[at.sample], text: within10, colour } : null,
  };
}

/** Times in which what is measured moves too little with the distance. */
export function unseenSpans(shown) {
  const { time, truth, foe, measured } = shown;
  const radius = radiusOf(shown);
  if (!truth?.length || !foe || !radius) return [];
  const text = `${measured.length > 1 ? "" : measured[0] ? "row " : "column "}too near the focus`;
  const spans = spansOf(time, (k) => measuredApart(truth, k, foe, measured, shown.radius) < radius);
  return spans.map(([begin, end]) => ({ begin, end, text }));
}

export function sentence(screen, scene) {
  const { shown, now } = scene;
  const { seen, moved, lab: { kernels } } = screen;
  const unseen = unseenSpans(shown).some(({ begin, end }) => begin <= now && now <= end);
  return sentenceOf({ ...scene, ...seen, moved, unseen, course: seen.truth && courseOf(kernels, shown) });
}

export function controlsOf(lab) {
  const allowed = () => lab.model.surfaces[lab.settings.surface].outputs;
  const observer = () => lab.settings.observers[0];
  const gain = () => lab.model.observers[observer()].gains[0];
  const change = (changes) => {
    lab.first.touch();
    lab.change(changes);
  };
  const rest = () => lab.rest();
  const { low, high } = gain();
  const { recordings } = lab.model;
  const filmed = Object.keys(recordings).filter((name) => recordings[name].film !== null);
  const track = select({
    ...{ name: "first track", label: "Track", choices: filmed },
    get: () => lab.settings.scenario,
    set: (name) => lab.first.choose(name),
  });
  return [
    ...(filmed.length > 1 ? [track] : []),
    places({
      ...{ name: "first outputs", label: "Measured", choices: OUTPUTS },
      get: () => (allowed().length < 2 ? -1 : OUTPUTS.findIndex(({ value }) => same(value, lab.settings.outputs))),
      set: (outputs) => {
        if (!allowed().some((names) => same(names, outputs))) return;
        lab.first.touch();
        lab.change({ outputs }, true);
      },
    }),
    range({
      ...{ name: "first gain", label: "Gain", low: Math.max(low, 1), high, log: true, rest },
      get: () => (gain().high > 1 ? lab.settings.gains[observer()][gain().name] : null),
      set: (value) => change(changeAt(lab.settings, `gains.${observer()}.${gain().name}`, value)),
    }),
    range({
      ...{ name: "first noise", label: "Noise", low: 0, high: 0.01, step: 0.0005, rest },
      get: () => (lab.settings.scenario in lab.model.recordings ? null : lab.settings.noise.size),
      set: (size) => change({ noise: { ...lab.settings.noise, size } }),
    }),
  ];
}

function keptLine(text, time, values, theme) {
  return { id: "kept", text, time, values, colour: theme.kept, dash: KEPT };
}

/** Radius in the image of the circle in which an instant tells too little; a point that is seen larger leaves none. */
export function radiusOf({ circle, settings }, size = 0) {
  if (circle) return Math.abs(circle[2]);
  const radius = settings.surface === "pinhole" && settings.b[2] ? settings.threshold / Math.abs(settings.b[2]) : 0;
  return radius > size ? Math.sqrt(radius ** 2 - size ** 2) : null;
}

/** Distance in the image from the focus of expansion, as far as it is measured, and the size if that is. */
function measuredApart(truth, k, foe, measured, radius) {
  return Math.hypot(radius * truth[3 * k + 2], ...measured.map((c) => truth[3 * k + c] - foe[c]));
}

/** First and last time of each part in which a condition holds. */
function spansOf(time, holds) {
  const found = [];
  for (let k = 0; k < time.length; k++) {
    if (!holds(k)) continue;
    if (k > 0 && holds(k - 1)) found.at(-1)[1] = time[k];
    else found.push([time[k], time[k]]);
  }
  return found;
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

function median(values) {
  const sorted = values.filter(Number.isFinite).sort();
  return sorted[Math.floor(sorted.length / 2)] ?? 1;
}
