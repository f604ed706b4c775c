// Questions of the first screen.  What an answer claims is a condition on the result; `right` counts from 0.

import { columnOf } from "../../engine/derived.js";
import { settingsOf } from "../../state/settings.js";

const OBSERVER = "identifier_based";
/** Metres from the camera at which the estimate starts. */
const START = 6;
const NOISE = { kind: "uniform", size: 0.0025 };
const STILL = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
const BELIEVED = 1.5;

/** A drive past standing things, with changes: settings that begin like those of the lab. */
function drive(changes) {
  return ({ standard, drive: begun }) => {
    const settings = settingsOf({ changes }, { ...standard, ...begun });
    const [X, Y, Z] = settings.X0;
    const guess = changes.guess ?? START;
    delete settings.guess;
    return { ...settings, start: { mode: "chosen", values: [X / Z, Y / Z, Math.hypot(X, Y, Z) / Z / guess] } };
  };
}

/** The translation of a drive at a speed towards a place of the image. */
function towards([y1, y2], speed) {
  const part = -speed / Math.hypot(y1, y2, 1);
  return [y1 * part, y2 * part, part];
}

const gain = (value) => ({ gains: { [OBSERVER]: { gain: value } } });

/** Settings before an answer, and after it with the run before beside it, or another one. */
function asked(before, after, kept = before) {
  return { before: drive(before), after: (model) => ({ ...drive(after)(model), kept: drive(kept)(model) }) };
}

const CURVE = { A: [[0, 0, -0.24], [0, 0, 0], [0.24, 0, 0]], b: towards([0, 0.05], 1.6), X0: [5.5, 0.55, 11] };
const ABOVE = { b: towards([0.1, -0.22], 1.3), X0: [1.1, 0.9, 11] };
const STRAIGHT = { X0: [1.76, -0.44, 11] };
const BALL = { X0: [1.2, -0.3, 7.5], gains: { [OBSERVER]: { gain: 20 } } };
const HIDDEN = { A: [[0, 1, 0], [0, 0, 0], [0, 0, 0]], b: [1, 0, 0], X0: [-1, 0.4, 4], guess: 2 };

const errorsOf = (result) => result.runs[0].error;
const settles = (result) => Number.isFinite(result.runs[0].settling);

/** Errors at the samples in which the point is too near the focus of expansion. */
function errorsInside(result) {
  const { inside, time } = result;
  return errorsOf(result).filter((_, k) => inside.some(([from, to]) => from <= time[k] && time[k] <= to));
}

/** The first time at which an estimate is within a tenth of the truth. */
function reached(result) {
  return result.time[errorsOf(result).findIndex((error) => error < 0.1)] ?? Infinity;
}

/** Root mean square of the errors of the last part of a run. */
function rootMeanSquare(errors, part = 0.25) {
  const last = errors.subarray(Math.floor(errors.length * (1 - part)));
  return Math.sqrt(last.reduce((sum, error) => sum + error * error, 0) / last.length);
}

/** A sample of the chart at a part of the run, at the run's or the kept run's estimate. */
const sampleAt = ({ time }, part) => Math.floor(part * (time.length - 1));

