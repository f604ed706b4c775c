// The controls of the observer lab: each reads from the settings and changes them.

import { HOLD, NOISE } from "../../state/schema.js";
import { checkbox, slider } from "../../ui/controls.js";
import { element } from "../../ui/dom.js";
import { Fieldsets, topic } from "../../ui/fieldsets.js";
import { ObserverList } from "../../ui/observer_list.js";
import { mapTopic } from "../../old/settings_map.js";
import { axesOf } from "./axes.js";

/** Labels of the settings in the page. */
export const WORDS = {
  outputs: {
    kind: "choice",
    choices: { "y1+y2": "y1 and y2", y1: "y1 only", y2: "y2 only", "y1+y2+s": "both, and the size s" },
  },
  X0: { name: "X0 {}", label: "start {}" },
  normal: { label: "normal {}" },
  noise: NOISE,
  hold: HOLD,
  start: {
    mode: { name: "start", choices: { own: "first sample and 0", zero: "zero", chosen: "chosen values" } },
    values: { name: "start {}", label: "start {}" },
  },
  believed: { A: { label: "Believed A" }, b: { name: "believed {}", label: "believed {}" } },
  pictures: {
    choices: {
      outputs: "image coordinates", innovation: "innovation", step: "steps of the estimate",
      inverse: "inverse distance", distance: "distance", error: "error", excitation: "excitation",
    },
  },
  bound: { choices: { error: "bound under the error", map: "map of the bound in the image" } },
};

/** Names of settings in a sentence that says which have changed. */
export const NAMES = {
  motion: "the motion that is typed", xi: "the ξ of the mirror", scenario: "the scenario", A: "the motion A",
  b: "the translation b", X0: "where the point starts", surface: "the imaging surface",
  normal: "the normal", outputs: "what is measured", observers: "the observers", gains: "gains",
  switches: "how an observer switches", believed: "the motion that is believed", noise: "noise",
  dropout: "lost samples", hold: "what is held between samples",
  start: "where the estimate starts", window: "the window", threshold: "the threshold", pictures: "the charts",
  bound: "where the bound is drawn", map: "what the map is of", over: "the map over two settings",
};

export class Panel extends Fieldsets {
  constructor(lab) {
    super(lab);
    this.list = new ObserverList(this);
    const { choices, mains, groups } = this.list;
    const noise = { label: "noise, bound or σ" };
    const hasMap = ({ bound }) => bound.includes("map");
    const map = ["map.seconds", "map.distance"].map((place) => this.numberIf(place, hasMap));
    const body = [
      this.first(
        this.fieldset("Measured", this.outputs()),
        this.fieldset("Observers", choices),
        this.fieldset("Move these", ...this.focus(), ...mains, this.simulated(this.number("noise.size", noise))),
      ),
      topic("gains", "All gains", ...groups),
      topic("point", "The point and its motion", ...this.point()),
      topic(
        ...["camera", "Camera"],
        this.simulated(this.choice("noise.kind"), ...this.numbersOf("camera")),
        this.choice("hold", { possible: (value) => value !== "exact" || !this.track() }),
      ),
      topic("start", "Start and belief", ...this.belief()),
      topic("pictures", "Charts", this.pictures(), this.boxes("bound", "bound"), ...map, ...this.numbersOf("pictures")),
      mapTopic(this, axesOf),
    ];
    this.body = element("div", { class: "panel" }, ...body);
  }

  track() {
    return this.model.recordings[this.lab.settings.scenario];
  }

  /** Controls of what a recording brings with it. */
  simulated(...rows) {
    return this.onlyIf(() => !this.track(), element("div", {}, ...rows));
  }

  outputs() {
    const { lab } = this;
    const seen = (name) => this.track()?.names.includes(name) ?? true;
    const outputsNow = () => this.model.surfaces[lab.settings.surface].outputs;
    const allowed = (value) => outputsNow().some((names) => names.join("+") === value);
    return this.inSight("outputs", {
      get: () => lab.settings.outputs.join("+"),
      set: (value) => lab.change({ outputs: value.split("+") }, true),
      possible: (value) => allowed(value) && value.split("+").every(seen),
    });
  }

  /** The focus of expansion in numbers, for those who do not drag it. */
  focus() {
    const { lab } = this;
    return [0, 1].map((c) =>
      this.add(
        slider({
          ...{ name: `foe y${c + 1}`, label: `FOE, y${c + 1}`, low: -3, high: 3, step: 0.01, least: -1000, most: 1000 },
          get: () => lab.focus()?.[c],
          set: (value) => {
            // What moved before may have put it at infinity, and the panel follows only some times a second.
            const foe = lab.focus();
            if (foe) lab.moveFoe(foe.with(c, value));
          },
          rest: () => lab.rest(),
        }),
      ),
    );
  }

  point() {
    const { lab, model } = this;
    const titles = Object.entries(model.scenarios).map(([name, { title }]) => [name, title]);
    const isSet = ({ scenario }) => !model.scenarios[scenario]?.track;
    const named = (names) => Object.keys(names).map((name) => [name, name]);
    return [
      this.choice("scenario", {
        choices: Object.fromEntries([...titles, ...named(model.recordings)]),
        set: (name) => lab.chooseScenario(name),
      }),
      this.simulated(
        this.choice("surface", { choices: Object.fromEntries(named(model.surfaces)) }),
        this.onlyIf(({ surface }) => surface === "plane", ...this.each("normal")),
        this.numberIf("xi", ({ surface }) => surface === "unified"),
        this.number("duration"),
        this.onlyIf(isSet, ...this.litList("b"), this.matrix("A"), this.typed("motion", "b1 = b1 + 0.2 sin(2t)")),
        ...this.each("X0"),
      ),
    ];
  }

  belief() {
    const { lab } = this;
    const wrong = checkbox({
      name: "believed",
      label: "the observers believe another motion than the true one",
      get: () => lab.settings.believed !== null,
      set: (on) => lab.change({ believed: on ? { A: lab.settings.A, b: lab.settings.b } : null }, true),
    });
    return [
      this.choice("start.mode"),
      ...[0, 1, 2].map((k) => this.numberIf(`start.values.${k}`, ({ start }) => start.mode === "chosen")),
      this.simulated(this.add(wrong), ...this.each("believed.b"), this.matrix("believed.A")),
    ];
  }
}
