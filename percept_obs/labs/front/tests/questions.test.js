// Questions have answers to choose from, one of which is right, and a lab says what a step has changed.

import assert from "node:assert/strict";
import test from "node:test";
import { changesInWords } from "../src/common/model/settings.js";
import { PRESETS as ofObserver } from "../src/observer/model/presets.js";
import { PRESETS as ofPoints } from "../src/points/model/presets.js";
import { PRESETS as ofStructure } from "../src/structure/model/presets.js";

for (const [lab, presets] of Object.entries({ ofObserver, ofPoints, ofStructure })) {
  test(`every question of a lab has answers, and says which is right: ${lab}`, () => {
    for (const { name, answers, right, acts } of presets) {
      assert.ok(answers.length >= 2 && new Set(answers).size === answers.length, name);
      assert.ok(Number.isInteger(right) && right >= 0 && right < answers.length, name);
      assert.ok(acts.every(({ answer }) => answer.endsWith(".")), name);
    }
    // Who always takes the same line must not be right.
    assert.ok(new Set(presets.map(({ right }) => right)).size > 1);
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