/** @type {import("../../ui/questions.js").Question[]} */
export const QUESTIONS = [
  {
    name: "straight",
    chip: "Straight at it?",
    ask: "You drive straight at a standing point. Does its image tell how far it is?",
    answers: ["Yes, at once", "Yes, but slowly", "No"],
    right: 2,
    before: drive(STRAIGHT),
    after: drive(STRAIGHT),
    tells: "No. Near or far, it stands still in the image, so nothing tells them apart.",
    on: "image",
    note: "it stands still",
    spot: () => ({}),
    holds: ({ shown }) => {
      const apart = shown.truth.filter((_, k) => k % 3 < 2).map((value, k) => Math.abs(value - shown.truth[k % 2]));
      return Math.max(...apart) < 1e-9 && !settles(shown);
    },
  },
  {
    name: "size",
    chip: "See its size?",
    ask: "Straight at a ball: you also see how large it is, but do not know its radius. Is its distance found?",
    answers: ["Yes, as it grows", "Only with its radius", "No"],
    right: 0,
    ...asked(BALL, { ...BALL, outputs: ["y1", "y2", "s"] }),
    kept: "before: no size",
    tells: "Yes. It grows, and the faster the nearer it is. The circle in which nothing is learnt is gone.",
    on: "image",
    note: "it grows",
    spot: () => ({}),
    holds: ({ shown, ghost }) => {
      const { b, threshold } = shown.settings;
      const size = columnOf(shown.truth, 3, 2).map((value) => shown.radius * value);
      const grows = size.every((value, k) => !k || value > size[k - 1]);
      return grows && size.every((value) => Math.abs(b[2]) * value > threshold) && settles(shown) && !settles(ghost);
    },
  },
  {
    name: "drop",
    chip: "Drop y2?",
    ask: "The point is straight above the focus of expansion. Is its distance found from its column y1 alone?",
    answers: ["Yes, as fast", "Yes, later", "No"],
    right: 2,
    ...asked(ABOVE, { ...ABOVE, outputs: ["y1"] }),
    kept: "before: both",
    tells: "Its column stands still, near or far, so y1 says nothing. Its row would have told the distance.",
    on: "image",
    note: "its column stands still",
    spot: () => ({}),
    holds: ({ shown, ghost }) => {
      const column = columnOf(shown.truth, 3, 0);
      return Math.max(...column) - Math.min(...column) < 1e-9 && !settles(shown) && settles(ghost);
    },
  },
  {
    name: "gain",
    chip: "More gain?",
    ask: "The image is noisy. What changes with a gain of 60 instead of 10?",
    answers: ["Faster", "Faster, but shaky", "Slower"],
    right: 1,
    ...asked({ noise: NOISE }, { noise: NOISE, ...gain(60) }),
    kept: "before: gain 10",
    tells: "Faster, but the gain multiplies the noise as well: the estimate follows the noise.",
    on: "chart",
    note: "follows the noise",
    spot: ({ shown }) => ({ time: shown.time[sampleAt(shown, 0.6)], own: sampleAt(shown, 0.6) }),
    holds: ({ shown, ghost }) => {
      const [shaky, calm] = [shown, ghost].map((result) => rootMeanSquare(errorsOf(result)));
      return reached(shown) < reached(ghost) && shaky > 2 * calm;
    },
  },
  {
    name: "foe",
    chip: "Cross the focus?",
    ask: "In a curve the point crosses the focus of expansion. What happens to an estimate that is right?",
    answers: ["It stays right", "It gets lost", "It starts over"],
    right: 0,
    ...asked({ ...CURVE, ...gain(16) }, { ...CURVE, ...gain(16) }, { ...CURVE, ...gain(4) }),
    kept: "with gain 4",
    tells:
      "It stays right: its equations carry it through. An estimate that is still wrong (gain 4) learns nothing there.",
    on: "chart",
    note: "learns nothing here",
    spot: ({ ghost }) => {
      const k = ghost.time.findIndex((time) => time >= (ghost.inside[0][0] + ghost.inside[0][1]) / 2);
      return { time: ghost.time[k], kept: k };
    },
    holds: ({ shown, ghost }) => {
      const [right, wrong] = [errorsInside(shown), errorsInside(ghost)];
      return right.length > 0 && Math.max(...right) < 0.05 && wrong.at(-1) >= wrong[0] && wrong[0] > 0.2;
    },
  },
  {
    name: "belief",
    chip: "Wrong speed?",
    ask: "The observer believes in 1.5 times the true speed. Does it notice?",
    answers: ["Yes", "No, yet it is right", "No, and it is wrong"],
    right: 2,
    before: drive({}),
    after: (model) => {
      const settings = drive({})(model);
      const believed = { A: STILL, b: settings.b.map((value) => BELIEVED * value) };
      return { ...settings, believed, kept: settings };
    },
    kept: "before: true speed",
    tells:
      "No. A point 1.5 times as far, passed 1.5 times as fast, looks the same. Every distance is 1.5 times too large.",
    on: "chart",
    note: "1.5 times too far",
    spot: ({ shown }) => ({ time: shown.time[sampleAt(shown, 0.8)], own: sampleAt(shown, 0.8) }),
    holds: ({ shown, ghost }) => {
      const ratio = shown.truth.at(-1) / shown.runs[0].estimate.at(-1);
      return Math.abs(ratio - BELIEVED) < 0.05 && settles(ghost);
    },
  },
  {
    name: "lost",
    chip: "What does y1 tell?",
    ask: "Here y1 changes as fast as y2 + 1/distance. What does an observer of y1 find?",
    answers: ["Both", "Their sum", "Neither"],
    right: 1,
    ...asked(HIDDEN, { ...HIDDEN, outputs: ["y1"] }),
    kept: "before: both",
    tells: "Only the sum of y2 and 1/distance. Each of the two stays wrong, by as much as the other, the other way.",
    on: "image",
    note: "the estimate of y2 is wrong",
    spot: () => ({ at: "estimate" }),
    holds: ({ shown, ghost }) => {
      const ends = (rows) => [rows.at(-2), rows.at(-1)];
      const [[y2, y3], [found2, found3]] = [ends(shown.truth), ends(shown.runs[0].estimate)];
      const sum = Math.abs(found2 + found3 - y2 - y3);
      return sum < 0.01 && Math.abs(found2 - y2) > 0.1 && !settles(shown) && settles(ghost);
    },
  },
];
