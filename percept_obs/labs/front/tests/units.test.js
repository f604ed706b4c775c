// The parts of the page that need no browser: random numbers, tables, scales, measures, words.
import assert from "node:assert/strict";
import { schemaAt, schemaOf } from "../src/state/schema.js";
import { test } from "node:test";
import { columnOf } from "../src/engine/derived.js";
import { changeAt, same, valueAt } from "../src/state/settings.js";
import { settlingTime } from "../src/engine/errors.js";
import { PrintedKernels } from "../src/engine/kernels.js";
import { moduleText, Modules } from "../src/engine/modules.js";
import { smallestEigenvalue, windowed } from "../src/labs/observer/measures.js";
import { uniformFrom } from "../src/engine/random.js";
import { linearScale, logScale, readable, roundStep, short, spread } from "../src/draw/scales.js";
import { held, interpolate, lastSamples, stepGrid, windowIn } from "../src/engine/tables.js";
import { inWords, mainly } from "../src/labs/points/directions.js";
import { absencesOf } from "../src/labs/points/measures.js";
import { eigen, pseudoInverse, spectrum } from "../src/labs/points/symmetric.js";
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

test("a window is no longer than the run and no shorter than its intervals, as in Python", () => {
  assert.deepEqual([0.3, 2, 30].map((asked) => windowIn([0, 0.5, 1, 4], asked)), [3, 3, 4]);
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

test("an error has settled from the sample after the last one that is as large as the tolerance or none", () => {
  const found = (...errors) => settlingTime([5, 6, 7], (k) => errors[k], 0.05);
  assert.deepEqual([found(1, 0.01, 0.01), found(0, 0, 0), found(0, 0, NaN), found(NaN, 0, 0)], [1, 0, Infinity, 1]);
  assert.deepEqual([found(1, 0.04, 0.05), found(1, 0.05, 0.04)], [Infinity, 2]);
});

test("numbers are written as Python writes them", () => {
  const pairs = [
    [13.2, "13.2"],
    [80, "80"],
    [0.05, "0.05"],
    [1e-5, "1e-05"],
    [1234, "1230"],
    [2e6, "2e+06"],
    [-0, "0"],
    [-1500, "-1500"],
    [999999, "1e+06"],
    [0, "0"],
    [2.5e-7, "2.5e-07"],
    [21.25, "21.2"],
    [-21.75, "-21.8"],
    [9.995, "9.99"],
  ];
  for (const [value, text] of pairs) assert.equal(short(value), text);
  assert.equal(readable(-2.5e-7), "−2.5e−7");
});

test("scales hold the range, in whole decades or with some room", () => {
  const { low, high } = linearScale(1, 9);
  assert.ok(low < 1 && high > 9 && high - low < 10);
  assert.deepEqual(logScale(3e-3, 20), { low: 1e-3, high: 100, log: true });
  assert.deepEqual([0.3, 2, 7].map(roundStep), [0.5, 2, 10]);
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
  assert.throws(() => moduleText({ "k = 0; alert(1); var x": "function run() {}" }), /is no name of a function/);
});

test("a symmetric matrix's eigenvalues are found, all of them and the extreme ones", () => {
  // Q diag(0, 1e-8, 2, 5) Q with the reflection Q = I - 2 v v^T
  const [v, values] = [[0.5, -0.5, 0.5, 0.5], [0, 1e-8, 2, 5]];
  const Q = (i, j) => (i === j ? 1 : 0) - 2 * v[i] * v[j];
  const matrix = Float64Array.from({ length: 16 }, (_, k) =>
    values.reduce((sum, value, m) => sum + value * Q((k / 4) | 0, m) * Q(m, k % 4), 0),
  );
  const found = spectrum(matrix, 4, 1e-6, [[0, 1, 2, 3]]);
  assert.ok(Math.abs(found.smallest) < 1e-12 && Math.abs(found.largest - 5) < 1e-12);
  assert.equal(found.missed, 2);
  eigen(matrix, 4).forEach(({ value, vector }, m) => {
    assert.ok(Math.abs(value - values[m]) < 1e-14);
    vector.forEach((_, i) => {
      const image = vector.reduce((sum, x, j) => sum + matrix[4 * i + j] * x, 0);
      assert.ok(Math.abs(image - value * vector[i]) < 1e-14);
    });
  });
  assert.deepEqual(spectrum(Float64Array.of(3), 1, 1e-6, [[0]]), { smallest: 3, largest: 3, missed: 0 });
  assert.equal(spectrum(new Float64Array(9), 3, 1e-6, [[0, 1, 2]]).missed, 3);
  const apart = Float64Array.of(2, 0, 1, 0, 0, 5e-9, 0, 0, 1, 0, 2, 0, 0, 0, 0, 7);
  const [together, inParts] = [[[0, 1, 2, 3]], [[0, 2], [1], [3]]].map((parts) => spectrum(apart, 4, 1e-8, parts));
  for (const name of ["smallest", "largest", "missed"])
    assert.ok(Math.abs(together[name] - inParts[name]) < 1e-12, name);
});

test("the pseudo-inverse gives the smallest solution, and the nearest where there is none", () => {
  assert.deepEqual([...pseudoInverse(Float64Array.of(1, 1), 1, 2)], [0.5, 0.5]);
  const lost = pseudoInverse(Float64Array.of(0, 2), 2, 1);
  assert.deepEqual([...lost], [0, 0.5]);
});

test("directions are told as Python tells them", () => {
  const names = ["r_x", "r_y", "d2_x", "d2_y"];
  assert.deepEqual(inWords([[2, 0, -2, 1e-9], [0, 0, 0, -3]], names), ["r_x - d2_x", "d2_y"]);
  assert.deepEqual(inWords([[0.1, 0.2, 0, -0.05]], names), ["0.5 r_x + r_y - 0.25 d2_y"]);
  assert.equal(mainly([0.1, -0.9, 0.2, 0.9], names), "r_y, d2_y, d2_x");
  const many = Array.from({ length: 8 }, (_, k) => `x${k + 1}`);
  assert.deepEqual(inWords([Array(8).fill(1)], many), ["x1 + x2 + x3 + x4 + x5 and 3 more states"]);
});

test("the spans in which a point is not seen end with the next image of it", () => {
  const outputs = [0, 0, NaN, NaN, NaN, NaN, 1, 1];
  assert.deepEqual(absencesOf([0, 1, 2, 3], outputs, 1, 0), [{ first: 1, last: 2, begin: 1, end: 3 }]);
});

test("a value in the settings is read and changed by its place, and nothing else is", () => {
  const settings = { b: [1, 2, 3], start: { mode: "own", values: [0, 0, 0] }, believed: null };
  assert.equal(valueAt(settings, "start.values.1"), 0);
  assert.equal(valueAt(settings, "believed.b.0"), undefined);
  assert.deepEqual(changeAt(settings, "b.1", 5), { b: [1, 5, 3] });
  assert.deepEqual(changeAt(settings, "start.values.1", 5), { start: { mode: "own", values: [0, 5, 0] } });
  assert.deepEqual(settings.b, [1, 2, 3]);
});

test("what follows from a result's rows is made once for them", () => {
  const rows = Float64Array.of(1, 0.5, 2, -1);
  assert.deepEqual([...columnOf(rows, 2, 1)], [0.5, -1]);
  assert.equal(columnOf(rows, 2, 1), columnOf(rows, 2, 1));
});

test("a schema takes ranges from Python and words from the page", () => {
  const told = {
    size: { kind: "number", low: 0, high: 9, usual: [1, 2], step: 0.5, unit: "m" },
    hold: { kind: "choice", names: ["zero", "first"] },
    b: { kind: "row", entries: [{ kind: "number", low: -5, high: 5, label: "b1", nonzero: true }] },
    start: { kind: "optional", of: { kind: "group", of: { mode: { kind: "choice", names: ["own"] } } } },
  };
  const words = {
    hold: { choices: { zero: "held", first: "a line" } },
    b: { name: "true {}" },
    start: { mode: { name: "start" } },
  };
  const schema = schemaOf(told, words);
  const { low, high, least, most, log, label, unit } = schema.size;
  assert.deepEqual([low, high, least, most, log, label, unit], [1, 2, 0, 9, false, "size", "m"]);
  assert.deepEqual(schema.hold.choices, { zero: "held", first: "a line" });
  assert.equal(schema.hold.label, "Hold");
  const entry = schemaAt(schema, "b.0");
  assert.deepEqual([entry.name, entry.label, entry.nonzero, entry.log, entry.low], ["true b1", "b1", true, false, -5]);
  assert.equal(schemaAt(schema, "start.mode").name, "start");
});

test("no gain is allowed before it is known which are, and functions come once all of them are there", async () => {
  const gains = [{ name: "gain", allowed: "function allowed(x, out) { out[0] = x[0] > 0 ? 1 : 0; return out; }" }];
  const kernels = new PrintedKernels({ observers: { ibo: { gains } } }, loadHere);
  assert.equal(kernels.allows("ibo", "gain", 1), false);
  assert.equal(kernels.of({}), undefined);
  await kernels.prepare({});
  assert.deepEqual(kernels.of({}), { observers: {} });
  assert.deepEqual([-1, 1].map((value) => kernels.allows("ibo", "gain", value)), [false, true]);
});
