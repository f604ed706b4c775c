// Maps over two settings: axes and their places, the order of cells, what is left when the hand moves on, lines and
// words.
import assert from "node:assert/strict";
import { test } from "node:test";
import { cellAt, shareOf, ticksOn, valueIn, valueOn } from "../src/old/axes.js";
import { DIVERGED, EACH_CELL, FOLLOWED, IMPOSSIBLE, orderOf, THEN } from "../src/old/cells.js";
import { Filling } from "../src/old/filling.js";
import { cellInWords, mapInWords, stateInWords } from "../src/old/map_words.js";
import { cellAtShares, Sweep } from "../src/old/sweep.js";
import { edgesOf, toleranceLine } from "../src/old/settings_map_drawing.js";

const axis = (place, more = {}) => ({
  ...{ place, label: place, low: 0, high: 10, log: false, records: false, ...more },
  get: (settings) => settings[place],
  put: (settings, value) => ({ ...settings, [place]: value }),
});
const AXES = [axis("gain", { low: 1, high: 100, log: true }), axis("noise", { records: true })];
const MODEL = { observers: { one: { title: "One", gains: [], ways: { "": [] } } } };
const SETTINGS = {
  observers: ["one"],
  over: { observer: "one", across: "gain", up: "noise" },
  gain: 10,
  noise: 0,
  gains: { one: {} },
  duration: 10,
  other: 1,
};
const axesOf = () => AXES;

/** A lab whose run settles after its gain, ends off by its noise, and diverges where its gain is above 90. */
function small() {
  const engine = {
    model: MODEL,
    runs: 0,
    run({ gain, noise, other }) {
      this.runs += 1;
      return {
        truth: [1],
        runs: [{ divergedAt: gain > 90 ? 1 : null, settling: noise < 5 ? gain * other : Infinity, error: [noise] }],
      };
    },
  };
  return { model: MODEL, engine, axesOf, kernels: { prepare: async () => {}, of: () => ({}), allows: () => true } };
}

function filled(onPart = undefined) {
  const lab = small();
  const sweep = new Sweep(MODEL, axesOf, () => {});
  const filling = new Filling(lab, (part) => {
    sweep.take(part);
    onPart?.(sweep, part);
  }, { slice: 0, pause: async () => {} });
  let done = Promise.resolve();
  sweep.fill({ ask: (task) => (done = filling.take(task)) });
  return { ...lab, sweep, filling, whole: () => done };
}

test("a share of an axis and its value lead to each other, in decades where it is logarithmic", () => {
  assert.equal(valueOn(AXES[0], 0.5), 10);
  for (const each of AXES)
    for (const share of [0, 0.25, 0.9]) assert.ok(Math.abs(shareOf(each, valueOn(each, share)) - share) < 1e-4);
  assert.equal(shareOf(AXES[0], -1), -Infinity);
  assert.deepEqual([0, 0.49, 0.5, 1, -1, 2].map((share) => cellAt(share, 2)), [0, 0, 1, 1, 0, 1]);
  assert.deepEqual(ticksOn(AXES[0], () => []), [1, 3, 10, 30, 100]);
  assert.deepEqual(ticksOn({ low: 1, high: 30, log: true }, () => []), [1, 2, 5, 10, 20].filter((tick) => tick <= 30));
});

test("cells that share a recording follow each other, and each comes once", () => {
  const plan = { across: AXES[0], up: AXES[1] };
  for (const [order, slow] of [[orderOf(plan, 3), 1], [orderOf({ across: AXES[1], up: AXES[0] }, 3), 0]]) {
    const all = Array.from({ length: 9 }, (_, k) => order(k));
    assert.equal(new Set(all.map(String)).size, 9);
    assert.deepEqual(all.map((cell) => cell[slow]), [0, 0, 0, 1, 1, 1, 2, 2, 2]);
  }
});

test("a map is filled to the finest level, and a setting on its axes or of drawing fills nothing again", async () => {
  const { sweep, engine, whole } = filled();
  sweep.want(SETTINGS, {}, 5);
  await whole();
  assert.ok(sweep.whole && sweep.present);
  const { runs } = engine;
  sweep.want({ ...SETTINGS, gain: 2, noise: 3, pictures: ["error"] }, {}, 5);
  await whole();
  assert.equal(engine.runs, runs);
  const cell = cellAtShares(sweep.found, [0.5, 0.25]);
  const finest = THEN.at(-1);
  assert.deepEqual([cell.cells, cell.kind], [finest, FOLLOWED]);
  assert.deepEqual([cell.settling, cell.error], [valueIn(AXES[0], cell.i, finest), valueIn(AXES[1], cell.j, finest)]);
  sweep.want({ ...SETTINGS, other: 2 }, {}, 5);
  assert.ok(!sweep.present);
  assert.match(stateInWords(sweep), /of settings a moment ago$/);
  await whole();
  assert.ok(sweep.whole);
  assert.equal(cellAtShares(sweep.found, [0.5, 0.25]).settling, 2 * cell.settling);
});

