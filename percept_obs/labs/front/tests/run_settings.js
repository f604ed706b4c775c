// Runs lab settings given on standard input with the page's own engine and prints what it would draw.
import { readFileSync } from "node:fs";
import { pythonOf } from "../src/labs/observer/code.js";
import { Engine } from "../src/labs/observer/engine.js";
import { loadHere } from "./load_here.js";
import { Kernels } from "../src/labs/observer/kernels.js";
import { summaryOf } from "../src/ui/words.js";

const { model, tasks } = JSON.parse(readFileSync(0, "utf8"));
const kernels = new Kernels(model, loadHere);
const engine = new Engine(model);
const numbers = (values) => values && Array.from(values, (v) => (Number.isFinite(v) ? v : null));
const answers = [];
for (const settings of tasks) {
  await kernels.prepare(settings);
  const shown = engine.run(settings, kernels.of(settings));
  const answer = { problem: shown.problem ?? null, summary: summaryOf(shown, 1, model) };
  if (!shown.problem) {
    answer.code = pythonOf(shown, model);
    answer.time = numbers(shown.time);
    answer.outputs = numbers(shown.outputs);
    answer.truth = numbers(shown.truth);
    answer.bound = numbers(shown.bound);
    answer.excitation = numbers(shown.excitation.smallest);
    answer.runs = Object.fromEntries(
      shown.runs.map((run) => [
        run.name,
        {
          estimate: numbers(run.estimate),
          deviation: numbers(run.deviation),
          resets: numbers(run.resets),
          divergedAt: run.divergedAt,
        },
      ]),
    );
  }
  answers.push(answer);
}
process.stdout.write(JSON.stringify(answers));
