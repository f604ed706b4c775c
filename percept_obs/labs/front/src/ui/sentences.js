// What the first screens of all labs say in the same words.

import { short } from "../draw/scales.js";
import { filled } from "../state/texts.js";

/** @typedef {{when: (facts: any) => any, text: (facts: any) => string}} Sentence  what may be said of some facts */

export const atEnd = ({ now, end }) => now >= end;

export const notFound = ({ end, shown: { time } }) => `Not found in ${(end - time[0]).toFixed(0)} s`;

/** True in the part of a run in which the first look is told. */
export const isEarly = ({ now, end, shown: { time } }, part) => now - time[0] < part * (end - time[0]);

const divergedAt = ({ run, shown }) => (run ?? shown).divergedAt;

/** @type {Sentence} */
export const DIVERGED = {
  when: (facts) => divergedAt(facts) !== null && divergedAt(facts) <= facts.now,
  text: (facts) => {
    const { verdicts, shown: { time } } = facts;
    const text = filled(verdicts.diverged, { time: short(divergedAt(facts) - time[0]) });
    return `${text[0].toUpperCase()}${text.slice(1)}${verdicts.grew}.`;
  },
};

/** The first of the sentences that holds, the most important first. */
export function firstOf(/** @type {Sentence[]} */ sentences, facts) {
  return /** @type {any} */ (sentences.find(({ when }) => when(facts))).text(facts);
}
