// What the first screen of the observer lab says of a run: the first row that holds, from the values that are drawn.

import { columnOf, derived } from "../../engine/derived.js";
import { settled, settlingTime } from "../../engine/errors.js";
import { same } from "../../state/settings.js";
import { atEnd, DIVERGED, isEarly, notFound } from "../../ui/sentences.js";
import { percent } from "../../ui/words.js";
import { shapeOf } from "./camera.js";

/** Image coordinates of more than this are not looked at. */
export const MOST = 3;
/** The estimate and the truth are written in metres up to this, and in centimetres below that. */
export const FAR = 999;
const NEARBY = 2;
/** Part of the run in which the first look is told, and the last one, in which an estimate has to be steady. */
const [EARLY, LAST] = [0.15, 0.25];
/** A velocity in the image below which nothing moves. */
const STANDS = 1e-9;
/** How often an estimate that is shaken passes its own mean in the last part of a run, at least. */
const PASSES = 6;

export function metres(distance) {
  return distance > FAR ? "∞" : `${distance.toFixed(distance < NEARBY ? 2 : 1)} m`;
}

/** The length of three numbers; Math.hypot takes ten times as long, and each sample asks for it. */
function normOf(out) {
  return Math.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
}

/** Distances along the ray of rows of states; as good as infinite where the inverse is not positive. */
export function distancesOf(kernels, result, rows) {
  return derived(rows, "along the ray", () => {
    const { ray } = kernels.of(result.settings);
    const out = new Float64Array(3);
    const seen = [0, 0, ...shapeOf(result.settings)];
    const inverse = columnOf(rows, 3, 2);
    return inverse.map((value, k) => {
      [seen[0], seen[1]] = [rows[3 * k], rows[3 * k + 1]];
      ray(seen, out);
      return value > 1e-4 ? normOf(out) / value : Number.isNaN(value) ? NaN : 1e5;
    });
  });
}

/** Estimated over true distance at each sample, as both are drawn. */
function ratiosOf(kernels, shown, { estimate }) {
  const [found, actual] = [estimate, shown.truth].map((rows) => distancesOf(kernels, shown, rows));
  return derived(estimate, "ratio along the ray", () => found.map((value, k) => value / actual[k]));
}

/** How far the estimate is from the point, over the point's distance, at each sample. */
function apartOf(kernels, { time, truth, settings }, { estimate }) {
  const { ray } = kernels.of(settings);
  const [found, right] = [new Float64Array(3), new Float64Array(3)];
  const seen = [0, 0, ...shapeOf(settings)];
  const place = (rows, k, out) => {
    [seen[0], seen[1]] = [rows[3 * k], rows[3 * k + 1]];
    ray(seen, out);
    for (let i = 0; i < 3; i++) out[i] /= rows[3 * k + 2];
  };
  const apart = new Float64Array(time.length);
  for (let k = 0; k < time.length; k++) {
    place(estimate, k, found);
    place(truth, k, right);
    for (let i = 0; i < 3; i++) found[i] -= right[i];
    apart[k] = normOf(found) / normOf(right);
  }
  return apart;
}

/** How an estimate is, all along a run with a truth: since when it is near, whether it stays so, or is shaken. */
export function courseOf(kernels, shown, run) {
  const { time, tolerance, settledPart, settings } = shown;
  return derived(run.estimate, "course", () => {
    const ratios = ratiosOf(kernels, shown, run);
    const apart = apartOf(kernels, shown, run);
    const near = settlingTime(time, (k) => Math.max(run.error[k], apart[k]), tolerance);
    const last = ratios.subarray(Math.floor((1 - LAST) * ratios.length));
    const mean = last.reduce((sum, value) => sum + value, 0) / last.length;
    const passes = last.filter((value, k) => k && (value - mean) * (last[k - 1] - mean) < 0).length;
    const found = settled(near, time.at(-1) - time[0], settledPart) ? near : Infinity;
    const steady = settings.noise.size === 0 || passes < PASSES || Math.abs(mean - 1) > tolerance;
    const shake = Math.max(...last.map((value) => Math.abs(value - 1)));
    return { near, found, shaken: found === Infinity && !steady && shake > tolerance, shake };
  });
}

