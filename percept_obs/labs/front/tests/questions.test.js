// Questions have answers to choose from, one of which is right, and a lab says what a step has changed.

import assert from "node:assert/strict";
import test from "node:test";
import { changesInWords } from "../src/state/settings.js";
import { QUESTIONS as ofObserver } from "../src/labs/observer/questions.js";
import { QUESTIONS as ofPoints } from "../src/labs/points/questions.js";
import { QUESTIONS as ofStructure } from "../src/labs/structure/questions.js";

for (const [lab, questions] of Object.entries({ ofObserver, ofPoints, ofStructure })) {
  test(`every question is one line with three answers, and its answer has 25 words at most: ${lab}`, () => {
    for (const { name, chip, ask, answers, right, tells, note } of questions) {
      assert.ok(answers.length === 3 && new Set(answers).size === 3, name);
      assert.ok([0, 1, 2].includes(right) && chip && note && /[?]$/.test(ask), name);
      assert.ok(tells.split(" ").length <= 25 && tells.endsWith("."), name);
    }
    // Who always takes the same line must not be right.
    assert.ok(new Set(questions.map(({ right }) => right)).size > 1);
  });
}

test("what a step has changed is told by names, and what has not is not", () => {
  const before = { b: [1, 2, 3], noise: { size: 0 }, seed: 1, kept: null };
  const names = { b: "the translation b", noise: "noise" };
  const told = (after) => changesInWords(before, { ...before, ...after }, names);
  assert.equal(told({}), "Nothing has changed.");
  assert.equal(told({ b: [1, 2, 4] }), "Changed: the translation b. All else is as it was.");
  assert.equal(
    told({ b: [0, 2, 3], noise: { size: 1 }, seed: 2, kept: {} }),
    "Changed: the translation b, noise and the seed. All else is as it was.",
  );
});
