// Runs places of maps over two settings, given on standard input as shares of the way along both axes, and prints what
// became of them.
import { readFileSync } from "node:fs";
import { planOf, valueOn } from "../src/old/axes.js";
import { bare, baseOf, fillCell, settingsAt } from "../src/old/cells.js";
import { axesOf as axesOfPoint } from "../src/labs/observer/axes.js";
import { CellEngine } from "../src/labs/observer/cell_engine.js";
import { Kernels } from "../src/labs/observer/kernels.js";
import { axesOf as axesOfStructure } from "../src/labs/structure/axes.js";
import { StructureEngine } from "../src/labs/structure/engine.js";
import { StructureKernels } from "../src/labs/structure/kernels.js";
import { loadHere } from "./load_here.js";

const { model, tasks, kind } = JSON.parse(readFileSync(0, "utf8"));
const ofStructure = kind === "structure_lab";
const kernels = ofStructure ? new StructureKernels(model, loadHere) : new Kernels(model, loadHere);
const axesOf = ofStructure ? axesOfStructure : axesOfPoint;
const answers = [];
for (const { settings, shares } of tasks) {
  const rough = bare(settings, settings.over.observer);
  await kernels.prepare(rough);
  const functions = kernels.of(rough);
  const plan = planOf(settings, model, axesOf, functions);
  const base = baseOf(settings, plan, functions);
  const lab = { engine: ofStructure ? new StructureEngine(model) : new CellEngine(model), kernels };
  const out = new Float64Array(3);
  const cells = shares.map(([x, y]) => {
    const place = [valueOn(plan.across, x), valueOn(plan.up, y)];
    const there = settingsAt(base, plan, place, functions);
    fillCell(out, 0, there, lab, functions);
    return {
      place,
      kind: out[0],
      settling: String(out[1]),
      error: String(out[2]),
      settings: there && { ...settings, ...there, over: settings.over },
    };
  });
  answers.push({ across: plan.across.place, up: plan.up.place, cells });
}
process.stdout.write(JSON.stringify(answers));
