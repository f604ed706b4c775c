// The controls of the lab of many points: each reads from the settings and changes them.

import { button, element, radios, select, slider } from "../common/controls.js";
import { Fieldsets, HOLDS, linkToFormula } from "../common/fieldsets.js";
import { PointList } from "./point_list.js";

const STATES = [
  ["body", "one rigid body: first point and offsets"],
  ["independent", "points of their own"],
  ["origin", "a body with an unmarked origin"],
];
const WEIGHTS = [
  ["constant", "constant"],
  ["scheduled", "scheduled"],
  ["lyapunov", "Lyapunov"],
  ["riccati", "Riccati"],
];
/** What P begins with when a kind is chosen. */
const OWN_SIZE = { constant: 1, scheduled: 0.3, lyapunov: 1, riccati: 0.01 };
const SIZES = {
  constant: "P, times the identity",
  scheduled: "P at the beginning",
  lyapunov: "P at the beginning",
  riccati: "P at the beginning",
};
const PICTURE_NAMES = { error: "error", depth: "depths", points: "error of each point", gramian: "Gramian" };

/** Fieldsets of controls; show() brings all of them to the present settings. */
export class Panel extends Fieldsets {
  constructor(model, lab) {
    super(lab);
    this.model = model;
    this.list = new PointList(this, model.mostPoints);
    this.body = element(
      "div",
      { class: "columns" },
      this.fieldset("Points", {}, this.list.body),
      this.state(),
      this.weight(),
      this.motion(),
      this.start(),
      this.camera(),
      this.showing(),
    );
  }

  show() {
    const { lab } = this;
    if (this.shownFor === lab.settings) return;
    this.shownFor = lab.settings;
    for (const control of this.controls) control.show();
    this.list.show();
    this.sizeLabel.textContent = SIZES[lab.settings.weight];
  }

  choice(key, label, options, more = () => ({})) {
    const { lab } = this;
    const set = (value) => lab.change({ [key]: value, ...more(value) }, true);
    return this.add(select({ name: key, label, options, get: () => lab.settings[key], set }));
  }

  /** A number that has a meaning for some settings only. */
  numberIf(key, holds, options) {
    const { lab } = this;
    return this.number(key, { ...options, get: () => (holds(lab.settings) ? lab.settings[key] : undefined) });
  }

  state() {
    const { lab } = this;
    const chosen = radios({
      name: "state",
      label: "State",
      options: STATES,
      get: () => lab.settings.state,
      set: (value) => lab.change({ state: value }, true),
    });
    return this.fieldset("The state holds", { class: "state" }, this.add(chosen));
  }

  weight() {
    const kind = this.choice("weight", "P is", WEIGHTS, (value) => ({ size: OWN_SIZE[value] }));
    const size = this.number("size", { label: "P", log: true, low: 0.001, high: 100, least: 1e-4, most: 1e4 });
    this.sizeLabel = size.querySelector("label span");
    return this.fieldset(
      "The observer's P",
      {},
      kind,
      size,
      this.numberIf("final", ({ weight }) => weight === "scheduled", {
        label: "P at the end", log: true, low: 0.001, high: 100, least: 1e-4, most: 1e4,
      }),
      this.numberIf("decrease", ({ weight }) => weight === "lyapunov", {
        label: "decrease", unit: "1/s", low: 0, high: 0.5, step: 0.005, least: 0, most: 100,
      }),
      this.numberIf("forgetting", ({ weight }) => weight === "riccati", {
        label: "forgetting", unit: "1/s", low: 0, high: 2, step: 0.02, least: 0, most: 100,
      }),
      this.number("step", { label: "longest step", unit: "s", log: true, low: 0.002, high: 0.1, least: 1e-3, most: 0.1 }),
    );
  }

  motion() {
    const { letters } = this.model;
    const linked = (row, letter) => {
      linkToFormula(this.controls.at(-1), () => this.lab.formulas, "", letter);
      return row;
    };
    const share = (key, label, holds = () => true) =>
      linked(
        this.numberIf(key, holds, { label, letter: letters[key], low: -2, high: 2, step: 0.05, least: -10, most: 10 }),
        key,
      );
    const v = ["X", "Y", "Z"].map((axis, k) => {
      const [letter, name, label] = [letters[`v${k + 1}`], `velocity ${axis}`, `added to v, ${axis}`];
      const row = this.entry("velocity", k, { name, label, letter, unit: "m/s", low: -1, high: 1, step: 0.02 });
      return linked(row, `v${k + 1}`);
    });
    const aim = button("Along the ray of point 1", () => this.lab.aim(), { "data-control": "aim" });
    const still = button("v = 0", () => this.lab.change({ input: 0, velocity: [0, 0, 0] }, true), { "data-control": "no input" });
    return this.fieldset(
      "The motion, A(t) and v(t)",
      {},
      share("turning", "camera turns"),
      share("spin", "body turns", ({ state }) => state !== "independent"),
      share("input", "input"),
      ...v,
      element("div", { class: "buttons" }, still, aim),
    );
  }

  start() {
    return this.fieldset(
      "The estimate",
      {},
      this.choice("start", "it starts", [
        ["rays", "on the first rays"],
        ["error", "with a given error"],
        ["zero", "at zero"],
      ]),
      this.numberIf("depth", ({ start }) => start === "rays", {
        label: "at the depth", unit: "m", low: 0.5, high: 6, step: 0.05, least: 0.01, most: 100,
      }),
      this.numberIf("error", ({ start }) => start === "error", {
        label: "error, times the given", low: -3, high: 3, step: 0.05, least: -100, most: 100,
      }),
    );
  }

  camera() {
    const { lab } = this;
    const noise = (change) => lab.change({ noise: { ...lab.settings.noise, ...change } });
    const kind = select({
      name: "noise kind",
      label: "noise",
      options: [
        ["uniform", "uniform"],
        ["gaussian", "Gaussian"],
      ],
      get: () => lab.settings.noise.kind,
      set: (value) => {
        noise({ kind: value });
        lab.rest();
      },
    });
    const size = slider({
      name: "noise size",
      label: "bound or σ",
      low: 0,
      high: 0.05,
      step: 0.0005,
      get: () => lab.settings.noise.size,
      set: (value) => noise({ size: value }),
      rest: () => lab.rest(),
      allowed: (v) => v >= 0 && v <= 1,
    });
    return this.fieldset(
      "Camera",
      {},
      this.add(kind),
      this.add(size),
      this.number("seed", { label: "seed", low: 0, high: 100, step: 1, whole: true, least: 0, most: 2 ** 32 - 1 }),
      this.number("period", { label: "period", unit: "s", low: 0.01, high: 0.2, log: true, least: 0.005, most: 1 }),
      this.number("dropout", { label: "lost samples", low: 0, high: 0.9, step: 0.01, least: 0, most: 0.95 }),
      this.number("view", { label: "sees |y| up to", low: 0.2, high: 4, step: 0.05, least: 0.1, most: 100 }),
      this.choice("hold", "Hold", HOLDS),
    );
  }

  showing() {
    return this.fieldset(
      "Pictures",
      {},
      this.pictures(PICTURE_NAMES),
      this.number("duration", { label: "duration", unit: "s", low: 4, high: 60, step: 1, least: 1, most: 120 }),
      this.number("window", { label: "window T", unit: "s", low: 0.5, high: 20, step: 0.5, least: 0.1, most: 120 }),
    );
  }
}
