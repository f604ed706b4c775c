// What is computed beside the page: the latest settings only, the same results, and the page alone where there is
// nobody.
import assert from "node:assert/strict";
import { test } from "node:test";
import { distanceError } from "../src/engine/errors.js";
import { Latest } from "../src/engine/latest.js";
import { moduleText } from "../src/engine/modules.js";
import { constantPath } from "../src/engine/path.js";
import { Memory } from "../src/engine/memory.js";
import { serve } from "../src/engine/serving.js";
import { entriesOf, textsOfP } from "../src/labs/points/sparse.js";
import { loadHere } from "./load_here.js";

/** A page's latest result, with something beside it that notes what it is asked. */
function asking() {
  const [tasks, told] = [[], []];
  const results = { of: (settings, whole) => ({ shown: { settings, whole, here: true }, ghost: null }) };
  const latest = new Latest(results, (error) => told.push(error));
  latest.beside = { ask: (task) => tasks.push(task) };
  return { latest, tasks, told };
}

test("while one task is under way only the latest of the others waits", () => {
  const { latest, tasks, told } = asking();
  const [first, second, third] = [1, 2, 3].map((gain) => ({ gain, kept: null }));
  assert.equal(latest.want(first, false), false);
  assert.equal(latest.want(second, false), false);
  assert.equal(latest.want(third, false), false);
  assert.deepEqual(tasks, [{ settings: first, whole: false }]);
  latest.take({ shown: { whole: false, value: 1 }, ghost: null });
  assert.equal(latest.shown.settings, first);
  assert.deepEqual(tasks[1], { settings: third, whole: false });
  latest.take({ shown: { whole: false, value: 3 } });
  assert.equal(latest.shown.settings, third);
  assert.equal(latest.want(third, false), true);
  assert.equal(latest.want(third, true), false);
  assert.deepEqual(tasks[2], { settings: third, whole: true });
  assert.equal(latest.want(third, false), true);
  assert.deepEqual(told, [undefined, undefined]);
});

test("a ghost stays until another one comes, and an error ends the waiting for an answer", async () => {
  const { latest, told } = asking();
  const settings = { gain: 1, kept: { gain: 2 } };
  latest.want(settings, true);
  latest.take({ shown: { whole: true }, ghost: { value: 2 } });
  const other = { gain: 3, kept: settings.kept };
  latest.want(other, true);
  latest.take({ shown: { whole: true } });
  assert.deepEqual(latest.ghost, { value: 2, settings: settings.kept });
  latest.want({ gain: 4 }, true);
  const next = latest.next();
  latest.take({ error: "no such observer" });
  await assert.rejects(next, /no such observer/);
  assert.equal(told.at(-1), "no such observer");
  assert.equal(latest.shown.settings, other);
});

test("when nobody is left beside the page, it computes by itself and nobody waits in vain", async () => {
  const { latest } = asking();
  const settings = { gain: 1 };
  latest.want(settings, true);
  const next = latest.next();
  latest.lose();
  await next;
  assert.equal(latest.want(settings, true), true);
  assert.equal(latest.shown.here, true);
});

/** A worker's side that is spoken to as a page would, with copies; it gives all that it has answered. */
async function served(messages) {
  const answers = [];
  const scope = { postMessage: (answer) => answers.push(structuredClone(answer)) };
  const runs = [];
  class Engine {
    run(settings, functions, whole) {
      if (settings.gain < 0) throw new Error("the gain is negative");
      runs.push(settings.gain);
      return { settings, whole, time: [0, 1], value: functions.factor * settings.gain };
    }

    completed(result) {
      runs.push("completed");
      return { ...result, whole: true };
    }
  }
  class Kernels {
    async prepare() {}

    of() {
      return { factor: 2 };
    }
  }
  serve(() => ({ Kernels, Engine }), scope);
  const packed = await new Response(
    new Blob(["\t{}"]).stream().pipeThrough(new CompressionStream("gzip")),
  ).arrayBuffer();
  for (const message of [{ kind: "small", texts: packed, model: {} }, ...messages]) {
    const before = answers.length;
    scope.onmessage({ data: structuredClone(message) });
    while (answers.length === before) await new Promise((resolve) => setImmediate(resolve));
  }
  return { answers, runs };
}

