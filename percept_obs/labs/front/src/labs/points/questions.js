// Questions of the first screen.  What an answer claims is a condition on the result; `right` counts from 0.

import { settingsOf } from "../../state/settings.js";
import { foundAfter, meanErrorOf } from "./sentences.js";

/** Seconds in which a mark is hidden. */
const AWAY = [1, 6];
const NEVER = [0, 120];

/** Settings before an answer, and after it with the run before beside it; they begin like those of the lab. */
function asked(before, after) {
  const round = (changes) => ({ standard, drive: begun }) => settingsOf(changes, { ...standard, ...begun });
  return { before: round({ changes: before }), after: round({ changes: after, beside: before }) };
}

/** The largest distance in the image between a point that is seen at the end and its estimate. */
function offRays({ images, estimated }) {
  const count = images.length;
  const apart = Array.from({ length: 6 }, (_, i) => Math.abs(images[count - 6 + i] - estimated.images[count - 6 + i]));
  return Math.max(...apart);
}

const sampleAt = ({ time }, when) => Math.max(0, time.findIndex((value) => value >= when));
const isFound = (result) => Number.isFinite(foundAfter(result));
const endOff = (result) => meanErrorOf(result).at(-1);

/** True if an error gets smaller and smaller from one time to another, up to a hundredth of what it begins with. */
function shrinks(error, from, to) {
  const spare = 0.01 * error[from];
  let least = error[from];
  for (let k = from; k <= to; k++) {
    if (error[k] > least + spare) return false;
    least = Math.min(least, error[k]);
  }
  return least < 0.5 * error[from];
}
const onChart = (when) => ({ shown }) => ({ time: shown.time[sampleAt(shown, when)], own: sampleAt(shown, when) });

/** @type {import("../../ui/questions.js").Question[]} */
export const QUESTIONS = [
  {
    name: "hide",
    chip: "Hide a mark?",
    ask: "The nose, mark 1, is hidden from 1 to 6 s. What does its own error do meanwhile?",
    answers: ["It stays", "It grows", "It shrinks"],
    right: 2,
    ...asked({}, { hidden: [AWAY, null, null] }),
    kept: "never hidden",
    tells: "It shrinks: the wing tips, marks 2 and 3, are still pulled, and the nose belongs to the same body.",
    on: "chart",
    note: "unseen, yet it shrinks",
    spot: onChart(3),
    holds: ({ shown }) => {
      const [from, to] = AWAY.map((when) => sampleAt(shown, when));
      const [{ first, last }, ...more] = shown.absences[0];
      return first <= from && last >= to - 1 && !more.length && shrinks(shown.errors[0], from, to);
    },
  },
  {
    name: "one",
    chip: "One mark only?",
    ask: "Only mark 1, the nose, is seen. What is found in the end?",
    answers: ["Nothing", "The nose", "All of it"],
    right: 1,
    ...asked({}, { hidden: [null, NEVER, NEVER] }),
    kept: "all seen",
    tells: "The nose alone. Where the wings are changes no picture: drag the dashed copy.",
    on: "world",
    note: "no picture shows this",
    spot: () => ({ at: "copy" }),
    holds: ({ shown, body }) => {
      const { errors } = shown;
      return errors[0].at(-1) < 0.1 * errors[0][0] && errors[2].at(-1) > 1 && body.unseen.length === 6;
    },
  },
  {
    name: "travel",
    chip: "Stand still?",
    ask: "The camera turns, but does not travel. Where does the estimate settle?",
    answers: ["In place", "On its rays", "Off its rays"],
    right: 1,
    ...asked({}, { camera_velocity: [0, 0, 0] }),
    kept: "travelling",
    tells: "On its rays, but metres off. From one spot, near and small or far and large make the same pictures.",
    on: "world",
    note: "the same pictures",
    spot: () => ({ at: "copy" }),
    holds: ({ shown, ghost, body }) =>
      offRays(shown) < 0.01 && endOff(shown) > 1 && body.unseen.length === 3 && isFound(ghost),
  },
  {
    name: "turn",
    chip: "Turn the body?",
    ask: "The camera stands, but the body turns, by a known amount. What is still not found?",
    answers: ["Its shape", "Its size", "Nothing"],
    right: 1,
    ...asked({ camera_velocity: [0, 0, 0] }, { camera_velocity: [0, 0, 0], spin: 1 }),
    kept: "no turning",
    tells: "Its size: twice as large and twice as far makes the same film. Only a travel in metres has a size.",
    on: "world",
    note: "the same film",
    spot: () => ({ at: "copy" }),
    holds: ({ shown, body }) => {
      const { truth, n } = shown;
      const [direction] = body.unseen;
      const size = Math.hypot(...truth.subarray(0, n));
      const along = direction?.reduce((sum, value, i) => sum + (value * truth[i]) / size, 0);
      return body.unseen.length === 1 && Math.abs(along) > 1 - 1e-6 && endOff(shown) > 0.3;
    },
  },
  {
    name: "gain",
    chip: "More gain?",
    ask: "The gain is 6 instead of 0.6: each mark is pulled to its ray ten times as hard. Is the body found sooner?",
    answers: ["Much sooner", "A little sooner", "Later"],
    right: 2,
    ...asked({}, { size: 0.166667 }),
    kept: "gain 0.6",
    tells: "Later: pulled hard, the estimate is on its rays at once, and then too little is left to tell how far.",
    on: "chart",
    note: "on its rays, not in place",
    spot: onChart(6),
    holds: ({ shown, ghost }) => offRays(shown) < 0.04 && !isFound(shown) && isFound(ghost),
  },
];