test("a hand that moves on gets the first picture of each map, and no finer one of an old map", async () => {
  const seen = [];
  let moves = 0;
  const { sweep, whole } = filled((the, { id, cells }) => {
    seen.push([id, cells]);
    if (moves++ < 3) the.want({ ...SETTINGS, other: 1 + moves }, {}, 5);
  });
  sweep.want(SETTINGS, {}, 5);
  await whole();
  assert.deepEqual(seen.slice(0, 3).map(([id]) => id), [1, 2, 3]);
  assert.ok(seen.filter(([id]) => id < 4).every(([, cells]) => cells <= 16));
  assert.ok(sweep.whole);
  assert.equal(sweep.sent.size, 1);
});

test("another filler goes on with the map that is there", async () => {
  const { sweep, whole, filling } = filled((the, { cells }) => cells > 16 && filling.stop());
  sweep.want(SETTINGS, {}, 5);
  await whole();
  const before = cellAtShares(sweep.found, [0.5, 0.25]).cells;
  const asked = [];
  sweep.fill({ ask: (task) => asked.push(task) });
  sweep.want(SETTINGS, {}, 5);
  assert.ok(sweep.present);
  const values = new Float64Array(EACH_CELL * 16).fill(FOLLOWED);
  sweep.take({ id: asked[0].id, cells: 4, from: 0, values, cost: 1 });
  assert.equal(cellAtShares(sweep.found, [0.5, 0.25]).cells, before);
});

test("who stops is left in peace, and other axes take the old map away at once", async () => {
  const { sweep, filling, engine, whole } = filled(() => filling.stop());
  sweep.want(SETTINGS, {}, 5);
  await whole();
  assert.ok(engine.runs < 300);
  const plan = sweep.found;
  assert.ok(plan);
  sweep.want({ ...SETTINGS, over: { ...SETTINGS.over, across: "noise", up: "gain" } }, {}, 5);
  assert.equal(sweep.found, null);
  assert.equal(stateInWords(sweep), "being computed");
});

test("the line of the tolerance lies where the error crosses it, and words count what settles", async () => {
  const { sweep, whole } = filled();
  sweep.want(SETTINGS, {}, 5);
  await whole();
  const heights = toleranceLine(sweep.found).flat().filter(([x]) => x < 0.9).map(([, y]) => y);
  assert.ok(heights.length > 50);
  assert.ok(heights.every((y) => Math.abs(y - 0.5) < 0.01));
  const told = mapInWords(sweep, "settling", "Settling time, one");
  const { values } = sweep.found.levels.at(-1);
  const kinds = values.filter((_, k) => k % EACH_CELL === 0);
  const diverged = kinds.filter((kind) => kind === DIVERGED).length;
  assert.match(told, new RegExp(`, ${diverged} diverge\\.`));
  assert.match(told, /least 1\.02 s at gain 1\.018/);
  assert.equal(cellInWords({ kind: IMPOSSIBLE, settling: 0, error: 0 }), "no run");
  assert.equal(cellInWords({ kind: FOLLOWED, settling: 2.5, error: 0.01 }), "settles after 2.5 s, 1 % off at the end");
  assert.equal(
    cellInWords({ kind: FOLLOWED, settling: Infinity, error: Infinity }),
    "does not settle, behind the camera at the end",
  );
});

test("shades begin at round numbers below the duration, and at half decades of the error", () => {
  assert.deepEqual(edgesOf("settling", 80), [0.5, 1, 2, 5, 10, 20, 50]);
  assert.deepEqual(edgesOf("settling", 3), [0.02, 0.05, 0.1, 0.2, 0.5, 1, 2]);
  assert.deepEqual(
    edgesOf("error", 3).map((edge) => edge.toPrecision(2)),
    ["0.00032", "0.0010", "0.0032", "0.010", "0.032", "0.10", "0.32"],
  );
});
