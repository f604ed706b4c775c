// The lab of structure and motion: what is known, what can therefore be estimated, and how the estimates converge.

import { withoutRefused } from "../../engine/kernels.js";
import { same } from "../../state/settings.js";
import { lettered, ObserverFormulas } from "../../ui/formulas.js";
import { Lab } from "../../ui/lab.js";
import { summaryOf } from "../../ui/words.js";
import { isSampled } from "./camera.js";
import { chartOf, CHARTS } from "./charts.js";
import { ChoiceOfUnknowns } from "./choice.js";
import { pythonOf } from "./code.js";
import { StructureEngine } from "./engine.js";
import { keyOf, StructureKernels } from "./kernels.js";
import { NAMES, StructurePanel, WORDS } from "./panel.js";
import { StructureScreen } from "./screen.js";
import { SYMBOLS } from "./symbols.js";
import { reasons } from "./text.js";

const SYSTEM = "What multiplies the unknowns, and what is known";

export class StructureLab extends Lab {
  static computing = { Kernels: StructureKernels, Engine: StructureEngine };

  constructor(widget, place, model) {
    const parts = { names: NAMES, symbols: SYMBOLS, charts: CHARTS, chartOf, reasons, summaryOf, pythonOf };
    super(widget, model, { words: WORDS, ...parts });
    this.formulas = new ObserverFormulas(this.model, {
      systemOf: (settings) => [SYSTEM, model.unknowns[keyOf(settings)]?.formulas ?? []],
      numbersOf: (settings) => this.numbersOf(settings),
    });
    this.panel = new StructurePanel(this, new ChoiceOfUnknowns(this.model, this));
    this.screen = new StructureScreen(this);
    this.open(place, this.panel.groups);
  }

  /** The numbers of the equations' letters; of samples those at the start. */
  numbersOf(settings) {
    const { scale, v_c, v_p, w_c, ybar: [y1, y2, ybar3] } = settings;
    return { d_s: scale, y1, y2, ybar3, ...lettered(isSampled(settings) ? this.startOf(settings) : { v_c, v_p, w_c }) };
  }

  /** The velocities at the start of the run. */
  startOf(settings) {
    const { rows } = this.results.engines[0].camera.velocities(settings, this.kernels.of(settings) ?? {}, [0]);
    const [w_c, v_c, v_p] = [0, 3, 6].map((first) => Array.from(rows.subarray(first, first + 3)));
    return { w_c, v_c, v_p };
  }

  fitted(asked) {
    return withoutRefused(asked, this.kernels.refused(asked), this.model.observers, "ideal");
  }

  clash({ velocities, motion, unknown, duration, period, step }) {
    const { mostSteps, samples, schema } = this.model;
    const sampled = isSampled({ velocities });
    if (sampled && motion.trim()) return "The velocities are those of your samples, and none can be given.";
    if (sampled && duration > samples.until) return `The velocities are sampled up to ${samples.times.at(-1)} s only.`;
    const { names } = schema.unknown;
    if (!same(unknown, names.filter((name) => unknown.includes(name)))) {
      return `Unknowns come in the order ${names.join(", ")}.`;
    }
    return duration / Math.min(period, step) > mostSteps ? `A run has ${mostSteps} steps at most.` : "";
  }
}
