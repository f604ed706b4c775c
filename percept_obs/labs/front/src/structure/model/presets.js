// Points worth seeing: each asks first, then shows, and may have more acts.

import { presetsOf } from "../../common/model/settings.js";

export const PRESETS = presetsOf([
  {
    name: "speedometer",
    title: "A speedometer",
    question:
      "The object rests, and of the camera's velocity only v_c1 is known, as if somebody had read a speedometer. " +
      "Does the camera learn how far away the object is, and how it moves itself?",
    acts: [
      {
        changes: { pictures: ["unknowns", "range", "determinant"] },
        answer:
          "Yes, within half a second: corollary 1. The one known velocity carries the metres, for it stands in the " +
          "determinant.",
      },
      {
        button: "Now v_c1 is zero",
        changes: { v_c: [0, -0.23, 0] },
        answer: "A speedometer that shows zero tells no metres: the determinant is zero everywhere, and nothing can be estimated.",
      },
    ],
  },
  {
    name: "story",
    title: "Which story?",
    question:
      "The picture of the object slides aside. Has the camera moved, or the object? Leave v_c2 and v_p2 unknown, and " +
      "know all the rest. Can an observer tell?",
    changes: { v_c: [-0.44, -0.47, 0], v_p: [-0.22, -0.23, 0] },
    acts: [
      {
        button: "Ask for both",
        changes: { unknown: ["v_c2", "v_p2"] },
        answer: "No observer can: the two velocities act through their difference only, whatever the camera does.",
      },
      {
        button: "Know one of them",
        changes: { unknown: ["v_p2"] },
        answer: "If the camera's is known, the object's follows. Three equations for one unknown: two more unknowns could be told.",
      },
    ],
  },
  {
    name: "crossing",
    title: "Cross v_c3 = 0",
    question:
      "In corollary 3 the known v_c3 carries the metres. Here the camera turns back along its axis, twice, so that v_c3 " +
      "passes through zero. What does the observer say at that moment?",
    changes: {
      unknown: ["d_s", "v_p1", "v_p2"], ybar: [0.4, 0.4, 0.05], scale: 4, duration: 7,
      v_c: [0, 0, -0.15], v_c_swing: [0.3, 0.3, -0.3], v_p_swing: [0.2, 0.2, 0], pictures: ["unknowns", "determinant", "range"],
    },
    acts: [
      {
        answer:
          "Nothing, for a moment: where the determinant is too small for an estimate there is a gap (shaded), and on " +
          "both sides the estimate is right.",
      },
      {
        button: "Without the guard",
        changes: { gains: { ideal: { largest_amplification: 1e9 } } },
        answer:
          "Dividing by a determinant of nearly zero makes spikes out of the least errors. They look like estimates, and are none.",
      },
    ],
  },
  {
    name: "noise",
    title: "A hundredth of a pixel",
    question:
      "The image coordinates carry noise of a hundredth of a pixel, and ȳ3 = 0.05 none. How many digits of d_s = 10.4 will be left?",
    changes: { noise: { kind: "gaussian", size: 1.3e-5, depth: 0 }, duration: 10 },
    acts: [
      {
        answer:
          "Hardly two, and fewer with time: noise passes into the rate with a gain that grows like a + b t, and on into " +
          "d_s about 1/ȳ3² = 400 times larger.",
      },
      {
        button: "Keep the gain from growing",
        changes: { gains: { ideal: { sharpening: 0 } } },
        answer: "With b = 0 the scatter stays what it is at the start.",
      },
      {
        button: "Ask a Kalman filter",
        changes: {
          observers: ["ideal", "extended_kalman"],
          gains: { extended_kalman: { noise_variance: 1.69e-10, measured_variance: 1e-4, hidden_process_noise: 0.01 } },
        },
        answer: "A filter that knows how large the noise is, and that d_s hardly changes, averages it away.",
      },
    ],
  },
  {
    name: "chatter",
    title: "Chatter",
    question:
      "The paper's observer switches by the sign of s, infinitely fast. A computer takes steps: here of a millisecond. " +
      "What becomes of d_s?",
    changes: { observers: ["sign"], hold: "exact", pictures: ["unknowns", "error", "innovation"] },
    acts: [
      {
        answer:
          "It is lost: a step on the wrong side of s = 0 changes the estimated rate by about γ² c h, and the division " +
          "makes several times d_s out of it.",
      },
      {
        button: "Shorter steps",
        changes: { step: 1e-4 },
        answer: "A tenth of the step, a tenth of the chatter. It would take steps of microseconds.",
      },
      {
        button: "The ideal switch",
        changes: { observers: ["ideal", "sign"], step: 1e-4 },
        answer: "Who switches infinitely fast stays on s = 0. Then v is known without any switching, and nothing chatters.",
      },
    ],
  },
  {
    name: "limit",
    title: "A forgotten limit",
    question:
      "A boundary layer of 0.5 smooths the switching, and all is well for ten seconds at steps of a millisecond. " +
      "The slope c = a + b t grows. What will happen within a minute?",
    changes: { duration: 60, pictures: ["unknowns", "error", "innovation"] },
    acts: [
      {
        changes: { observers: ["layer"] },
        answer:
          "From 34 s on the step no longer resolves the layer: γ² c h / 0.5 has reached 2. The lab knows it before the run; " +
          "the estimate is lost a while later.",
      },
      {
        button: "Show the cure",
        changes: { observers: ["ideal", "layer"], gains: { layer: { sharpening: 0 } } },
        answer: "The ideal switch has no layer to resolve; or keep the slope from growing with b = 0. Both hold out.",
      },
    ],
  },
]);
