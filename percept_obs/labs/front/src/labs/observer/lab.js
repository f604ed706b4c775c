// The observer lab: a camera, a moving point, and observers that recover its distance.

import { withoutRefused } from "../../engine/kernels.js";
import { same } from "../../state/settings.js";
import { readingAt, summaryOf } from "../../state/words.js";
import { lettered, ObserverFormulas } from "../../ui/formulas.js";
import { ImagePlane } from "../../old/image_plane.js";
import { Lab } from "../../ui/lab.js";
import { Scene } from "../../old/scene.js";
import { SettingsMap } from "../../old/settings_map.js";
import { axesOf } from "./axes.js";
import { CellEngine } from "./cell_engine.js";
import { noBound } from "./bound.js";
import { pythonOf } from "./code.js";
import { Engine, focusOf, translationTowards } from "./engine.js";
import { Kernels, keyOf } from "./kernels.js";
import { SYMBOLS } from "./symbols.js";
import { causesOf } from "./causes.js";
import { reasons } from "./text.js";
import { ObserverFirst } from "./screen.js";
import { MapPicture } from "./old_map.js";
import { NAMES, Panel, WORDS } from "./panel.js";
import { chartOf, LABELS } from "./charts.js";
import { sceneOf } from "./old_scene.js";

const ALWAYS_POSSIBLE = "identifier_based";
const RECORDED = "its motion is as it was measured, and between samples nothing is known";

export class ObserverLab extends Lab {
  static computing = { Kernels, Engine, CellEngine, axesOf };

  constructor(widget, place, model) {
    super(widget, model, {
      words: WORDS,
      reasons: (shown) => [...reasons(shown, model), ...this.unbound(shown.settings)],
      ...{ names: NAMES, symbols: SYMBOLS, labels: LABELS, chartOf, readingAt, summaryOf, pythonOf, causesOf },
    });
    const scene = sceneOf(this);
    const plane = new ImagePlane(this, {
      arrowsOf: scene.arrowsOf,
      alikeOf: scene.alikeOf,
      focusAt: scene.focusAt,
      name: "foe",
      label: "Focus of expansion",
      tag: "FOE",
      placeOf: (shown) => shown.foe,
      towardsOf: (shown) => shown.foeTowards,
      onMove: (foe) => this.moveFoe(foe),
    });
    this.map = plane.map = new MapPicture(this);
    this.planes = [plane, new Scene(this, { image: plane, ...scene }), new SettingsMap(this, axesOf)];
    this.formulas = new ObserverFormulas(this.model, {
      systemOf: (settings) => ["What is measured and what is hidden", model.forms[keyOf(settings)].formulas],
      numbersOf: ({ A, b, normal, xi }) => ({ ...lettered({ a1: A[0], a2: A[1], a3: A[2], b, n: normal }), xi }),
    });
    this.panel = new Panel(this);
    this.first = new ObserverFirst(this);
    this.open(place);
  }

  /** The focus of expansion of the present settings; null where there is none in the image. */
  focus() {
    const functions = this.kernels.of(this.settings);
    return functions ? focusOf(this.settings, functions, this.model) : null;
  }

  copy() {
    return pythonOf(this.shown, this.model, this.map.found);
  }

  /** Why the bound is not drawn, though it is asked for. */
  unbound(settings) {
    const why = settings.bound.length ? noBound(settings, this.model) : "";
    return why ? [why] : [];
  }

  legend() {
    const { bound, settings } = this.shown;
    return [...super.legend(), ...(bound && settings.pictures.includes("error") ? [["limit", "bound"]] : [])];
  }

  moveFoe(place) {
    const functions = this.kernels.of(this.settings);
    if (!functions || this.settings.scenario in this.model.recordings) return;
    const b = translationTowards(place, this.settings, functions);
    if (b.every((value) => Math.abs(value) <= 1000)) this.change({ b });
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
    if (own && motion.trim()) return `${scenario} has a motion of its own, and none can be typed.`;
    if (!track) return "";
    if (surface !== track.surface) return `${scenario} was seen on the ${track.surface} surface.`;
    const names = track.names.join(" and ");
    if (!outputs.every((name) => track.names.includes(name))) return `${scenario} has ${names} only.`;
    return believed || hold === "exact" ? `${scenario} is a recording: ${RECORDED}.` : "";
  }
}
