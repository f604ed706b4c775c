// Questions worth asking: answers to choose from, then what happens, and perhaps more acts. `right` counts from 0.

import { presetsOf } from "../../common/model/settings.js";

export const PRESETS = presetsOf([
  {
    name: "speedometer",
    title: "Speedometer",
    question:
      "The object rests. Of the camera's velocity only v_c1 is known, as if somebody had read a speedometer. Do the " +
      "pictures tell how far away the object is, and how the camera itself moves?",
    answers: ["Both", "Only how far away the object is", "Neither"],
    right: 0,
    sketch: true,
    acts: [
      {
        changes: { pictures: ["unknowns", "range", "determinant"] },
        answer:
          "Both, within half a second (corollary 1). Only the known velocity v_c1 is in metres, so the scale comes " +
          "from it: v_c1 stands in the determinant.",
      },
      {
        button: "Now v_c1 is zero",
        changes: { v_c: [0, -0.23, 0] },
        answer:
          "A speedometer that shows zero tells no scale: the determinant is zero at every place, and nothing can be " +
          "estimated.",
      },
    ],
  },
  {
    name: "story",
    title: "Which story?",
    question:
      "The picture of the object slides aside. Has the camera moved, or the object? v_c2 and v_p2 are unknown, and " +
      "all the rest is known. Can an observer tell?",
    answers: ["Yes", "No, whatever the observer", "Only if the camera turns"],
    right: 1,
    changes: { v_c: [-0.44, -0.47, 0], v_p: [-0.22, -0.23, 0] },
    acts: [
      {
        button: "Ask for both",
        changes: { unknown: ["v_c2", "v_p2"] },
        answer:
          "No observer can. The image depends on the difference of the two velocities only, whatever the camera does.",
      },
      {
        button: "Know one of them",
        changes: { unknown: ["v_p2"] },
        answer:
          "If the camera's velocity is known, the object's follows. There are three equations for one unknown: two " +
          "more unknowns could be found.",
      },
    ],
  },
  {
    name: "crossing",
    title: "Cross v_c3 = 0",
    question:
      "In corollary 3 the known v_c3 tells the scale. Here the camera goes back along its axis, twice, so that v_c3 " +
      "passes through zero. What does the observer say at that moment?",
    answers: ["It is right, as before", "It says nothing for a moment", "It is lost from then on"],
    right: 1,
    changes: {
      unknown: ["d_s", "v_p1", "v_p2"],
      ybar: [0.4, 0.4, 0.05],
      scale: 4,
      duration: 7,
      v_c: [0, 0, -0.15],
      v_c_swing: [0.3, 0.3, -0.3],
      v_p_swing: [0.2, 0.2, 0],
      pictures: ["unknowns", "determinant", "range"],
    },
    acts: [
      {
        answer:
          "Nothing, for a moment. Where the determinant is too small there is no estimate (shaded). Before and " +
          "after, the estimate is right.",
      },
      {
        button: "Without the guard",
        changes: { gains: { ideal: { largest_amplification: 1e9 } } },
        answer:
          "Dividing by a determinant near zero makes spikes of the smallest errors. They look like estimates, but " +
          "they are not.",
      },
    ],
  },
  {
    name: "noise",
    title: "Noise",
    question:
      "The image coordinates carry noise of a hundredth of a pixel; ȳ3 = 0.05 carries none. How many digits of d_s = " +
      "10.4 will be right?",
    answers: ["Four or more", "Three", "Two or fewer"],
    right: 2,
    changes: { noise: { kind: "gaussian", size: 1.3e-5, depth: 0 }, duration: 10 },
    acts: [
      {
        answer:
          "Hardly two, and fewer with time. Noise enters the rate with a gain that grows like a + b t, and from " +
          "there it enters d_s about 1/ȳ3² = 400 times larger.",
      },
      {
        button: "Keep the gain from growing",
        changes: { gains: { ideal: { sharpening: 0 } } },
        answer: "With b = 0 the scatter stays as it is at the start.",
      },
      {
        button: "Ask a Kalman filter",
        changes: {
          observers: ["ideal", "extended_kalman"],
          gains: { extended_kalman: { noise_variance: 1.69e-10, measured_variance: 1e-4, hidden_process_noise: 0.01 } },
        },
        answer:
          "A filter that knows how large the noise is, and that d_s hardly changes, takes an average: the scatter is " +
          "gone.",
      },
    ],
  },
  {
    name: "chatter",
    title: "Chatter",
    question:
      "The paper's observer switches by the sign of s, infinitely fast. A computer takes steps, here of a " +
      "millisecond. What happens to the estimate of d_s?",
    answers: ["It is as good as the paper's", "It scatters by some per cent", "It is lost"],
    right: 2,
    changes: { observers: ["sign"], hold: "exact", pictures: ["unknowns", "error", "innovation"] },
    acts: [
      {
        answer:
          "It is lost. Each step on the wrong side of s = 0 changes the estimated rate by about γ² c h. Dividing by " +
          "Ωg turns that into several times d_s.",
      },
      {
        button: "Shorter steps",
        changes: { step: 1e-4 },
        answer: "With a tenth of the step there is a tenth of the chatter. It would take steps of microseconds.",
      },
      {
        button: "The ideal switch",
        changes: { observers: ["ideal", "sign"], step: 1e-4 },
        answer:
          "An infinitely fast switch keeps s at exactly 0. This condition can be solved for v without any switching, " +
          "and nothing chatters.",
      },
    ],
  },
  {
    name: "limit",
    title: "Step limit",
    question:
      "A boundary layer of 0.5 smooths the switching, and for ten seconds all is well at steps of a millisecond. The " +
      "slope c = a + b t grows. What will happen within a minute?",
    answers: ["The error becomes ever smaller", "It stays as it is", "The estimate is lost"],
    right: 2,
    sketch: true,
    changes: { duration: 60, pictures: ["unknowns", "error", "innovation"] },
    acts: [
      {
        changes: { observers: ["layer"] },
        answer:
          "The estimate is lost. From 34 s on the step is too long for the layer: γ² c h / 0.5 has reached 2. The " +
          "lab says so before the run; the error shows it a while later.",
      },
      {
        button: "Show the cure",
        changes: { observers: ["ideal", "layer"], gains: { layer: { sharpening: 0 } } },
        answer:
          "There are two cures: the ideal switch, which has no layer, and a slope that does not grow, b = 0. Both " +
          "work to the end.",
      },
    ],
  },
]);
