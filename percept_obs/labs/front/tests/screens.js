// Screens of labs without a browser: what they say of settings at a time.

import { readFileSync } from "node:fs";
import { Standing } from "../src/labs/observer/standing.js";
import { Engine } from "../src/labs/observer/engine.js";
import { Kernels } from "../src/labs/observer/kernels.js";
import { QUESTIONS as ofObserver } from "../src/labs/observer/questions.js";
import { ObserverScreen } from "../src/labs/observer/screen.js";
import { between } from "../src/engine/between.js";
import { modelOf } from "../src/state/texts.js";
import { PointsEngine } from "../src/labs/points/engine.js";
import { PointsKernels } from "../src/labs/points/kernels.js";
import { QUESTIONS as ofPoints } from "../src/labs/points/questions.js";
import { PointsScreen } from "../src/labs/points/screen.js";
import { StructureEngine } from "../src/labs/structure/engine.js";
import { StructureKernels } from "../src/labs/structure/kernels.js";
import { QUESTIONS as ofStructure } from "../src/labs/structure/questions.js";
import { StructureScreen } from "../src/labs/structure/screen.js";
import { loadHere } from "./load_here.js";

const LABS = {
  observer: { Engine, Kernels, Of: ObserverScreen, questions: ofObserver },
  points: { Engine: PointsEngine, Kernels: PointsKernels, Of: PointsScreen, questions: ofPoints },
  structure: { Engine: StructureEngine, Kernels: StructureKernels, Of: StructureScreen, questions: ofStructure },
};
const FRONT = new URL("../", import.meta.url);
const OPENED = JSON.parse(readFileSync(new URL("tests/models.json", FRONT), "utf8"));

/** A lab's screen that draws nothing, with the settings that it opens with. */
export async function screenOf(name) {
  const { Engine: Makes, Kernels: Loads, Of, questions } = LABS[name];
  const { model: given, settings } = OPENED[name];
  const model = await modelOf(readFileSync(new URL(`${name}_lab.gz`, FRONT)), given);
  const kernels = new Loads(model, loadHere);
  const engine = new Makes(model);
  const screen = Object.create(Of.prototype);
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
    const scene = { shown, ghost, chosen: shown.runs?.[0] ?? null, now, end, at: between(shown.time, now), why: false, secret: false, theme: null };
    Object.assign(screen, { moved });
    screen.look(scene);
    return { ...scene, seen: screen.seen, said: screen.sentence(scene) };
  };
  return { model, settings, questions, run, tell };
}
