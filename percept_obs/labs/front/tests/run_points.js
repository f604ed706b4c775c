// Runs settings of the lab of many points, given on standard input, with the page's own engine.
import { readFileSync } from "node:fs";
import { pythonOf } from "../src/labs/points/code.js";
import { PointsEngine } from "../src/labs/points/engine.js";
import { PointsKernels } from "../src/labs/points/kernels.js";
import { summaryOf } from "../src/labs/points/text.js";
import { loadHere } from "./load_here.js";

const { model, tasks } = JSON.parse(readFileSync(0, "utf8"));
const functions = new PointsKernels(model, loadHere);
const engine = new PointsEngine(model);
const numbers = (values) => Array.from(values, (v) => (Number.isFinite(v) ? v : null));
const answers = [];
for (const settings of tasks) {
  await functions.prepare(settings);
  const began = performance.now();
  const shown = engine.run(settings, functions.of(settings));
  const { gramian } = shown;
  const took = performance.now() - began;
  answers.push({
    took,
    code: pythonOf(shown, model),
    summary: summaryOf(shown, 1, model),
    time: numbers(shown.time),
    truth: numbers(shown.truth),
    outputs: numbers(shown.outputs),
    estimate: numbers(shown.estimate),
    divergedAt: shown.divergedAt,
    rate: shown.fit?.rate ?? null,
    gramian: { time: numbers(gramian.time), smallest: numbers(gramian.smallest), largest: numbers(gramian.largest) },
  });
}
process.stdout.write(JSON.stringify(answers));
