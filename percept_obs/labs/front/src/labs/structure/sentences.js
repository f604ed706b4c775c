// What the first screen of the structure lab says of a run: the first row that holds, from the values that are drawn.

import { atEnd, DIVERGED, notFound } from "../../ui/sentences.js";
import { estimatedSpeeds, ratiosOf } from "./worlds.js";

/** Numbers of the reasons for gaps. */
export const [NEARLY, LEFT_OVER] = [1, 2];
/** Seconds between gaps that are hatched as one, so that noise does not tear them. */
const TORN = 0.1;

/** Speeds as they are written. */
export const speed = (value) => (Math.abs(value) < 0.05 ? "0.0" : value.toFixed(1)).replace("-", "−");

/** Gaps without the moments between them. */
function joined(gaps) {
  const found = [];
  for (const [begin, end, why] of gaps) {
    const last = found.at(-1);
    if (last && last[2] === why && begin - last[1] < TORN) last[1] = end;
    else if (end - begin > TORN / 2) found.push([begin, end, why]);
  }
  return found;
}

/** Time from which on every estimate that there is lies within the tolerance, as it is drawn as well. */
function foundAt({ error, divergedAt }, ratios, { time, tolerance }) {
  if (divergedAt !== null) return Infinity;
  const off = error.map((value, k) => Math.max(value, Math.abs(ratios[k] - 1)));
  const late = off.findLastIndex((value) => value > tolerance) + 1;
  const first = off.findIndex((value, k) => k >= late && !Number.isNaN(value));
  return first < 0 ? Infinity : time[first];
}

/** True where the size is known and both speeds along an axis are open: one film, many stories. */
export const hasStories = (known) => known.size && known.story.some(Boolean);

/** What is seen, and can be told, at a time: of the worlds, and of the run if something is sought. */
export function seenOf(worlds, { shown, chosen: run, now, at }) {
  const { known } = worlds;
  const ratios = run && ratiosOf(worlds, shown, run);
  const gaps = joined(run?.gaps ?? []);
  const why = gaps.find(([begin, end]) => begin <= now && now <= end)?.[2] ?? 0;
  const settled = run ? foundAt(run, ratios, shown) : Infinity;
  return {
    ...{ run, ratios, known, gaps, why, settled },
    ratio: run && !why ? ratios[at.sample] : NaN,
    estimate: run && !why && known.size ? estimatedSpeeds(worlds, shown, run, at) : null,
    told: Boolean(run),
    free: Boolean(shown.refusal) && !known.nothing,
    stories: hasStories(known),
    found: settled <= now && !why,
    reading: worlds.reading(now),
  };
}

const what = ({ known }) => (known.size ? "speed" : "distance");
const times = (ratio) => `${ratio.toFixed(2)} times`;

/**
 * What may be said, the most important first.  Facts are what is seen at a time, with `shown`, `now`, `end`, `moved`,
 * and `alike`, where it is shown why all worlds look alike.
 *
 * @type {import("../../ui/sentences.js").Sentence[]}
 */
export const SENTENCES = [
  {
    when: ({ alike, stories }) => alike && stories,
    text: () => "In each story the car is in the same direction, as large: the same film.",
  },
  {
    when: ({ alike }) => alike,
    text: () => "Ways and distances grow together, so all directions stay: the same film.",
  },
  { when: ({ known }) => known.nothing, text: () => "All of it is known: nothing is left to estimate." },
  {
    when: ({ free, stories }) => free && stories,
    text: () => "Cannot be told: who moves. The film shows the difference of two speeds only.",
  },
  {
    when: ({ free, known }) => free && !known.rests,
    text: () => "Cannot be told: how large and far the car is, for it may drive itself.",
  },
  {
    when: ({ free, now, end, shown: { time } }) => free && now < (time[0] + end) / 2,
    text: () => "Is it a small car near, or a large one far?",
  },
  {
    when: ({ free, moved }) => free && moved,
    text: () => "A whole family of worlds makes this film: small, near, slow or large, far, fast.",
  },
  { when: ({ free }) => free, text: () => "The film cannot tell. Tick a speed." },
  DIVERGED,
  {
    when: ({ why, known }) => why === NEARLY && known.size,
    text: () => "No estimate now: the car is so far away that noise would be most of it.",
  },
  {
    when: ({ why, reading }) => why === NEARLY && Number(speed(reading?.value ?? 0)) === 0,
    text: () => "No estimate now: the known speed is zero, as it would be in every other world.",
  },
  {
    when: ({ why }) => why === NEARLY,
    text: ({ reading: { value, along } }) =>
      `No estimate now: ${speed(value)} m/s${along} are too few for a car so far away, noise would be most of it.`,
  },
  {
    when: ({ why }) => why === LEFT_OVER,
    text: () => "No estimate yet: what the observer began with still counts for too much.",
  },
  {
    when: ({ found, estimate, known }) => found && estimate && !known.rests,
    text: () => "Found: the car's own speed, as its size and the camera's are known.",
  },
  {
    when: ({ found, estimate }) => found && estimate,
    text: () => "Found: with the size known, the film tells the camera's speed.",
  },
  {
    when: ({ found, reading }) => found && reading && Number(speed(reading.value)) !== 0,
    text: ({ reading }) => `Found: only the true world needs the ${speed(reading.value)} m/s that are read.`,
  },
  { when: ({ found }) => found, text: ({ ratio }) => `Found: the estimate is ${times(ratio)} the true distance.` },
  {
    when: (facts) => atEnd(facts) && Math.abs(facts.ratio - 1) <= facts.shown.tolerance,
    text: (facts) => `${notFound(facts)}: the ${what(facts)} is right, but not yet each part of the motion.`,
  },
  {
    when: (facts) => atEnd(facts) && Number.isFinite(facts.ratio),
    text: (facts) =>
      `${notFound(facts)}: ` +
      `the estimate is ${times(facts.ratio)} the true ${what(facts)}.`,
  },
  { when: ({ ratio }) => !Number.isFinite(ratio), text: () => "No estimate now." },
  { when: ({ estimate }) => estimate, text: () => "The size is known, so the film tells a speed." },
  { when: () => true, text: () => "Each world needs another speed. The estimate slides to the one that is read." },
];
