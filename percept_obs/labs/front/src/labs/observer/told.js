// What the first screen of the observer lab tells: the chart, the sentence, and its controls.

import { places, range, select } from "../../ui/handy.js";
import { columnOf, derived } from "../../engine/derived.js";
import { settled } from "../../engine/errors.js";
import { between } from "../../engine/between.js";
import { changeAt, same } from "../../state/settings.js";
import { claimedDistances } from "../../old/space.js";
import { percent } from "../../state/words.js";
import { KEPT } from "../../draw/looks.js";
import { shapeOf } from "./camera.js";

const OUTPUTS = [
  { text: "y1", spoken: "y1 only", value: ["y1"] },
  { text: "both", spoken: "y1 and y2", value: ["y1", "y2"] },
  { text: "y2", spoken: "y2 only", value: ["y2"] },
];
/** The estimate and the truth are written in metres up to this, and in centimetres below that. */
const [FAR, NEARBY] = [999, 2];
/** Half an interval, as a part of the distance, from which on its ends are written. */
const WIDE = 0.3;

export function chartOf(screen, scene) {
  const { shown, ghost, theme, secret, now } = scene;
  const { time, truth, settings } = shown;
  const [run] = shown.runs;
  const { other } = screen.seen;
  const distances = (result, rows) => distancesOf(screen, result, rows);
  const actual = truth?.length ? distances(shown, truth) : null;
  const found = distances(shown, run.estimate);
  const most = actual ? Math.max(...actual.filter(Number.isFinite)) : median(found) * 2;
  const near = found.filter((value) => value < 1.5 * most);
  const colour = theme.lines[run.order];
  const since = actual && isSettled(shown) && run.settling > 0 ? time[0] + run.settling : Infinity;
  const told = secret ? since <= now : since < Infinity;
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
    spans: unseenSpans(shown),
    found: at ? { time: since, value: found[at.sample], text: within10, colour } : null,
  };
}

/** Distances along the ray of rows of states; as good as infinite where the inverse is not positive. */
function distancesOf(screen, result, rows) {
  return derived(rows, "along the ray", () => {
    const { ray } = screen.lab.kernels.of(result.settings);
    const out = new Float64Array(3);
    const seen = [0, 0, ...shapeOf(result.settings)];
    const inverse = columnOf(rows, 3, 2);
    return inverse.map((value, k) => {
      [seen[0], seen[1]] = [rows[3 * k], rows[3 * k + 1]];
      ray(seen, out);
      return value > 1e-4 ? Math.hypot(...out) / value : Number.isNaN(value) ? NaN : 1e5;
    });
  });
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
  const { shown, now, end, why } = scene;
  const { settings, time } = shown;
  const { seen } = screen;
  const [run] = shown.runs;
  if (seen.other) return `A point without a truth: compare its distance with the ${seen.other.name}.`;
  if (!seen.truth) return "A recording without a truth: the estimate alone is shown.";
  const near = unseenSpans(shown).some(({ begin, end: last }) => begin <= now && now <= last);
  if (why) {
    if (near) return "One ray, three distances: here all of them move alike.";
    return "One ray, three distances: the nearer a point is, the faster it moves.";
  }
  const found = isSettled(shown) && run.settling <= now - time[0];
  const distance = metres(Math.hypot(...seen.place));
  const ratio = seen.guess ? Math.hypot(...seen.guess) / Math.hypot(...seen.place) : Infinity;
  if (run.divergedAt !== null) return `The estimate left every bound after ${run.divergedAt.toFixed(1)} s.`;
  if (settings.believed && !same(settings.believed, { A: settings.A, b: settings.b }) && now > (time[0] + end) / 2)
    return `The observer believes another motion: its distance is ${ratio.toFixed(2)} times the true one.`;
  if (near && !found) return "Too near the focus of expansion: near and far move alike, so there is little to learn.";
  if (found) {
    if (now < end || screen.moved || !seen.movable) return `Found: the estimate is on the point, ${distance} away.`;
    return `Found: ${distance}. Now drag the focus of expansion onto the point.`;
  }
  if (now - time[0] < 0.15 * (end - time[0])) return "One image shows the direction of a point, never its distance.";
  const seconds = (end - time[0]).toFixed(0);
  if (now >= end) return `Not found in ${seconds} s: the estimate is too ${ratio < 1 ? "near" : "far"}.`;
  return "The estimate expects another motion than is seen, so it slides along its ray.";
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

/** True if the first observer's error stays in the tolerance for long enough to be sure. */
function isSettled({ runs: [{ settling }], time, settledPart }) {
  return settled(settling, time.at(-1) - time[0], settledPart);
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

export function metres(distance) {
  return distance > FAR ? "∞" : `${distance.toFixed(distance < NEARBY ? 2 : 1)} m`;
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
