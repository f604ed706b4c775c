// The parts of the page that need no browser: random numbers, tables, scales, measures, words.
import assert from "node:assert/strict";
import { test } from "node:test";
import { same } from "../src/common/equal.js";
import { moduleText, Modules } from "../src/common/modules.js";
import { settlingTime, smallestEigenvalue, windowed } from "../src/observer/measures.js";
import { uniformFrom } from "../src/common/random.js";
import { linearScale, logScale, readable, short, spread } from "../src/common/scales.js";
import { held, interpolate, lastSamples, stepGrid } from "../src/common/tables.js";
import { loadHere } from "./load_here.js";

test("the generator gives the numbers of the reference implementation", () => {
  // numpy.random.RandomState(5489).random_sample(2), RandomState(0).random_sample(1)
  const reference = uniformFrom(5489);
  assert.deepEqual([reference(), reference()], [0.8147236863931789, 0.9057919370756192]);
  assert.equal(uniformFrom(0)(), 0.5488135039273248);
});

test("steps are equal, no longer than asked, and end at the times", () => {
  const { grid, index } = stepGrid([0, 0.025, 0.03], 0.01);
  assert.deepEqual([...index], [0, 3, 4]);
  assert.equal(grid[3], 0.025);
  assert.ok(Math.abs(grid[1] - 0.025 / 3) < 1e-15);
});

test("a lost sample prolongs the hold, and a line bridges it", () => {
  const [times, values] = [[0, 1, 2], Float64Array.of(1, NaN, 3)];
  assert.deepEqual([...lastSamples(values)], [1, 1, 3]);
  const { grid, index } = stepGrid(times, 1);
  assert.deepEqual([...held([values], times, grid, index, "zero")], [1, 1, 1, 1, 1, 1]);
  assert.deepEqual([...held([values], times, grid, index, "first")], [1, 1.5, 2, 2, 2.5, 3]);
});

test("interpolation is constant outside", () => {
  assert.deepEqual([...interpolate([-1, 0.5, 9], [0, 1], [2, 4])], [2, 3, 4]);
});

test("the smallest eigenvalue keeps its digits when the other is large", () => {
  assert.equal(smallestEigenvalue([3]), 3);
  assert.ok(Math.abs(smallestEigenvalue([1e8, 0, 0, 1e-8]) - 1e-8) < 1e-20);
  assert.ok(Math.abs(smallestEigenvalue([2, 1, 1, 2]) - 1) < 1e-15);
});

test("a constant w gathers in proportion to the window", () => {
  const time = Float64Array.from({ length: 11 }, (_, k) => k / 10);
  const found = windowed(time, new Float64Array(11).fill(2), 1, 1, 0.5);
  assert.equal(found.time.length, 6);
  for (const value of found.smallest) assert.ok(Math.abs(value - 2) < 1e-12);
});

test("the error has settled from the sample after the last one outside", () => {
  assert.equal(settlingTime([5, 6, 7], [1, 0.01, 0.01]), 1);
  assert.equal(settlingTime([5, 6, 7], [0, 0, 0]), 0);
  assert.equal(settlingTime([5, 6, 7], [0, 0, NaN]), Infinity);
});

test("numbers are written as Python writes them", () => {
  const pairs = [[13.2, "13.2"], [80, "80"], [0.05, "0.05"], [1e-5, "1e-05"], [1234, "1.23e+03"], [0, "0"], [2.5e-7, "2.5e-07"], [21.25, "21.2"], [-21.75, "-21.8"], [9.995, "9.99"]];
  for (const [value, text] of pairs) assert.equal(short(value), text);
  assert.equal(readable(-2.5e-7), "−2.5e−7");
});

test("scales have round ticks that hold the range", () => {
  assert.deepEqual(linearScale(0.3, 9.2, 4).ticks, [0, 5, 10]);
  assert.equal(logScale(3e-3, 20).low, 1e-3);
  assert.deepEqual(spread([NaN, 1, 2]), [1, 2]);
});

test("settings are the same whatever the order of their keys", () => {
  assert.ok(same({ a: [1, { b: null }], c: 2 }, { c: 2, a: [1, { b: null }] }));
  assert.ok(!same({ a: 1 }, { a: 1, b: 2 }));
});

test("a text that fails to load says which, and may be loaded once mended", async () => {
  const modules = new Modules(loadHere);
  await assert.rejects(modules.prepare("flat y1 one", { run: "function run( {" }), /"flat y1 one" could not be loaded/);
  await modules.prepare("flat y1 one", { run: "function run() { return 1; }" });
  assert.equal(modules.get("flat y1 one").run(), 1);
  assert.match(moduleText({ run: "function run() {}" }), /^export const run/);
});
