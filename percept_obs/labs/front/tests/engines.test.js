// Laws of the page's engines: what Gramians, restarts, gaps, bands and limits must be, whatever Python makes of them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Memory } from "../src/engine/memory.js";
import { knownAt } from "../src/engine/tables.js";
import { Runner } from "../src/engine/runner.js";
import { short } from "../src/draw/scales.js";
import { verdict } from "../src/ui/words.js";
import { translationTowards } from "../src/labs/observer/engine.js";
import { chartOf } from "../src/labs/observer/charts.js";
import { ENTRIES } from "../src/labs/points/flow.js";
import { windowsOf } from "../src/labs/points/gramian.js";
import { decayRate } from "../src/labs/points/measures.js";
import { Observer } from "../src/labs/points/observer.js";
import { StructureEngine } from "../src/labs/structure/engine.js";
import { innovationOf, quantityOf, rangeOf } from "../src/labs/structure/quantities.js";

/** A layout of so many points, each with three states of its own. */
function apart(points) {
  const all = Array.from({ length: 3 * points }, (_, k) => k);
  return {
    begins: Array.from({ length: points + 1 }, (_, p) => 3 * p),
    axes: all.map((k) => k % 3),
    states: all,
    entries: all.map(() => 1),
  };
}

test("a Gramian weighs each direction by what the images would show of it", () => {
  const [time, images] = [Float64Array.of(0, 0.5, 2), Float64Array.of(0.3, -0.2, 0.7, 0.1, 0.4, 0.6)];
  const still = new Float64Array(ENTRIES * time.length);
  const back = new Float64Array(9 * time.length);
  for (let k = 0; k < time.length; k++) {
    for (let i = 0; i < 3; i++) still[ENTRIES * k + 5 * i] = back[9 * k + 4 * i] = 1;
  }
  const model = { block: { N: [[1, 0, 0], [0, 1, 0]], l: [0, 0, 1] }, unseen: 1e-9 };
  const given = { layout: apart(1), model, n: 3, time, images, kindOf: [0], flows: [still], back: [back], window: 2 };
  const { matrix } = windowsOf({ ...given, memory: new Memory() });
  const shown = (v, k) => (v[0] - images[2 * k] * v[2]) ** 2 + (v[1] - images[2 * k + 1] * v[2]) ** 2;
  for (const v of [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, -2, 3], [0.5, 1, -1]]) {
    const found = v.reduce((sum, a, i) => sum + v.reduce((part, b, j) => part + a * matrix[3 * i + j] * b, 0), 0);
    const right = (0.5 * (shown(v, 0) + shown(v, 1)) + 1.5 * (shown(v, 1) + shown(v, 2))) / 2;
    assert.ok(Math.abs(found - right) < 1e-14, `${v}: ${found} instead of ${right}`);
  }
});

test("a point that comes anew lies on its ray, and P knows nothing of it and the others", () => {
  const settings = { state: "independent", depth: 2 };
  const functions = { locate: ([y1, y2, depth]) => [y1 * depth, y2 * depth, depth] };
  const [x, P] = [new Float64Array(6).fill(9), new Float64Array(36).fill(7)];
  const layout = { ...apart(2), names: ["a", "b", "c", "d", "e", "f"] };
  const observer = new Observer({ memory: new Memory() });
  observer.onRays(
    { settings, functions },
    { layout, own: 6, first: 0 },
    [0, 0, 0.5, -0.25],
    [1],
    new Set([0]),
    x,
    P,
    new Float64Array(36).map((_, at) => at),
  );
  [9, 9, 9, 1, -0.5, 2].forEach((value, i) => assert.ok(Math.abs(x[i] - value) < 1e-14));
  P.forEach((value, at) => {
    const [i, j] = [Math.floor(at / 6), at % 6];
    assert.equal(value, i < 3 && j < 3 ? 7 : i < 3 || j < 3 ? 0 : at);
  });
});

/** What a runner makes of gaps that are numbered at the samples. */
function followed(lacking) {
  const time = Float64Array.from(lacking, (_, k) => k);
  class Still extends Runner {
    relativeError() {
      return new Float64Array(time.length);
    }
  }
  const lines = { grid: time, index: [...time.keys()], steps: new Float64Array(time.length - 1).fill(1) };
  const functions = {
    start: (_, out) => out,
    run: () => -1,
    estimate: (_, out) => out.fill(1),
    gap: (x, out) => out.fill(lacking[x[2]]),
  };
  const result = { time, truth: null, width: 2, measured: [0], hidden: [1], tolerance: 0.1 };
  const inputs = {
    ...lines,
    columns: [time],
    last: [time],
    held: [],
    arriving: [],
    own: false,
    known: { rows: new Float64Array(0), width: 0, varying: false },
  };
  const kernel = { gains: [], states: 1, gapReasons: ["the first reason", "the second"] };
  const run = new Still({ observers: { one: { title: "One" } } }).follow(
    "one",
    {},
    result,
    inputs,
    kernel,
    functions,
    [],
  );
  return { ...result, run };
}

