// First screens without a browser: what they say of settings at a time.

import { readFileSync } from "node:fs";
import { Standing } from "../src/observer/model/standing.js";
import { Engine } from "../src/observer/model/engine.js";
import { Kernels } from "../src/observer/model/kernels.js";
import { QUESTIONS as ofObserver } from "../src/observer/model/questions.js";
import { ObserverFirst } from "../src/observer/page/first.js";
import { between } from "../src/common/model/playback.js";
import { modelOf } from "../src/common/model/texts.js";
import { PointsEngine } from "../src/points/model/engine.js";
import { PointsKernels } from "../src/points/model/kernels.js";
import { QUESTIONS as ofPoints } from "../src/points/model/questions.js";
import { PointsFirst } from "../src/points/page/first.js";
import { StructureEngine } from "../src/structure/model/engine.js";
import { StructureKernels } from "../src/structure/model/kernels.js";
import { QUESTIONS as ofStructure } from "../src/structure/model/questions.js";
import { StructureFirst } from "../src/structure/page/first.js";
import { loadHere } from "./load_here.js";

const LABS = {
  observer: { Engine, Kernels, First: ObserverFirst, questions: ofObserver },
  points: { Engine: PointsEngine, Kernels: PointsKernels, First: PointsFirst, questions: ofPoints },
  structure: { Engine: StructureEngine, Kernels: StructureKernels, First: StructureFirst, questions: ofStructure },
};
const FRONT = new URL("../", import.meta.url);
const OPENED = JSON.parse(readFileSync(new URL("tests/models.json", FRONT), "utf8"));

/** A lab's first screen that draws nothing, with the settings that it opens with. */
export async function screenOf(name) {
  const { Engine: Makes, Kernels: Loads, First, questions } = LABS[name];
  const { model: given, settings } = OPENED[name];
  const model = await modelOf(readFileSync(new URL(`${name}_lab.gz`, FRONT)), given);
  const kernels = new Loads(model, loadHere);
  const engine = new Makes(model);
  const screen = Object.create(First.prototype);
  const lab = { model, kernels, settings, results: { engines: [engine] } };
  const still = { questions: { open: undefined, asking: false }, clock: { playing: false }, left: true, amounts: null };
  const drawn = { film: { films: {} }, standing: new Standing(), whyButton: {}, size: 2, share: 0.5 };
  Object.assign(screen, { lab, engine, worlds: null, moved: false, ...still, ...drawn });
  const run = async (each) => {
    await kernels.prepare(each);
    return engine.run(each, kernels.of(each));
  };
  /** What is shown of a result at a part of its time, and what is said. */
  const tell = (shown, part, { ghost = null, moved = false } = {}) => {
    const [start, end] = [shown.time[0], shown.time.at(-1)];
    const now = part < 1 ? start + part * (end - start) : end;
    const scene = { shown, ghost, now, end, at: between(shown.time, now), why: false, secret: false, theme: null };
    Object.assign(screen, { moved });
    screen.look(scene);
    return { ...scene, seen: screen.seen, said: screen.sentence(scene) };
  };
  return { model, settings, questions, run, tell };
}
