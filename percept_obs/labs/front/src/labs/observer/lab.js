// The observer lab: a camera, a moving point, and observers that recover its distance.

import { withoutRefused } from "../../engine/kernels.js";
import { same } from "../../state/settings.js";
import { lettered, ObserverFormulas } from "../../ui/formulas.js";
import { Lab } from "../../ui/lab.js";
import { summaryOf } from "../../ui/words.js";
import { chartOf, CHARTS } from "./charts.js";
import { pythonOf } from "./code.js";
import { Engine } from "./engine.js";
import { Kernels, keyOf } from "./kernels.js";
import { NAMES, Panel, WORDS } from "./panel.js";
import { ObserverScreen } from "./screen.js";
import { SYMBOLS } from "./symbols.js";
import { reasons } from "./text.js";

const ALWAYS_POSSIBLE = "identifier_based";
const RECORDED = "its motion is as it was measured, and between samples nothing is known";

export class ObserverLab extends Lab {
  static computing = { Kernels, Engine };

  constructor(widget, place, model) {
    const parts = { names: NAMES, symbols: SYMBOLS, charts: CHARTS, chartOf, reasons, summaryOf, pythonOf };
    super(widget, model, { words: WORDS, ...parts });
    this.formulas = new ObserverFormulas(this.model, {
      systemOf: (settings) => ["What is measured and what is hidden", model.forms[keyOf(settings)].formulas],
      numbersOf: ({ A, b, normal, xi }) => ({ ...lettered({ a1: A[0], a2: A[1], a3: A[2], b, n: normal }), xi }),
    });
    this.panel = new Panel(this);
    this.screen = new ObserverScreen(this);
    this.open(place, this.panel.groups);
  }

  chooseScenario(name) {
    const { title: _title, track: _sampled, ...fit } = this.model.scenarios[name] ?? {};
    const track = this.model.recordings[name];
    if (!track) return this.change({ scenario: name, ...fit }, true);
    const { surface, outputs, duration, window } = track;
    const hold = this.settings.hold === "exact" ? "zero" : this.settings.hold;
    return this.change({ scenario: name, surface, outputs, duration, window, hold, motion: "", believed: null }, true);
  }

  fitted(asked) {
    const { outputs } = this.model.surfaces[asked.surface];
    const allowed = outputs.some((names) => same(names, asked.outputs));
    const settings = allowed ? asked : { ...asked, outputs: [...outputs[0]] };
    const needed = allowed ? "" : `The ${asked.surface} surface needs ${outputs[0].join(" and ")} to be measured.`;
    const found = withoutRefused(settings, this.kernels.refused(settings), this.model.observers, ALWAYS_POSSIBLE);
    return { settings: found.settings, why: found.why || needed };
  }

  clash({ scenario, surface, outputs, hold, believed, motion }) {
    const track = this.model.recordings[scenario];
    const own = track || this.model.scenarios[scenario].track;
    if (own && motion.trim()) return `${scenario} has a motion of its own, and none can be given.`;
    if (!track) return "";
    if (surface !== track.surface) return `${scenario} was seen on the ${track.surface} surface.`;
    const names = track.names.join(" and ");
    if (!outputs.every((name) => track.names.includes(name))) return `${scenario} has ${names} only.`;
    return believed || hold === "exact" ? `${scenario} is a recording: ${RECORDED}.` : "";
  }
}
