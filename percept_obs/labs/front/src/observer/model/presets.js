// Points worth seeing: each asks first, then shows, and may have a second act. A way back is the lab's business.

import { presetsOf, settingsAfter } from "../../common/model/settings.js";

const NOISE = { kind: "uniform", size: 0.01 };

export const PRESETS = presetsOf([
  {
    name: "foe",
    title: "Cross the FOE",
    question:
      "The image of the point runs through the focus of expansion, where the camera's motion does not move it. " +
      "Does the observer lose the distance there, for a moment or for good?",
    changes: { b: [0, 0, 0.8], duration: 12, window: 2 },
    acts: [
      {
        changes: { A: [[0, 0, 0.1], [0, 0, 0], [-0.1, 0, 0]], X0: [-2, 0, 2] },
        answer:
          "For a moment only: while the image crosses the circle an instant tells nothing, but the window around it " +
          "still does, and the estimate carries on by the dynamics.",
      },
      {
        button: "Now stay there",
        changes: { A: [[0, 0, 0], [0, 0, 0], [0, 0, 0]], X0: [0, 0, 2] },
        answer: "Who stays on the focus of expansion never sees the distance: the image stands still, whatever it is.",
      },
    ],
  },
  {
    name: "drop",
    title: "Drop y2",
    question: "Without y2 each sample is one number, and two coordinates are hidden. Can one number at a time tell both?",
    acts: [
      {
        changes: { outputs: ["y1"] },
        answer:
          "Over time it can: w wᵀ has rank 1 at every instant, yet its integral over ten seconds has rank 2. " +
          "It takes 12 s instead of 1.9 s.",
      },
    ],
  },
  {
    name: "gain",
    title: "Too much gain",
    question: "With gain 10 the error is below 10 % after 1.9 s. The outputs carry noise now. Would a gain of 60 be better?",
    acts: [
      {
        changes: { noise: NOISE, gains: { identifier_based: { gain: 60 } }, pictures: ["inverse", "distance", "error"] },
        answer: "It is faster, and follows the noise: the error settles about ten times higher. Move G and find the best.",
      },
    ],
  },
  {
    name: "bias",
    title: "Noise bias",
    question:
      "Only y1, small noise, the printed gains, a start at zero. Noise averages out, so the estimate should end up " +
      "right on average. Does it?",
    changes: {
      outputs: ["y1"], noise: NOISE, start: { mode: "zero", values: [0, 0, 0] }, seed: 1, pictures: ["inverse", "error", "excitation"],
    },
    acts: [
      {
        answer:
          "No: the same noise is in w and in the error, and their product has a mean. It pushes the estimate to the " +
          "bound, where it is reset again and again.",
      },
      {
        button: "Show the cure",
        changes: { gains: { identifier_based: { noise_variance: 1e-4 / 3 } } },
        answer:
          "The mean is known once the variance of the noise is: taken out, the estimate stays about the truth, as near " +
          "as one noisy output tells it.",
      },
    ],
  },
  {
    name: "belief",
    title: "Wrong motion",
    question: "The observer believes that the point moves half as fast again as it does: b is 1.5 b. Will it notice?",
    acts: [
      {
        changes: { pictures: ["outputs", "distance", "error"] },
        believe: 1.5,
        answer:
          "No: a point half as far again that moves half as fast again looks exactly the same. The outputs fit, and every " +
          "distance comes out 1.5 times too large: scale is only known through b.",
      },
    ],
  },
]);

/** The settings of an act, whose observers may believe a motion so many times as fast. */
export function settingsOf(act, standard) {
  const changed = settingsAfter(act, standard);
  if (act.believe) changed.believed = { A: changed.A, b: changed.b.map((value) => value * act.believe) };
  return changed;
}
