// The scene's geometry: looks are rotations, points lie where their rays say, what is outside is shown at the rim.
import assert from "node:assert/strict";
import { test } from "node:test";
import { advanced, begun, between, stepped, valueBetween } from "../src/engine/between.js";
import { scaled, unseenDirection } from "../src/engine/velocities.js";
import * as space from "../src/old/space.js";
import { LabelledPicture, meet } from "../src/draw/labels.js";
import { drawVelocities } from "../src/old/velocities.js";

const near = (one, other, slack = 1e-12) =>
  one.forEach((value, i) => assert.ok(Math.abs(value - other[i]) < slack, `${one} is not ${other}`));
const dot = (one, other) => one.reduce((sum, value, i) => sum + value * other[i], 0);

test("neither turned nor tilted, the scene is the image: y1 to the right, y2 upwards, depth away", () => {
  near(space.lookFrom({ turn: 0, tilt: 0 }).flat(), [1, 0, 0, 0, 1, 0, 0, 0, 1]);
  const [right, up] = space.lookFrom({ turn: Math.PI / 2, tilt: 0 });
  near([...right, ...up], [0, 0, 1, 0, 1, 0]);
  near(space.lookFrom({ turn: 0, tilt: Math.PI / 2 })[1], [0, 0, 1]);
});

test("every look is a rotation, and none turns the scene on its head", () => {
  for (const [turn, tilt] of [[0.3, -0.7], [2, 1.1], [-4, 0.2]]) {
    const rows = space.lookFrom({ turn, tilt });
    rows.forEach((one, i) => rows.forEach((other, j) => near([dot(one, other)], [i === j ? 1 : 0])));
  }
  assert.equal(space.turned({ turn: 0, tilt: 1 }, 0, 9).tilt, Math.PI / 2);
  near(Object.values(space.turned({ turn: 1, tilt: 0 }, 0.5, -0.25)), [1.5, -0.25]);
});

const track = { rows: Float64Array.of(9, 1, 2, 9, 3, 4, 9, 5, 6), width: 3, first: 1, distances: [2, 3, NaN] };

test("a point lies on its ray at its distance, between samples on a line, and nowhere without a distance", () => {
  near([...space.positionsOf(track, space.straight, [0, 1])], [2, 4, 2, 9, 12, 3]);
  near(space.positionAt(track, space.straight, { sample: 0, part: 0.5 }), [5.5, 8, 2.5]);
  near(space.positionAt(track, space.straight, { sample: 1, part: 0 }), [9, 12, 3]);
  assert.ok(space.positionAt(track, space.straight, { sample: 1, part: 0.1 }).every(Number.isNaN));
});

test("a long path is thinned, and ends where the point is", () => {
  const count = 1001;
  const long = {
    rows: Float64Array.from({ length: 2 * count }, (_, k) => k),
    width: 2,
    distances: new Float64Array(count).fill(1),
  };
  const found = space.positionsOf(long, space.straight, [0, count - 1], 100);
  assert.ok(found.length <= 303);
  near([...found.subarray(-3)], [2 * count - 2, 2 * count - 1, 1]);
});

test("the ball holds camera and path, whatever is infinite, and stays while the next one fits in it", () => {
  const box = space.boxAround([Float64Array.of(3, 0, 4, NaN, NaN, NaN, -1, 0, Infinity)]);
  assert.deepEqual(box, { low: [-1, 0, 0], high: [3, 0, 4] });
  const ball = space.ballAround(box);
  near([...ball.centre, ball.radius], [1, 0, 2, Math.hypot(4, 4) / 2]);
  assert.equal(space.keptBall(ball, { ...ball, radius: ball.radius / 2 }), ball);
  for (const radius of [ball.radius / 3, 2 * ball.radius])
    assert.equal(space.keptBall(ball, { ...ball, radius }).radius, radius);
});

test("a frame puts the ball's centre in the middle and its rim at the edge", () => {
  const frame = space.frameOf(
    { turn: 0, tilt: 0 },
    { centre: [1, 2, 3], radius: 4 },
    { width: 200, height: 100, edge: 10 },
  );
  near([frame.x(1, 2, 3), frame.y(1, 2, 3), frame.y(1, 6, 3), frame.x(5, 2, 9)], [100, 50, 10, 140]);
});

