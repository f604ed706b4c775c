// A chart draws every peak, keeps lines that have not changed, marks events once a pixel, and knows which line is meant.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { TimeChart } from "../src/draw/chart.js";

/** A path that notes where it goes. */
class Path {
  points = [];

  moveTo(x, y) {
    this.points.push(["from", x, y]);
  }

  lineTo(x, y) {
    this.points.push(["to", x, y]);
  }
}

beforeEach(() => Object.assign(globalThis, { Path2D: Path }));

/** A chart of 144 pixels for 100 s, and as high as its values, without a page. */
function chart(more = {}) {
  const made = Object.create(TimeChart.prototype);
  const size = { width: 156, height: 134, floor: 0, log: false, at: [0, 100], span: { low: 0, high: 100 } };
  return Object.assign(made, size, { paths: new WeakMap(), tags: [], tag: (label) => made.tags.push(label) }, more);
}

test("a line of thousands of samples has few points, and its one peak among them", () => {
  const time = Float64Array.from({ length: 9001 }, (_, k) => k / 90);
  const values = new Float64Array(9001).fill(10);
  values[4444] = 90;
  const { points } = chart().pathOf(time, values);
  assert.ok(points.length < 450);
  assert.equal(Math.min(...points.map(([, , y]) => y)), chart().y(90));
});

test("a line has a gap where its values are no numbers, and is drawn in the part in sight only", () => {
  const time = Float64Array.from({ length: 101 }, (_, k) => k);
  const values = time.map((t) => (t > 40 && t < 60 ? NaN : t));
  const { points } = chart().pathOf(time, values);
  assert.equal(points.filter(([how]) => how === "from").length, 2);
  const part = chart({ span: { low: 20, high: 30 } }).pathOf(time, values).points;
  assert.ok(part.length <= 14);
});

test("a path is kept while only the time moves, and made anew with another scale or part", () => {
  const [time, values] = [Float64Array.of(0, 50, 100), Float64Array.of(1, 2, 3)];
  const made = chart();
  const path = made.pathOf(time, values);
  assert.equal(made.pathOf(time, values), path);
  made.at = [0, 50];
  assert.notEqual(made.pathOf(time, values), path);
});

test("resets have one tick in each column of pixels, however many there are", () => {
  const ticks = [];
  const made = chart({ context: { fillRect: (x) => ticks.push(x) } });
  const times = Float64Array.from({ length: 3000 }, (_, k) => 0.1 * k - 50);
  made.drawResets({ times, colour: "black", text: "3000 resets" }, 0, 140);
  assert.deepEqual(ticks, [...new Set(ticks)]);
  assert.equal(ticks.length, 101);
  assert.equal(made.tags[0].text, "3000 resets");
});

test("a press near another observer's line means it, and elsewhere the time", () => {
  const time = Float64Array.of(0, 100);
  const line = (id, value, run) => ({ id, run, time, values: Float64Array.of(value, value) });
  const made = chart({ chart: { lines: [line("sliding_mode", 50, "sliding_mode"), line("estimate", 80)] } });
  assert.equal(made.runAt([90, made.y(50) + 5]), "sliding_mode");
  assert.equal(made.runAt([90, made.y(50) + 20]), null);
  assert.equal(made.runAt([90, made.y(80)]), null);
});

test("decades are equally high, and what is not positive lies at the bottom", () => {
  const made = chart({ log: true, at: [-1, 2] });
  const heights = [0.1, 1, 10, 100].map((value) => made.y(value));
  const steps = heights.slice(1).map((y, k) => heights[k] - y);
  steps.forEach((step) => assert.ok(Math.abs(step - steps[0]) < 1e-9));
  assert.ok(made.y(0) >= heights[0] && made.y(-5) >= heights[0]);
});