/** True where the motion that the estimate expects is another one than is seen, as far as that is measured. */
export function expectsAnother({ copies, expects, single }, tolerance) {
  if (!copies || !expects) return false;
  const measured = single === null ? [0, 1] : [single];
  const lengthOf = (values) => Math.hypot(...measured.map((c) => values[c]));
  return lengthOf(copies[1].map((value, c) => value - expects[c])) > Math.max(tolerance * lengthOf(copies[1]), STANDS);
}

/** True where the point is out of all that is looked at. */
export function isOut({ y, film }) {
  return !film && y.some((value) => Math.abs(value) > MOST);
}

const lengthOf = (place) => (place ? Math.hypot(...place) : Infinity);
const ratioOf = ({ guess, place }) => lengthOf(guess) / lengthOf(place);
const isFound = ({ course, now, shown: { time } }) => course.found <= now - time[0];
const bothOf = ({ guess, place }) => `at ${metres(lengthOf(guess))}, the point at ${metres(lengthOf(place))}`;
const within = ({ shown: { tolerance } }) => `within ${percent(tolerance, 6)}`;

function believesAnother({ shown: { settings, time }, now, end }) {
  const { believed, A, b } = settings;
  return believed && !same(believed, { A, b }) && now > (time[0] + end) / 2;
}

/**
 * What may be said, the most important first.  Facts are what is seen at a time, with `shown`, `now`, `end`, `why`,
 * `moved`, `course` for a run with a truth, and `unseen` where too little is learnt.
 *
 * @type {import("../../ui/sentences.js").Sentence[]}
 */
export const SENTENCES = [
  {
    when: ({ other }) => other,
    text: ({ other }) => `A point without a truth: compare its distance with the ${other.name}.`,
  },
  { when: ({ truth }) => !truth, text: () => "A recording without a truth: the estimate alone is shown." },
  { when: ({ why, unseen }) => why && unseen, text: () => "One ray, three distances: here all of them move alike." },
  { when: ({ why }) => why, text: () => "One ray, three distances: the nearer a point is, the faster it moves." },
  DIVERGED,
  { when: isOut, text: (facts) => `The point has left the picture. The estimate is ${bothOf(facts)}.` },
  {
    when: believesAnother,
    text: (facts) =>
      `The observer believes another motion: its distance is ${ratioOf(facts).toFixed(2)} times the true one.`,
  },
  {
    when: (facts) => facts.unseen && !isFound(facts),
    text: () => "Too near the focus of expansion: near and far move alike, so there is little to learn.",
  },
  {
    when: (facts) => isFound(facts) && atEnd(facts) && !facts.moved && facts.movable,
    text: ({ guess }) => `Found, ${metres(lengthOf(guess))} away. Now drag the focus of expansion onto the point.`,
  },
  { when: isFound, text: (facts) => `Found ${within(facts)}: the estimate is ${bothOf(facts)}.` },
  {
    when: (facts) => isEarly(facts, EARLY),
    text: () => "One image shows the direction of a point, never its distance.",
  },
  {
    when: (facts) => atEnd(facts) && facts.course.shaken,
    text: (facts) =>
      `It is near ${metres(lengthOf(facts.place))}, but noise shakes it by ${percent(facts.course.shake, 2)}: ` +
      `it never stays ${within(facts)}.`,
  },
  {
    when: (facts) => atEnd(facts) && Number.isFinite(facts.course.near),
    text: (facts) =>
      `It is ${within(facts)} since ${(facts.shown.time[0] + facts.course.near).toFixed(2)} s only: ` +
      "too late to tell whether it stays.",
  },
  {
    when: (facts) => atEnd(facts) && Math.abs(ratioOf(facts) - 1) > facts.shown.tolerance,
    text: (facts) =>
      `${notFound(facts)}: the estimate is too ${ratioOf(facts) < 1 ? "near" : "far"}, ${bothOf(facts)}.`,
  },
  { when: atEnd, text: (facts) => `${notFound(facts)}: the estimate is beside the point, ${bothOf(facts)}.` },
  { when: ({ guess }) => !guess, text: () => "The estimate is farther than the map can show." },
  {
    when: (facts) => facts.shown.radius > 0 && Math.abs(ratioOf(facts) - 1) > facts.shown.tolerance,
    text: () => "It grows at another rate than the estimate expects, so that slides along its ray.",
  },
  {
    when: (facts) => expectsAnother(facts, facts.shown.tolerance),
    text: () => "The estimate expects another motion than is seen, so it slides along its ray.",
  },
  { when: () => true, text: (facts) => `By now it is seen nearly as expected: the estimate is ${bothOf(facts)}.` },
];
