// Which time and which values are in sight: all, what the hand asks for, and no more change than needed.
import assert from "node:assert/strict";
import { test } from "node:test";
import { keptScale, linearScale, logScale, spread } from "../src/draw/scales.js";
import { indicesIn, Timeline, zoomed } from "../src/old/timeline.js";
import { spansOf } from "../src/engine/tables.js";
import { decades, distancesAround, rangeAround } from "../src/draw/lines.js";

const WHOLE = { low: 0, high: 80 };

test("a part is zoomed about a time that stays where it is, inside the whole", () => {
  assert.deepEqual(zoomed({ low: 10, high: 30 }, WHOLE, 0.5, 15), { low: 12.5, high: 22.5 });
  assert.deepEqual(zoomed({ low: 10, high: 30 }, WHOLE, 9, 15), WHOLE);
  assert.deepEqual(zoomed({ low: 0, high: 20 }, WHOLE, 2, 20), { low: 0, high: 40 });
});

test("time opens with all of a run, and a zoom stays until the run is another one or the zoom is taken back", () => {
  const timeline = new Timeline();
  timeline.follow(WHOLE, "a", null);
  assert.equal(timeline.span, WHOLE);
  timeline.zoom(0.5, 4);
  const sight = { span: timeline.span, of: timeline.of };
  assert.deepEqual(sight, { span: { low: 2, high: 42 }, of: "a" });
  timeline.follow(WHOLE, "a", sight);
  assert.equal(timeline.span, sight.span);
  timeline.follow({ low: 0, high: 10 }, "b", sight);
  assert.deepEqual(timeline.span, { low: 0, high: 10 });
  timeline.follow(WHOLE, "a", null);
  assert.equal(timeline.span, WHOLE);
});

test("a span needs its own times and one beside it", () => {
  assert.deepEqual(indicesIn([0, 1, 2, 3, 4], { low: 1, high: 2.5 }), [1, 3]);
  assert.deepEqual(indicesIn([0, 1], { low: 0, high: 9 }), [0, 1]);
});

test("a scale stays while the next one lies in it and is not lost there", () => {
  const before = linearScale(0, 10);
  for (const [low, high, kept] of [[1, 9, true], [0, 10, true], [0, 11, false], [4, 6, false]]) {
    const wanted = linearScale(low, high);
    assert.equal(keptScale(before, wanted), kept ? before : wanted);
  }
  const decade = logScale(1e-3, 1);
  assert.equal(keptScale(decade, before), before);
  assert.equal(keptScale(decade, logScale(1e-2, 1)), decade);
});

test("scales hold what is in sight: the level too, and both ends of a distance that goes through decades", () => {
  const bounds = ({ values }, options) => spread(values, { lowPart: 0, highPart: 1, ...options });
  const error = { name: "error", values: [1e-5, 1e-4] };
  assert.ok(decades([error], 1e-6, 1e2)(bounds).high < 2e-4);
  assert.equal(decades([error], 1e-6, 1e2, 0.1)(bounds).high, 1);
  const [near, far] = [[2, 8], [2, 2e6]].map((values) => ({ name: "true", values }));
  assert.equal(distancesAround([near], () => true)(bounds).log, false);
  const { low, high, log } = distancesAround([far], () => true)(bounds);
  assert.ok(log && low <= 2 && high >= 2e6);
  assert.equal(rangeAround([near, far], (l) => l === near)(bounds).high, 15);
});

test("spans begin and end with the samples that have one key", () => {
  const keys = [0, 1, 1, 2, 0, 2];
  const spans = [{ first: 1, last: 2, key: 1 }, { first: 3, last: 3, key: 2 }, { first: 5, last: 5, key: 2 }];
  assert.deepEqual(spansOf(keys.length, (k) => keys[k]), spans);
});
