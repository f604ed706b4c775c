// What the first screen of many points says of a run: the first row that holds, from the values that are drawn.

import { derived } from "../../engine/derived.js";
import { settlingTime } from "../../engine/errors.js";
import { valueBetween } from "../../engine/between.js";
import { atEnd, DIVERGED, isEarly, notFound } from "../../ui/sentences.js";
import { Body } from "./body.js";
import { OWN } from "./kernels.js";

/** Part of a body's size within which an estimate of a mark is drawn on the mark. */
const ON_IT = 1 / 30;
/** What no picture shows may move no point, as an origin of its own does. */
const LEAST_REACH = 1e-6;
/** Part of the run in which the first look is told. */
const EARLY = 0.2;

/** Names of the marks of an aeroplane. */
export const PARTS = ["nose", "left wing tip", "right wing tip"];

/** True for points that are drawn as an aeroplane: three marks of one body. */
export function isPlane({ state, points }) {
  return state !== "independent" && state !== OWN && points.length === PARTS.length;
}

/** Metres off within which every mark must be for the body to be found; for one point, a part of its distance. */
function nearEnough({ settings: { points } }) {
  const apart = points.flatMap((one) => points.map((other) => Math.hypot(...one.map((value, i) => value - other[i]))));
  return ON_IT * (Math.max(...apart) || Math.hypot(...points[0]));
}

/** Seconds after which every mark is near enough, and stays so to the end. */
export function foundAfter(shown) {
  return derived(shown.estimate, "found after", () => {
    const near = nearEnough(shown);
    return settlingTime(shown.time, (k) => Math.max(...shown.errors.map((error) => error[k])), near);
  });
}

/** How far the estimate is off, in metres: the mean of its points at each sample. */
export function meanErrorOf({ estimate, errors }) {
  return derived(estimate, "mean error", () =>
    errors[0].map((_, s) => errors.reduce((sum, error) => sum + error[s], 0) / errors.length),
  );
}

/** What is seen at a time: the body, its marks and their estimates before the camera, and what no picture shows. */
export function seenOf({ engine, model, kernels }, { shown, at, now }) {
  const body = new Body(engine, model, shown, kernels.of(shown.settings), at);
  const places = body.places(body.state(shown.truth));
  const reaches = places.map((_, k) => body.movable(k).reduce((sum, [x, z]) => sum + x * x + z * z, 0));
  const { time, outputs, points } = shown;
  return {
    ...{ body, places, found: body.places(body.state(shown.estimate)) },
    hidden: places.map((_, k) => Number.isNaN(outputs[2 * (at.sample * points + k)])),
    /** The point that moves most in what no picture shows, and whether any moves. */
    held: reaches.indexOf(Math.max(...reaches)),
    free: Math.max(...reaches) > LEAST_REACH,
    off: valueBetween(meanErrorOf(shown), 1, 0, at),
    isFound: foundAfter(shown) <= now - time[0],
  };
}

/** Metres from which on none are counted. */
const FAR = 999;

/** A distance as it is written, so that what is small is not nothing. */
export const metres = (value) => (value > FAR ? `over ${FAR} m` : `${value.toFixed(value < 1 ? 2 : 1)} m`);

const still = ({ shown: { settings } }) =>
  settings.input === 0 && settings.camera_velocity.every((value) => value === 0);
const away = ({ hidden }) => hidden.flatMap((one, k) => (one ? [k] : []));

/** The marks that are hidden, by name. */
function hiddenOnes(facts) {
  const plane = isPlane(facts.shown.settings);
  const names = away(facts).map((k) => (plane ? `the ${PARTS[k]} (mark ${k + 1})` : `mark ${k + 1}`));
  const text = names.length > 2 ? `${names.length} marks` : names.join(" and ");
  return `${text[0].toUpperCase()}${text.slice(1)} ${names.length > 1 ? "are" : "is"} hidden`;
}

/**
 * What may be said, the most important first.  Facts are what is seen at a time, with `shown`, `now`, `end`, `why`,
 * `moved`, and `prelude` for the first look.
 *
 * @type {import("../../ui/sentences.js").Sentence[]}
 */
export const SENTENCES = [
  {
    when: ({ prelude }) => prelude,
    text: () => "One picture shows directions only: near and small, or far and large, looks the same.",
  },
  {
    when: (facts) => facts.why && still(facts) && facts.free,
    text: () => "Three bodies, one picture: without a travel of the camera they go on looking alike.",
  },
  {
    when: (facts) => facts.why && !still(facts),
    text: () => "Three bodies, one picture. The camera's travel shifts the near one most: that tells them apart.",
  },
  { when: ({ why }) => why, text: () => "Three bodies, one picture: near and small, as it is, and far and large." },
  DIVERGED,
  {
    when: (facts) => away(facts).length === facts.hidden.length,
    text: () => "No mark is seen: nothing pulls the estimate.",
  },
  {
    when: (facts) => facts.free && atEnd(facts) && !facts.isFound,
    text: ({ off }) => `Still ${metres(off)} off. The dashed copy makes the same pictures: drag it.`,
  },
  {
    when: (facts) => facts.isFound && atEnd(facts) && !facts.moved,
    text: () => "Found. Now press a mark to hide it, or drag it.",
  },
  {
    when: (facts) => away(facts).length && facts.shown.settings.state === "independent",
    text: (facts) => `${hiddenOnes(facts)}: no ray pulls there.`,
  },
  {
    when: (facts) => away(facts).length,
    text: (facts) => `${hiddenOnes(facts)}: no ray pulls there, but the marks that are seen carry the body.`,
  },
  { when: ({ isFound }) => isFound, text: ({ off }) => `Found: the estimate lies on the body, ${metres(off)} off.` },
  {
    when: atEnd,
    text: (facts) => `${notFound(facts)}: the estimate is ${metres(facts.off)} off.`,
  },
  {
    when: (facts) => isEarly(facts, EARLY),
    text: () => "The estimate, in blue: each of its marks is pulled across to the ray of the true one.",
  },
  {
    when: (facts) => still(facts) && facts.free,
    text: () => "The camera does not travel: it sees the body from one spot, and nothing tells how far it is.",
  },
  {
    when: (facts) => !still(facts),
    text: () => "The camera travels, so the rays turn and pull anew: the estimate slides along them.",
  },
  { when: () => true, text: () => "The rays turn and pull anew: the estimate slides along them." },
];