test("what lies outside is shown where its line leaves the picture", () => {
  const box = [[0, 0], [100, 50]];
  assert.equal(space.rimOf([10, 10], [90, 40], box), null);
  const rim = space.rimOf([10, 10], [310, 110], box);
  near([...rim.at, rim.angle], [100, 40, Math.atan2(100, 300)]);
});

test("two standard deviations of an inverse distance are an interval of distances, which may have no end", () => {
  near(space.claimedDistances(0.5, 0.125), [4 / 3, 4]);
  assert.deepEqual(space.claimedDistances(0.5, 0.25), [1, Infinity]);
  assert.equal(space.claimedDistances(-1, 0.1), null);
});

test("a copy scaled is on its ray, and one moved along what w does not tell changes no measured rate", () => {
  const [copy] = scaled([{ place: [1, -2, 4], colour: "red" }], 1);
  near(copy.place, [1.3, -2.6, 5.2]);
  assert.equal(copy.colour, "red");
  for (const w of [[0.3, -2], [0, 1], [5, 0], [0, 0]]) {
    const direction = unseenDirection(w, 0.4);
    near([dot(w, direction)], [0]);
    assert.ok(
      Math.abs(direction[1]) <= 0.2 + 1e-12 && Math.abs(direction[0]) <= 0.5 + 1e-12 && Math.hypot(...direction) > 0.01,
    );
  }
});

test("play goes on at its speed, stops at the end, and begins there anew", () => {
  const span = { low: 1, high: 3 };
  assert.deepEqual(advanced(1, span, 2, 0.25), { time: 1.5, playing: true });
  assert.deepEqual(advanced(2.9, span, 2, 0.25), { time: 3, playing: false });
  assert.deepEqual([begun(3, span), begun(2, span), begun(null, span), begun(0, span)], [1, 2, 1, 1]);
  assert.deepEqual([stepped(1, span, 10), stepped(1, span, -1), stepped(2.99, span, 9)], [1.5, 1, 3]);
});

test("a time between samples has its part of the way, and none at a sample", () => {
  const time = [0, 1, 3];
  assert.deepEqual(between(time, 2), { sample: 1, part: 0.5 });
  assert.deepEqual(between(time, 3), { sample: 2, part: 0 });
  assert.deepEqual(between(time, 1 + 1e-12), { sample: 1, part: 0 });
  assert.equal(valueBetween([0, 5, 0, 7, 0, 1], 2, 1, { sample: 1, part: 0.5 }), 4);
});

/** A picture that only remembers where it writes, with letters six pixels wide. */
function scribe() {
  const measureText = (text) => ({ width: 6 * text.length });
  /** @type {any} */
  const pen = new Proxy({ measureText }, { get: (known, name) => known[name] ?? (() => undefined) });
  const empty = { texts: [], taken: [], busy: [], labels: [], places: new Map(), caption: () => undefined };
  const given = { ...empty, context: pen, pen, width: 330, height: 300, theme: {} };
  return Object.assign(Object.create(LabelledPicture.prototype), given);
}

test("names of arrows are all there, and none covers another, wherever the arrows lead", () => {
  const box = { left: 40, top: 10, side: 250 };
  for (let k = 0; k < 500; k++) {
    const turn = (k * Math.PI) / 25;
    const between = (k % 20) / 10;
    const place = [0.2 + (0.6 * ((k * 7) % 19)) / 19, 0.2 + (0.6 * ((k * 11) % 23)) / 23];
    const velocities = [-1, 0, 1].map((way) => [Math.cos(turn + way * between), Math.sin(turn + way * between)]);
    const picture = scribe();
    const frame = { picture, box, scale: 250, x: (y1) => box.left + 250 * y1, y: (y2) => box.top + 250 * (1 - y2) };
    drawVelocities(frame, [{ place, velocities, colour: "black" }], 1, {});
    picture.end();
    const names = picture.texts.flatMap(({ text }) => text.split(", "));
    assert.deepEqual(names.sort(), ["½×", "1×", "2×"].sort());
    for (const [i, one] of picture.texts.entries()) {
      for (const other of picture.texts.slice(i + 1)) {
        assert.ok(!meet(one.box, other.box), `${JSON.stringify(one)} covers ${JSON.stringify(other)}`);
      }
    }
  }
});