test("a worker answers each message, runs the kept settings once, completes results, and tells errors", async () => {
  const kept = { gain: 5, kept: null };
  const settings = { gain: 1, kept };
  const { answers, runs } = await served([
    { settings, whole: false },
    { settings, whole: true },
    { settings: { gain: 2, kept }, whole: false },
    { settings: { gain: -1, kept: null }, whole: true },
  ]);
  assert.deepEqual(answers[0], { ready: true });
  assert.deepEqual(answers[1], {
    shown: { settings: null, whole: false, time: [0, 1], value: 2 },
    ghost: { settings: kept, whole: true, time: [0, 1], value: 10 },
  });
  assert.deepEqual(answers[2], { shown: { settings: null, whole: true, time: [0, 1], value: 2 } });
  assert.deepEqual(answers[3], { shown: { settings: null, whole: false, time: [0, 1], value: 4 } });
  assert.deepEqual(answers[4], { error: "the gain is negative" });
  assert.deepEqual(runs, [5, 1, "completed", 2]);
});

test("a value is made anew when a setting that it or what it is made of has read changes, and only then", () => {
  const memory = new Memory();
  let runs = 0;
  const opening = { gains: { one: { gain: 1 }, two: { gain: 1 } }, believed: null, X0: [1, 2], window: 1, seed: 0 };
  const inner = (settings) => memory.once("inner", settings, ({ X0, seed }) => [...X0, seed]);
  const make = (settings) => {
    runs += 1;
    return [settings.gains.one.gain, settings.believed ? 1 : 0, ...inner(settings)];
  };
  const after = (changes, input = 0) => {
    memory.once("outer", { ...opening, ...changes }, make, input);
    return runs;
  };
  assert.equal(after({}), 1);
  for (const changes of [{ gains: { ...opening.gains, two: { gain: 9 } } }, { window: 2 }, { X0: [1, 2] }]) {
    assert.equal(after(changes), 1);
  }
  const others = [{ gains: { one: { gain: 2 } } }, { seed: 1 }, { believed: { b: 1 } }, { X0: [1, 3] }];
  for (const [k, changes] of others.entries()) assert.equal(after(changes), k + 2);
  inner(opening); // what is kept already counts as read as well
  assert.equal(after({}), 6);
  assert.equal(after({ seed: 2 }), 7);
  assert.equal(after({ seed: 2 }, 1), 8);
  assert.throws(() => memory.once("all", opening, (settings) => ({ ...settings })), /read settings by their names/);
});

/** A layout of a body: a vector that all points share, and one for each other point; A turns each of them. */
function body(points) {
  const [begins, axes, states] = [[0], [], []];
  for (let p = 0; p < points; p++) {
    for (let i = 0; i < 3; i++) for (const v of p ? [0, p] : [0]) [axes.push(i), states.push(3 * v + i)];
    begins.push(states.length);
  }
  const rows = Array.from({ length: 3 * points }, (_, i) => i);
  const columns = rows.map((i) => 3 * ((i / 3) | 0) + ((i + 1) % 3));
  return { begins, axes, states, entries: states.map(() => 1), rows, columns, which: rows.map((i) => i % 3) };
}

