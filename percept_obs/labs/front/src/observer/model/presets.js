// Questions worth asking: answers to choose from, then what happens, and perhaps a second act. `right` counts from 0.

import { presetsOf } from "../../common/model/settings.js";

/** A of (35), the standard motion, whose b is 0.5, 0.25, 0.3. */
const A_OF_35 = [[-0.2, 0.4, -0.6], [0.1, -0.2, 0.3], [0.3, -0.4, 0.4]];
const NOISE = { kind: "uniform", size: 0.01 };

export const PRESETS = presetsOf([
  {
    name: "foe",
    title: "Cross the FOE",
    question:
      "The image of the point runs through the focus of expansion, where the camera's motion does not move it. Does " +
      "the observer lose the distance there?",
    answers: ["No, it does not matter", "For a moment only", "For good, it has to start again"],
    right: 1,
    changes: { b: [0, 0, 0.8], duration: 12, window: 2 },
    acts: [
      {
        changes: { A: [[0, 0, 0.1], [0, 0, 0], [-0.1, 0, 0]], X0: [-2, 0, 2] },
        answer:
          "For a moment only. While the image crosses the red circle, an instant tells almost nothing of the " +
          "distance. The seconds before and after do, and in between the observer goes on by its equations.",
      },
      {
        button: "Now stay there",
        changes: { A: [[0, 0, 0], [0, 0, 0], [0, 0, 0]], X0: [0, 0, 2] },
        answer:
          "A point that stays on the focus of expansion stands still in the image, at any distance. So its distance " +
          "is never found. Look at the arrows: the near copy and the far copy do not move either.",
      },
    ],
  },
  {
    name: "drop",
    title: "Drop y2",
    question:
      "Without y2 each sample is one number, and two coordinates are hidden. Can one number at a time tell both?",
    answers: ["No, never", "Yes, but it takes longer", "Yes, and as fast as before"],
    right: 1,
    sketch: true,
    acts: [
      {
        changes: { outputs: ["y1"] },
        answer:
          "Yes, over time. At one instant w wᵀ has rank 1: it tells one direction only. The direction turns, so ten " +
          "seconds tell both. The error is below 10 % after 12 s instead of 1.9 s.",
      },
    ],
  },
  {
    name: "gain",
    title: "Too much gain",
    question:
      "With gain 10 the error is below 10 % after 1.9 s. Now the outputs carry noise. Would a gain of 60 be better?",
    answers: ["Faster, but less exact", "Yes, faster and as exact", "Neither faster nor more exact"],
    right: 0,
    sketch: true,
    changes: { noise: NOISE, duration: 8, window: 2, pictures: ["innovation", "step", "error"] },
    acts: [
      {
        changes: { gains: { identifier_based: { gain: 60 } } },
        beside: { gains: { identifier_based: { gain: 10 } } },
        answer:
          "It is faster, and it follows the noise: the error ends about ten times higher. The kept run has gain 10. " +
          "The innovation is about as large in both runs, for most of it is noise. But each step of the estimate is " +
          "the innovation times the square of the gain. That is 36 times as large with gain 60, and the steps are " +
          "about 30 times as large.",
      },
    ],
  },
  {
    name: "bias",
    title: "Noise bias",
    question:
      "Only y1 is measured, with small noise, and the estimate starts at zero. Noise averages out, so the estimate " +
      "should be right on average in the end. Does it?",
    answers: ["No, it is pushed away from the truth", "Yes, it scatters about the truth"],
    right: 0,
    changes: {
      outputs: ["y1"],
      noise: NOISE,
      start: { mode: "zero", values: [0, 0, 0] },
      seed: 1,
      pictures: ["innovation", "inverse", "error"],
    },
    acts: [
      {
        answer:
          "No. The same noise is in w and in the innovation, and the mean of their product is not 0. It pushes the " +
          "estimate to the bound, where it is reset again and again. Look at the innovation: most of it is no larger " +
          "than the noise, so the observer cannot see that it is wrong.",
      },
      {
        button: "Show the cure",
        changes: { gains: { identifier_based: { noise_variance: 1e-4 / 3 } } },
        answer:
          "If the variance of the noise is known, so is this mean, and the observer can take it out. Then the " +
          "estimate stays about the truth, as near as one noisy output tells it.",
      },
    ],
  },
  {
    name: "belief",
    title: "Wrong motion",
    question: "The observer believes in 1.5 times the true translation b. Will it notice that it is wrong?",
    answers: [
      "Yes, the outputs will not fit",
      "No, and the distance is right all the same",
      "No, and every distance comes out wrong",
    ],
    right: 2,
    acts: [
      {
        changes: { pictures: ["outputs", "distance", "error"], believed: { A: A_OF_35, b: [0.75, 0.375, 0.45] } },
        answer:
          "No. A point that is 1.5 times as far and moves 1.5 times as fast looks exactly the same. The outputs fit, " +
          "and every distance comes out 1.5 times too large: only b tells the observer how long a metre is.",
      },
    ],
  },
]);
