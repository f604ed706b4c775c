// Points worth seeing: each asks first, then shows, and may have more acts. A way back is the lab's business.

import { presetsOf, settingsAfter } from "../../common/model/settings.js";

const TUMBLING = [[0.2, -0.1, 3], [0.5, -0.1, 3.1], [0.2, 0.2, 2.8]];
const FIVE_MORE = [[-0.1, -0.3, 3.1], [0.4, 0.1, 3.2], [0, 0.1, 2.9], [0.3, -0.3, 3], [-0.1, 0, 3.2]];

/** `beside` is what a run that is kept beside an act changes. */
export const PRESETS = presetsOf([
  {
    name: "gain",
    title: "The best gain",
    question:
      "One point, P = 1: the error shrinks by 0.18 per second. A third of that P corrects three times as much. " +
      "How much faster will it be?",
    changes: { points: [[0, 1.2, 2.5]], hidden: [null], start: "error", duration: 60, pictures: ["error", "gramian"] },
    acts: [
      {
        button: "Show P = 1/3",
        changes: { size: 0.3333 },
        beside: {},
        answer:
          "It is half as fast, 0.086 per second. Too much correction holds the estimate on the ray and takes away at once " +
          "what should carry the error of the depth across. Move P and find the best.",
      },
      {
        button: "Show P = 3",
        changes: { size: 3 },
        beside: {},
        answer: "A third of the correction, and it is faster: 0.215 per second. Far beyond, at P = 10, it is slow again.",
      },
    ],
  },
  {
    name: "hide",
    title: "Hide a point",
    question: "Point 2 is hidden from 3 to 15 s. What will its error do while nobody sees it?",
    changes: { hidden: [null, [3, 15], null], duration: 20, pictures: ["points", "depth", "gramian"] },
    acts: [
      {
        button: "Show it in one body",
        answer: "It goes on shrinking: X₂ = r + d₂, and r is corrected by what points 1 and 3 show. Only d₂ is left to itself.",
      },
      {
        button: "Now without a body",
        changes: { state: "independent" },
        answer: "It stays as it was. Points that share nothing unknown cannot help each other.",
      },
    ],
  },
  {
    name: "offset",
    title: "Only one point seen",
    question:
      "A body with two points, of which the camera sees the first one only. The body is rigid and its motion is known: " +
      "will the observer find the second point?",
    acts: [
      {
        changes: {
          points: [[0, 1.2, 2.5], [0.5, 0.9, 2.9]], hidden: [null, [0, 60]], start: "error", pictures: ["points", "depth", "gramian"],
        },
        answer: "Never: d₂ changes no image at all. Three directions of the state are not seen, and (14) fails.",
      },
    ],
  },
  {
    name: "sight",
    title: "Along the ray",
    question: "Nothing turns, and the point recedes at a known velocity, along its own ray. Can its depth be found?",
    changes: { turning: 0, input: 0, points: [[0.4, 0.2, 2]], hidden: [null], depth: 3, duration: 15, weight: "riccati", size: 0.01 },
    acts: [
      {
        changes: { velocity: [0.04, 0.02, 0.2] },
        answer:
          "No: its image stands still at any depth. Now drag the point, or turn the velocity, and see the Gramian rise from 0.",
      },
      {
        button: "Now move across",
        changes: { velocity: [-0.2, 0.02, 0.05] },
        answer: "The same speed, but across the ray, which turns now: the depth is found.",
      },
    ],
  },
  {
    name: "input",
    title: "No input",
    question:
      "The body tumbles before a turning camera, and nothing has a known velocity: v = 0. Three points, which move wildly " +
      "in the image. Is that enough?",
    changes: { turning: 0.2, spin: 1, input: 0, window: 6, duration: 20, points: TUMBLING },
    acts: [
      {
        answer:
          "One direction is lost, and it is the state itself: twice all depths and offsets give the same images. What depths " +
          "would tell, images need not.",
      },
      {
        button: "Five more points",
        changes: { points: [...TUMBLING, ...FIVE_MORE] },
        answer: "Still one direction: each point lies on its own ray, however many there are. Give v something, and it is found.",
      },
    ],
  },
  {
    name: "origin",
    title: "An origin of its own",
    question: "All points are seen, and places are counted from an origin that no point marks. What does that cost?",
    changes: { state: "origin" },
    acts: [
      {
        answer:
          "Three directions: shift the origin one way and all offsets the other, and no point moves. Without turning in the " +
          "world, none ever will.",
      },
      {
        button: "Let the body turn",
        changes: { spin: 1, window: 15 },
        answer: "Now that offsets turn otherwise than the origin moves, every direction is seen, if barely.",
      },
    ],
  },
  {
    name: "riccati",
    title: "Constant or not",
    question:
      "With P = 1 the error is still 0.17 m after 30 s, and no constant gain is faster than the rays turn. What else could " +
      "P be?",
    acts: [
      {
        changes: { weight: "riccati", size: 0.01 },
        beside: {},
        answer:
          "A P that keeps the books: small at first, so that much is corrected while nothing is known, and large in " +
          "directions that have been seen well. After 1 s every point is within 10 % of its distance.",
      },
    ],
  },
]);

/** The settings of an act, with those of the run that it keeps beside it. */
export function settingsOf({ changes, beside }, standard) {
  const whole = (part) => {
    const made = settingsAfter({ changes: part }, standard);
    if (made.hidden.length !== made.points.length) made.hidden = made.points.map(() => null);
    return made;
  };
  return { ...whole(changes), kept: beside ? whole(beside) : null };
}
