// Questions worth asking: answers to choose from, then what happens, and perhaps more acts. `right` counts from 0.

import { presetsOf } from "../../common/model/settings.js";

const TUMBLING = [[0.2, -0.1, 3], [0.5, -0.1, 3.1], [0.2, 0.2, 2.8]];
const FIVE_MORE = [[-0.1, -0.3, 3.1], [0.4, 0.1, 3.2], [0, 0.1, 2.9], [0.3, -0.3, 3], [-0.1, 0, 3.2]];

const ASKED = [
  {
    name: "hide",
    title: "Hide a point",
    question: "Point 2 is hidden from 3 to 15 s. What will its error do while nobody sees it?",
    answers: ["It goes on shrinking", "It stays as it is", "It grows"],
    right: 0,
    changes: { hidden: [null, [3, 15], null], duration: 20, pictures: ["points", "depth", "gramian"] },
    acts: [
      {
        button: "Show it in one body",
        answer: "It goes on shrinking: X₂ = r + d₂, and points 1 and 3 still correct r. Only d₂ is not corrected.",
      },
      {
        button: "Now without a body",
        changes: { state: "independent" },
        answer: "It stays as it is. Points that have no unknown in common cannot help each other.",
      },
    ],
  },
  {
    name: "gain",
    title: "The best gain",
    question:
      "One point, P = 1: the error shrinks by 0.18 per second. A third of that P corrects three times as much. How " +
      "fast will the error shrink?",
    answers: ["Three times as fast", "A little faster", "More slowly"],
    right: 2,
    sketch: true,
    asks: {
      hold: "exact",
      points: [[0, 1.2, 2.5]],
      hidden: [null],
      start: "error",
      duration: 60,
      pictures: ["error", "gramian"],
    },
    changes: { points: [[0, 1.2, 2.5]], hidden: [null], start: "error", duration: 60, pictures: ["error", "gramian"] },
    acts: [
      {
        button: "Show P = 1/3",
        changes: { size: 0.3333 },
        beside: {},
        answer:
          "More slowly, by 0.086 per second: half as fast. Too much correction holds the estimate on the ray, and " +
          "the ray cannot turn the error of the depth into something that is seen. Move P and find the best.",
      },
      {
        button: "Show P = 3",
        changes: { size: 3 },
        beside: {},
        answer:
          "A third of the correction, and it is faster: 0.215 per second. Far beyond, at P = 10, it is slow again.",
      },
    ],
  },
  {
    name: "offset",
    title: "One point seen",
    question:
      "A body with two points, of which the camera sees the first one only. The body is rigid and its motion is " +
      "known: will the observer find the second point?",
    answers: ["Yes, a little later than the first", "Yes, but only if the body turns", "No, never"],
    right: 2,
    acts: [
      {
        changes: {
          points: [[0, 1.2, 2.5], [0.5, 0.9, 2.9]],
          hidden: [null, [0, 60]],
          start: "error",
          pictures: ["points", "depth", "gramian"],
        },
        answer:
          "Never. The offset d₂ changes no image at all: three directions of the state are not seen, and condition " +
          "(14) fails.",
      },
    ],
  },
  {
    name: "sight",
    title: "Along the ray",
    question: "Nothing turns, and the point recedes at a known velocity, along its own ray. Can its depth be found?",
    answers: ["Yes, its velocity is known", "No"],
    right: 1,
    changes: {
      turning: 0,
      input: 0,
      points: [[0.4, 0.2, 2]],
      hidden: [null],
      depth: 3,
      duration: 15,
      weight: "riccati",
      size: 0.01,
    },
    acts: [
      {
        changes: { velocity: [0.04, 0.02, 0.2] },
        answer:
          "No. Its image stands still at any depth. Drag the point, or turn the velocity, and see the Gramian rise " +
          "from 0.",
      },
      {
        button: "Now move across",
        changes: { velocity: [-0.2, 0.02, 0.05] },
        answer: "The speed is the same, but across the ray. Now the ray turns, and the depth is found.",
      },
    ],
  },
  {
    name: "input",
    title: "No input",
    question:
      "The body tumbles before a turning camera, and no velocity is known: v = 0. Three points move wildly in the " +
      "image. Is that enough to find their depths?",
    answers: ["Yes, three points are enough", "No, it takes more points", "No, however many points there are"],
    right: 2,
    changes: { turning: 0.2, spin: 1, input: 0, window: 6, duration: 20, points: TUMBLING },
    acts: [
      {
        answer:
          "No. One direction is not seen, and it is the state itself: twice all depths and offsets give the same " +
          "images. More points do not help, as the next act shows.",
      },
      {
        button: "Five more points",
        changes: { points: [...TUMBLING, ...FIVE_MORE], hidden: new Array(8).fill(null) },
        answer:
          "Still the same direction is not seen: twice the size, twice as far, the same images. Let v be other than " +
          "0, and it is found.",
      },
    ],
  },
  {
    name: "origin",
    title: "Own origin",
    question:
      "All points are seen, and their places are counted from an origin that no point marks. How many directions of " +
      "the state are not seen?",
    answers: ["None", "One, along the ray of the origin", "Three"],
    right: 2,
    changes: { state: "origin" },
    acts: [
      {
        answer:
          "Three: shift the origin one way and all offsets the other way, and no point moves. As long as the body " +
          "does not turn, that stays so.",
      },
      {
        button: "Let the body turn",
        changes: { spin: 1, window: 15 },
        answer:
          "Now the offsets turn and the origin does not turn with them, so every direction is seen, though barely.",
      },
    ],
  },
  {
    name: "riccati",
    title: "Riccati",
    question:
      "With P = 1 the error is still 0.17 m after 30 s, and no constant P is faster than the rays turn. How soon is " +
      "every point within 10 % of its distance if P follows a Riccati equation?",
    asks: { hold: "exact" },
    answers: ["After about 1 s", "After about 10 s", "No sooner than with a constant P"],
    right: 0,
    sketch: true,
    acts: [
      {
        changes: { weight: "riccati", size: 0.01 },
        beside: {},
        answer:
          "After about 1 s. This P is small at first, so that much is corrected while nothing is known, and it " +
          "becomes large in the directions that have been seen well.",
      },
    ],
  },
];

/**
 * The acts show what the equations do, with the exact signal: what sampling does besides, the lab shows when it opens.
 */
export const PRESETS = presetsOf(ASKED.map((preset) => ({ ...preset, changes: { hold: "exact", ...preset.changes } })));