test("gaps of two reasons stay two, and each is told with its own", () => {
  const { run, time } = followed([0, 1, 1, 2, 2, 0, 1]);
  assert.deepEqual(run.gaps, [[1, 2, 1], [3, 4, 2], [6, 6, 1]]);
  const verdicts = { followed: "followed", gap: "; {begin}-{end} {reason}", "one more gap": " and one more" };
  const told = verdict(run, { time, truth: null }, { verdicts, remedy: "" });
  assert.equal(told, "followed; 1-2 the first reason and one more; 3-4 the second");
  time.forEach((_, k) => assert.equal(Number.isNaN(run.estimate[2 * k + 1]), [1, 2, 3, 4, 6].includes(k)));
});

test("the band of a filter is two of its deviations to either side", () => {
  const [estimate, deviation] = [Float64Array.of(0, 0, 1, 0, 0, 2), Float64Array.of(0, 0, 0.1, 0, 0, 0.3)];
  const run = { title: "EKF", order: 0, name: "ekf", estimate, deviation, resets: [] };
  const shown = { time: Float64Array.of(0, 1), width: 3, names: ["y1", "y2", "y3"], runs: [run], truth: null };
  const scene = { shown, ghost: null, chosen: run, kept: "", secret: false, theme: { lines: ["black"] } };
  const { band } = chartOf("inverse", scene, { low: 0, high: 1 });
  [0, 1].forEach((k) => {
    assert.ok(Math.abs(band.high[k] - band.low[k] - 4 * deviation[3 * k + 2]) < 1e-14);
    assert.ok(Math.abs((band.high[k] + band.low[k]) / 2 - estimate[3 * k + 2]) < 1e-14);
  });
});

test("where d_s is not positive there is neither a range nor a velocity", () => {
  const result = {
    choice: { unknown: ["d_s", "v_p1"], scaled: [false, true] },
    scale: 1,
    width: 5,
    time: Float64Array.of(0, 1, 2),
  };
  const rows = Float64Array.of(0, 0, 0.5, 4, 2, 0, 0, 0.5, -4, 2, 0, 0, -0.5, -4, 2);
  assert.deepEqual([...rangeOf(result, rows)], [0.5, NaN, NaN]);
  assert.deepEqual([...quantityOf(result, rows, "v_p1")], [0.5, NaN, NaN]);
  assert.deepEqual([...quantityOf(result, rows, "d_s")], [4, NaN, NaN]);
});

test("steps are judged by the fastest rate in them, and told from when they begin", () => {
  const grid = Float64Array.of(5, 5.1, 5.2, 5.3, 5.4);
  const steps = Float64Array.of(0.1, 0.1, 0.1, 0.1);
  const model = { largestStepRate: 0.0299, forms: [{ observers: { ismo: { gains: ["gain"], remedy: "wait" } } }] };
  const settings = { observers: ["ismo"], unknown: [], gains: { ismo: { gain: 1 } } };
  const functions = { observers: { ismo: { fastest: ([time, gain], out) => out.fill(gain * time) } } };
  const [found] = StructureEngine.prototype.limits.call({ model }, { settings }, { grid, steps }, functions);
  for (const [name, value] of [["time", 0.2], ["rate", 0.3], ["step", 0.1], ["shorter", 0.0299 / 0.4]]) {
    assert.ok(Math.abs(found[name] - value) < 1e-9, `${name} is ${found[name]}`);
  }
});

test("where nothing moves a velocity is right or infinitely wrong", () => {
  const truth = Float64Array.of(0, 0, 0.5, 0, 0, 0, 0.5, 0);
  const estimate = Float64Array.of(0, 0, 0.5, 0, 0, 0, 0.5, 1e-9);
  const result = { truth, choice: { unknown: ["v_p1"], scaled: [false] }, width: 4, time: [0, 1], scale: 1, speed: 0 };
  assert.deepEqual([...StructureEngine.prototype.relativeError(result, estimate)], [0, Infinity]);
});

test("two sizes in the last two thirds of a run are enough for a rate", () => {
  const { rate, begin, level } = decayRate([0, 1.5, 3], [9, Math.exp(-0.75), Math.exp(-1.5)]);
  assert.ok(Math.abs(rate - 0.5) < 1e-14 && begin === 1 && Math.abs(level) < 1e-14);
  assert.equal(decayRate([0, 0.9, 3], [1, 1, 1]), null);
});

test("the innovation is the largest difference from the latest samples", () => {
  const [outputs, estimate] = [Float64Array.of(1, -2, 3, 4, 5, NaN), Float64Array.of(0, 0, 0, 0, 0, 9, 8, 7)];
  const rows = { outputs, width: 4 };
  assert.deepEqual([...innovationOf(rows, { estimate })], [3, 5]);
});

test("the focus of expansion is put at a place without a change of the distance", () => {
  const functions = { ray: ([y1, y2]) => [y1, y2, 1], project: ([b1, b2, b3]) => [b1 / b3, b2 / b3, b3] };
  const settings = { b: [3, 1, 2], surface: "pinhole", normal: [0, 0, 1] };
  assert.deepEqual(translationTowards([0.5, -1], settings, functions), [1, -2, 2]);
});

test("what is no number is told as Python tells it", () => {
  assert.deepEqual([NaN, Infinity, -Infinity].map((value) => short(value)), ["nan", "inf", "-inf"]);
});

test("a motion that was sampled changes evenly between its samples", () => {
  const motion = { times: [0, 2], rows: [[1], [3]], columns: [Float64Array.of(1, 3)] };
  assert.deepEqual([...knownAt(motion, [7], [0, 1, 2]).rows], [1, 7, 2, 7, 3, 7]);
});