test("the printed rates of P are those of the whole matrix, and so is the solution", async () => {
  const n = 12;
  const layout = body(4);
  const { at, pairs } = entriesOf(layout, n);
  assert.equal(at[3 * n + 6], -1);
  assert.ok(pairs.length < (n * (n + 1)) / 2);
  const { moveP, solveP } = await loadHere(moduleText(textsOfP(layout, n)));
  const P = (i, j) => (at[i * n + j] < 0 ? 0 : i === j ? 3 + 0.1 * i : 0.2 + 0.01 * (i + j));
  const now = new Float64Array(n + pairs.length);
  pairs.forEach(([i, j], k) => (now[n + k] = P(i, j)));
  const known = Float64Array.of(0, 0.3, -0.2, 0.5);
  const told = Float64Array.from({ length: 48 }, (_, k) => 0.1 + 0.01 * (k % 12));
  for (let p = 0; p < 4; p++)
    for (let i = 0; i < 3; i++) for (let j = 0; j < i; j++) told[12 * p + 3 + 3 * i + j] = told[12 * p + 3 + 3 * j + i];
  const out = new Float64Array(now.length);
  moveP(now, known, 1, told, 2, 0.4, new Float64Array(pairs.length).fill(0.7), out);
  const A = (i, j) =>
    layout.rows.reduce(
      (sum, row, e) => sum + (row === i && layout.columns[e] === j ? known[1 + layout.which[e]] : 0),
      0,
    );
  const C = (p, axis, i) =>
    layout.states.reduce(
      (sum, state, e) =>
        sum + (state === i && layout.axes[e] === axis && e >= layout.begins[p] && e < layout.begins[p + 1] ? 1 : 0),
      0,
    );
  pairs.forEach(([i, j], k) => {
    let right = 0.7 - 0.4 * P(i, j);
    for (let m = 0; m < n; m++) right -= A(m, i) * P(m, j) + P(i, m) * A(m, j);
    for (let p = 0; p < 4; p++) {
      for (let a = 0; a < 3; a++)
        for (let b = 0; b < 3; b++) right += 2 * C(p, a, i) * told[12 * p + 3 + 3 * a + b] * C(p, b, j);
    }
    assert.ok(Math.abs(out[n + k] - right) < 1e-13, `${i}, ${j}: ${out[n + k]} instead of ${right}`);
  });
  const x = Float64Array.from({ length: n }, (_, i) => Math.sin(i + 1));
  const rightSide = Array.from(x, (_, i) => x.reduce((sum, value, j) => sum + P(i, j) * value, 0));
  const found = Float64Array.from(rightSide);
  solveP(now, found);
  found.forEach((value, i) => assert.ok(Math.abs(value - x[i]) < 1e-13));
  now[n] = -1;
  solveP(now, found);
  assert.ok(Number.isNaN(found[0]));
});

test("a path of equal intervals is that of the exponential, whatever the rounding of their ends", () => {
  const rates = Float64Array.of(0, -2, 0, 0.5, 2, 0, 0, 0, 0, 0, -0.1, 0.2);
  const index = Array.from({ length: 401 }, (_, k) => k);
  const grid = Float64Array.from(index, (k) => (k ? 0.01 * (k - 1) : 0));
  const points = constantPath([1, 0, 3], rates, grid, index, new Float64Array(1200));
  index.slice(1).forEach((k) => {
    const t = grid[k];
    const right = [
      Math.cos(2 * t) + 0.25 * Math.sin(2 * t),
      Math.sin(2 * t) + 0.25 * (1 - Math.cos(2 * t)),
      2 + Math.exp(-0.1 * t),
    ];
    right.forEach((value, c) =>
      assert.ok(Math.abs(points[3 * k - 3 + c] - value) < 1e-13, `${t}: ${points[3 * k - 3 + c]}`),
    );
  });
});

test("an estimate without one of its coordinates has no error, and one behind the camera an infinite one", () => {
  const estimate = Float64Array.of(0, 1, NaN, 1, Infinity, 1, 0, -1);
  const error = distanceError([2, 2, 2, 2], [1, 1, 1, -1], estimate, 2);
  assert.deepEqual([...error], [1, NaN, NaN, Infinity]);
});
