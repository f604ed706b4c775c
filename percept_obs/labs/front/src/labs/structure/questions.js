// Questions of the first screen.  What an answer claims is a condition on the result; `right` counts from 0.

import { settingsOf } from "../../state/settings.js";
import { unknownOf } from "./worlds.js";

const NOTHING = { rests: false, size: false, ahead: false, sideways: false };
/** The camera drives ahead, brakes and comes back; the observer pauses soon, or practically never. */
const BACK = { v_c: [3, 0, 3], v_c_swing: [0, 0, -4], rate: 0.4 };
const [SOON, NEVER] = [30, 1e7].map((largest) => ({ gains: { ideal: { largest_amplification: largest } } }));

/** Settings of a lab that is given none, with things known and with changes. */
function asked(ticked, changes = {}) {
  return ({ standard, drive, quantities }) => {
    const gains = { ideal: { ...drive.gains.ideal, ...changes.gains?.ideal } };
    const unknown = unknownOf({ ...NOTHING, ...ticked }, quantities);
    return settingsOf({ changes: { ...drive, unknown, ...changes, gains } }, standard);
  };
}

const settles = ({ runs: [run] }) => Number.isFinite(run.settling);

/** Largest error of an estimate between two times. */
function worst({ time, runs: [{ error }] }, low, high) {
  return Math.max(...error.filter((value, k) => time[k] > low && time[k] < high && !Number.isNaN(value)));
}

/** Span in which what is sought nearly drops out of what is seen. */
function lost({ runs: [run] }) {
  const [, first] = run.gaps.find(([, , why]) => why === 2) ?? [0, 0];
  const found = run.gaps.filter(([begin, , why]) => why === 1 && begin > first);
  return found.length ? [found[0][0], found.at(-1)[1]] : [];
}

/** @type {import("../../ui/questions.js").Question[]} */
export const QUESTIONS = [
  {
    name: "speedometer",
    chip: "Speedometer?",
    ask: "The car rests. You read the camera's speed ahead, but not sideways. What does the film tell now?",
    answers: ["Distance", "Everything", "Nothing"],
    right: 1,
    before: asked({ rests: true }),
    after: asked({ rests: true, ahead: true }),
    tells: "One speed in metres a second fixes the size, the distance and the speed sideways.",
    on: "world",
    note: "needs what it reads",
    spot: () => ({}),
    holds: ({ shown }) =>
      ["d_s", "v_c1"].every((name) => shown.choice?.unknown.includes(name)) &&
      settles(shown) && shown.runs[0].error.at(-1) < shown.tolerance,
  },
  {
    name: "story",
    chip: "Who moves?",
    ask: "The size is known. In the film the car slides to the left. Who moves?",
    answers: ["Camera", "Car", "Cannot be told"],
    right: 2,
    before: asked({ size: true }),
    after: asked({ size: true }),
    tells: "Only the difference of both speeds is seen. Tick that the car rests, and one story is left.",
    on: "world",
    note: "the same direction in all three",
    spot: () => ({}),
    holds: ({ shown, worlds }) =>
      Boolean(shown.refusal) &&
      [0, 0.5].every((share) => worlds.difference({ size: 1, share }) < 1e-9) &&
      Math.hypot(...worlds.places({ size: 1, share: 0 }, shown.time.at(-1)).camera) === 0,
  },
  {
    name: "zero",
    chip: "Through zero?",
    ask: "The camera brakes and comes back: its known speed ahead passes zero. What does the estimate do there?",
    answers: ["It pauses", "It gets lost", "It goes on"],
    right: 0,
    before: asked({ rests: true, ahead: true }, { ...BACK, ...SOON }),
    after: (model) => ({
      ...asked({ rests: true, ahead: true }, { ...BACK, ...SOON })(model),
      kept: asked({ rests: true, ahead: true }, { ...BACK, ...NEVER })(model),
    }),
    kept: "without a pause",
    tells: "It pauses: while the camera stands, all worlds look alike. Without the pause (dotted), noise wins.",
    on: "chart",
    note: "nothing to compare",
    spot: ({ shown }) => {
      const [begin, end] = lost(shown);
      return { time: (begin + end) / 2, value: 1 };
    },
    holds: ({ shown, ghost }) => {
      const [begin, end] = lost(shown);
      const { v_c: [, , around], v_c_swing: [, , swing], rate } = shown.settings;
      const [before, after] = [begin, end].map((time) => around + swing * Math.sin(rate * time));
      const last = shown.time.at(-1);
      return before * after < 0 && worst(shown, end, last) < 0.1 && worst(ghost, begin, end) > 0.5;
    },
  },
];
