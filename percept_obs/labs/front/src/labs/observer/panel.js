// The controls of the observer lab's drawer: each reads from the settings and changes them.

import { HOLD, NOISE, WINDOW } from "../../state/schema.js";
import { Fieldsets } from "../../ui/fieldsets.js";
import { Observers } from "../../ui/observers.js";

/** Labels of the settings in the page. */
export const WORDS = {
  X0: { name: "X0 {}", label: "start {}" },
  normal: { label: "normal {}" },
  noise: NOISE,
  hold: HOLD,
  window: WINDOW,
  start: {
    mode: { name: "start", choices: { own: "first sample and 0", zero: "zero", chosen: "chosen values" } },
    values: { name: "start {}", label: "start {}" },
  },
  believed: { A: { label: "Believed A" }, b: { name: "believed {}", label: "believed {}" } },
};

/** Names of settings in a sentence that says which have changed. */
export const NAMES = {
  motion: "the motion over time", xi: "the ξ of the mirror", scenario: "the scenario", A: "the motion A",
  b: "the translation b", X0: "where the point starts", surface: "the imaging surface",
  normal: "the normal", outputs: "what is measured", observers: "the observers", gains: "gains",
  switches: "how an observer switches", believed: "the motion that is believed", noise: "noise",
  dropout: "lost samples", hold: "what is held between samples",
  start: "where the estimate starts", window: "the window", threshold: "the threshold",
};

export class Panel extends Fieldsets {
  constructor(lab) {
    super(lab);
    const observers = new Observers(this);
    this.groups = [
      ...observers.groups,
      { name: "scene", title: "Scene and motion", inside: this.scene() },
      { name: "camera", title: "Camera", inside: this.camera() },
      { name: "start", title: "Start and belief", inside: this.belief() },
    ];
  }

  track() {
    return this.model.recordings[this.lab.settings.scenario];
  }

  /** Controls of what a recording brings with it. */
  simulated(...rows) {
    return this.onlyIf(() => !this.track(), ...rows);
  }

  scene() {
    const { lab, model } = this;
    const titles = Object.entries(model.scenarios).map(([name, { title }]) => [name, title]);
    const isSet = ({ scenario }) => !model.scenarios[scenario]?.track;
    const named = (names) => Object.fromEntries(Object.keys(names).map((name) => [name, name]));
    return [
      this.choice("scenario", {
        choices: { ...Object.fromEntries(titles), ...named(model.recordings) },
        set: (name) => lab.chooseScenario(name),
      }),
      this.simulated(
        this.choice("surface", { choices: named(model.surfaces) }),
        this.onlyIf(({ surface }) => surface === "plane", ...this.each("normal")),
        this.numberIf("xi", ({ surface }) => surface === "unified"),
        this.number("duration"),
        this.onlyIf(isSet, ...this.litList("b"), this.matrix("A")),
        ...this.each("X0"),
      ),
    ];
  }

  camera() {
    return [
      this.simulated(this.choice("noise.kind"), ...this.of("camera")),
      this.choice("hold", { possible: (value) => value !== "exact" || !this.track() }),
    ];
  }

  belief() {
    const { lab } = this;
    const wrong = this.ticked({
      name: "believed",
      label: "the observers believe another motion than the true one",
      get: () => lab.settings.believed !== null,
      set: (on) => lab.change({ believed: on ? { A: lab.settings.A, b: lab.settings.b } : null }, true),
    });
    return [
      this.choice("start.mode"),
      ...[0, 1, 2].map((k) => this.numberIf(`start.values.${k}`, ({ start }) => start.mode === "chosen")),
      this.simulated(wrong, ...this.each("believed.b"), this.matrix("believed.A")),
    ];
  }
}
