// Runs settings of the structure lab given on standard input with the page's own engine and prints what it would draw.
import { readFileSync } from "node:fs";
import { summaryOf } from "../src/ui/words.js";
import { pythonOf } from "../src/labs/structure/code.js";
import { StructureEngine } from "../src/labs/structure/engine.js";
import { StructureKernels } from "../src/labs/structure/kernels.js";
import { quantityOf, rangeOf } from "../src/labs/structure/quantities.js";
import { loadHere } from "./load_here.js";

const { model, tasks } = JSON.parse(readFileSync(0, "utf8"));
const kernels = new StructureKernels(model, loadHere);
const engine = new StructureEngine(model);
const numbers = (values) => values && Array.from(values, (v) => (Number.isFinite(v) ? v : null));
const answers = [];
for (const settings of tasks) {
  await kernels.prepare(settings);
  const shown = engine.run(settings, kernels.of(settings));
  const answer = { problem: shown.problem ?? null, refusal: shown.refusal, corollary: kernels.corollary(settings) };
  answer.code = pythonOf(shown, model);
  if (!shown.problem && !shown.refusal) {
    answer.summary = summaryOf(shown, 1, model);
    for (const part of ["time", "outputs", "truth"]) answer[part] = numbers(shown[part]);
    answer.determinant = numbers(shown.guard.determinants);
    answer.limits = shown.limits;
    answer.quantities = Object.fromEntries(
      shown.choice.unknown.map((name) => [name, numbers(quantityOf(shown, shown.truth, name))]),
    );
    answer.runs = Object.fromEntries(
      shown.runs.map((run) => [
        run.name,
        {
          estimate: numbers(run.estimate),
          range: numbers(rangeOf(shown, run.estimate)),
          quantities: Object.fromEntries(
            shown.choice.unknown.map((name) => [name, numbers(quantityOf(shown, run.estimate, name))]),
          ),
          gaps: run.gaps,
          divergedAt: run.divergedAt,
        },
      ]),
    );
  }
  answers.push(answer);
}
process.stdout.write(JSON.stringify(answers));
