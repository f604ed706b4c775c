// The lab of structure and motion: what is known, what can therefore be estimated, and how the estimates converge.

import { withoutRefused } from "../../engine/kernels.js";
import { same } from "../../state/settings.js";
import { summaryOf } from "../../state/words.js";
import { lettered, ObserverFormulas } from "../../ui/formulas.js";
import { ImagePlane } from "../../old/image_plane.js";
import { Lab } from "../../ui/lab.js";
import { Scene } from "../../old/scene.js";
import { SettingsMap } from "../../old/settings_map.js";
import { axesOf } from "./axes.js";
import { isSampled } from "./camera.js";
import { pythonOf } from "./code.js";
import { StructureEngine } from "./engine.js";
import { keyOf, StructureKernels } from "./kernels.js";
import { SYMBOLS } from "./symbols.js";
import { readingAt, reasons } from "./text.js";
import { ChoiceOfUnknowns } from "./choice.js";
import { StructureFirst } from "./screen.js";
import { NAMES, StructurePanel, WORDS } from "./panel.js";
import { chartOf, chartsOf, LABELS } from "./charts.js";
import { sceneOf } from "./old_scene.js";

const SYSTEM = "What multiplies the unknowns, and what is known";

export class StructureLab extends Lab {
  static computing = { Kernels: StructureKernels, Engine: StructureEngine, CellEngine: StructureEngine, axesOf };

  constructor(widget, place, model) {
    const words = { names: NAMES, symbols: SYMBOLS, reasons, readingAt, summaryOf, pythonOf };
    super(widget, model, { words: WORDS, labels: LABELS, chartOf, ...words });
    const scene = sceneOf(this);
    const plane = new ImagePlane(this, {
      arrowsOf: scene.arrowsOf,
      name: "ybar",
      label: "Start of the point",
      tag: "start",
      placeOf: (shown) => shown.settings.ybar.slice(0, 2),
      onMove: (point) => this.moveStart(point),
    });
    this.planes = [plane, new Scene(this, { image: plane, ...scene }), new SettingsMap(this, axesOf)];
    this.formulas = new ObserverFormulas(this.model, {
      systemOf: (settings) => [SYSTEM, model.unknowns[keyOf(settings)]?.formulas ?? []],
      numbersOf: (settings) => this.numbersOf(settings),
    });
    this.choice = new ChoiceOfUnknowns(this.model, this);
    this.panel = new StructurePanel(this, this.choice);
    this.first = new StructureFirst(this);
    this.open(place);
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

  moveStart([y1, y2]) {
    if (Math.abs(y1) <= 1000 && Math.abs(y2) <= 1000) this.change({ ybar: [y1, y2, this.settings.ybar[2]] });
  }

  fitted(asked) {
    return withoutRefused(asked, this.kernels.refused(asked), this.model.observers, "ideal");
  }

  clash({ velocities, motion, unknown, duration, period, step }) {
    const { mostSteps, samples, schema } = this.model;
    const sampled = isSampled({ velocities });
    if (sampled && motion.trim()) return "The velocities are those of your samples, and none can be typed.";
    if (sampled && duration > samples.until) return `The velocities are sampled up to ${samples.times.at(-1)} s only.`;
    const { names } = schema.unknown;
    if (!same(unknown, names.filter((name) => unknown.includes(name)))) {
      return `Unknowns come in the order ${names.join(", ")}.`;
    }
    return duration / Math.min(period, step) > mostSteps ? `A run has ${mostSteps} steps at most.` : "";
  }

  chosen() {
    return chartsOf(this.shown);
  }

  speak() {
    this.choice.show(this.shown);
    super.speak();
  }
}
