// What a first screen says of a run is so, for every question and for settings drawn at random.

import assert from "node:assert/strict";
import test from "node:test";
import { uniformFrom } from "../src/engine/random.js";
import { settingsOf } from "../src/state/settings.js";
import { unknownOf } from "../src/labs/structure/worlds.js";
import { judge, OBSERVER, POINTS, STRUCTURE } from "./claims.js";
import { screenOf } from "./screens.js";

const MANY = process.env.ALL_SAMPLES ? 200 : 60;
const PARTS = [0, 0.1, 0.25, 0.5, 0.75, 0.95, 1];

/** Settings that a hand may come to on a lab's first screen, and a little farther. */
const DRAWN = {
  observer({ settings }, random) {
    const between = (low, high) => low + random() * (high - low);
    const [y1, y2, Z] = [between(-0.6, 0.6), between(-0.5, 0.5), between(3, 14)];
    const speed = between(0.3, 2.5);
    const foe = random() < 0.2 ? [y1, y2] : [between(-0.6, 0.6), between(-0.4, 0.4)];
    const b = [...foe, 1].map((value) => (-speed * value) / Math.hypot(...foe, 1));
    const believed = random() < 0.15 ? { A: settings.A, b: b.map((value) => between(0.5, 2) * value) } : null;
    return {
      ...{ b, X0: [y1 * Z, y2 * Z, Z], believed, seed: Math.floor(1000 * random()) },
      outputs: [["y1", "y2"], ["y1", "y2"], ["y1"], ["y2"]][Math.floor(4 * random())],
      gains: { identifier_based: { gain: 10 ** between(0, 1.9) } },
      noise: { kind: "uniform", size: random() < 0.4 ? 0 : between(0, 0.008) },
      start: { mode: "chosen", values: [y1, y2, 1 / between(2, 16)] },
    };
  },
  points({ settings }, random) {
    const between = (low, high) => low + random() * (high - low);
    const away = () => (random() < 0.25 ? [between(0, 4), between(4, 12)] : null);
    return {
      state: ["body", "body", "origin", "independent"][Math.floor(4 * random())],
      points: settings.points.map((place) => place.map((value) => value + between(-0.7, 0.7))),
      hidden: settings.points.map(away),
      camera_velocity: [random() < 0.15 ? 0 : between(0, 8), 0, 0],
      spin: random() < 0.2 ? 1 : 0,
      size: 10 ** between(-1, 1.3),
      error: between(0.5, 4),
      noise: { kind: "uniform", size: random() < 0.6 ? 0 : between(0, 0.02) },
      duration: Math.round(between(3, 14)),
    };
  },
  structure({ model }, random) {
    const between = (low, high) => low + random() * (high - low);
    const ticks = Object.fromEntries(["rests", "size", "ahead", "sideways"].map((name) => [name, random() < 0.55]));
    const swing = random() < 0.3 ? [between(-2, 2), 0, between(-3, 3)] : [0, 0, 0];
    return {
      unknown: unknownOf(ticks, model.quantities),
      v_c: [between(-1, 4), 0, random() < 0.15 ? 0 : between(-0.5, 2.3)],
      ...{ v_c_swing: swing, rate: between(0.2, 1.5), seed: Math.floor(1000 * random()) },
      gains: { ideal: { feedback: between(0.5, 3) } },
      noise: { kind: "uniform", size: between(0, 6e-5), depth: between(0, 6e-5) },
      duration: Math.round(between(2, 5)),
      ...{ period: 0.004, step: 0.002 },
    };
  },
};
const CLAIMS = { observer: OBSERVER, points: POINTS, structure: STRUCTURE };
const isShown = (shown) => !shown.problem && shown.time.length > 1;

for (const [name, claims] of Object.entries(CLAIMS)) {
  /** Judge what is said of a result all along; returns how many sentences were judged, and those that are false. */
  const judgeAll = (tell, shown, more) => {
    const wrong = [];
    for (const part of PARTS) {
      for (const moved of [false, true]) {
        const told = tell(shown, part, { ...more, moved });
        const all = { ...told, worlds: told.worlds ?? null };
        if (!judge(claims, all)) wrong.push(`${told.now.toFixed(2)} s: ${told.said}`);
      }
    }
    return wrong;
  };

  test(`what is said before and after each question is so: ${name}`, async () => {
    const { model, questions, run, tell } = await screenOf(name);
    for (const question of questions) {
      const after = question.after(model);
      const [before, shown, ghost] = await Promise.all([
        run(question.before(model)), run(after), after.kept ? run(after.kept) : null,
      ]);
      for (const result of [before, shown]) assert.deepEqual(judgeAll(tell, result), [], question.name);
      assert.ok(question.holds(tell(shown, 1, { ghost })), `${question.name}: what the answer tells is not so`);
    }
  });

  test(`what is said of ${MANY} random settings is so: ${name}`, async () => {
    const screen = await screenOf(name);
    const random = uniformFrom(5489);
    const said = new Set();
    for (let k = 0; k < MANY; k++) {
      const changes = DRAWN[name](screen, random);
      const shown = await screen.run(settingsOf({ changes }, screen.settings));
      if (!isShown(shown)) continue;
      assert.deepEqual(judgeAll(screen.tell, shown), [], `setting ${k}: ${JSON.stringify(changes)}`);
      said.add(screen.tell(shown, 1).said.slice(0, 9));
    }
    assert.ok(said.size >= 3, `settings that make only ${[...said]} judge little`);
  });
}
