// The controls of the structure lab: each reads from the settings and changes them.

import { checkbox, element, select, slider } from "../common/controls.js";
import { Fieldsets, HOLDS, linkToFormula } from "../common/fieldsets.js";
import { ObserverList } from "../common/observer_list.js";

const PICTURE_NAMES = {
  unknowns: "the unknowns",
  error: "error",
  image: "image coordinates",
  depth: "scaled inverse depth",
  innovation: "innovation",
  determinant: "determinant",
  range: "range",
};

/** Fieldsets of controls; show() brings all of them to the present settings. */
export class StructurePanel extends Fieldsets {
  constructor(model, lab) {
    super(lab);
    this.model = model;
    this.list = new ObserverList(this);
    this.body = element(
      "div",
      { class: "panel" },
      element("div", { class: "observe" }, this.fieldset("Observe with", {}, ...this.list.rows)),
      this.fieldset("Gains", { class: "gains" }, ...this.list.groups),
      this.motion(),
      this.measuring(),
      this.running(),
      this.showing(),
    );
  }

  show() {
    const { lab } = this;
    if (this.shownFor === lab.settings) return;
    this.shownFor = lab.settings;
    for (const control of this.controls) control.show();
    this.list.show();
  }

  /** A slider whose letter lights up in the formulas. */
  lit(row, letter) {
    linkToFormula(this.controls.at(-1), () => this.lab.formulas, "motion", letter);
    return row;
  }

  velocity(which, words) {
    return [0, 1, 2].map((k) => {
      const name = `${which}${k + 1}`;
      const options = { name, label: `${words} ${name}`, unit: "m/s", low: -1, high: 1, step: 0.01 };
      return this.lit(this.entry(which, k, options), name);
    });
  }

  /** Sliders for how far velocities swing; gone while none does. */
  swing(which) {
    const { lab } = this;
    return [0, 1, 2].map((k) => {
      const key = `${which}_swing`;
      const row = this.entry(key, k, { name: `swing ${which}${k + 1}`, label: `swing of ${which}${k + 1}`, unit: "m/s", low: -0.5, high: 0.5, step: 0.01 });
      return this.onlyIf(row, () => swings(lab.settings));
    });
  }

  /** Hide the last control's row where it has nothing to say. */
  onlyIf(row, holds) {
    const control = this.controls.at(-1);
    const { show } = control;
    control.show = () => {
      show();
      row.hidden = !holds();
    };
    return row;
  }

  motion() {
    const { lab } = this;
    const scale = this.number("scale", { label: "true d_s", unit: "1/m", low: 0.5, high: 50, log: true, least: 1e-3, most: 1e3 });
    const ybar = ["y1", "y2", "ybar3"].map((name, k) => {
      const range = k < 2 ? { low: -1, high: 1, step: 0.01 } : { low: 0.005, high: 1, log: true };
      const row = this.entry("ybar", k, { name: `start ${name}`, label: `start ${name.replace("ybar", "ȳ")}`, ...range, positive: k === 2 });
      return row;
    });
    const varying = checkbox({
      name: "swings",
      label: "velocities that vary",
      get: () => swings(lab.settings),
      set: (on) => {
        const size = on ? 0.1 : 0;
        lab.change({ v_c_swing: [size, size, -size], v_p_swing: [0, 0, 0] }, true);
      },
    });
    const boxed = this.add(varying);
    const rate = this.number("rate", { label: "at a rate of", unit: "rad/s", low: 0, high: 1, step: 0.01, least: 0, most: 10 });
    this.onlyIf(rate, () => swings(lab.settings));
    const w = [0, 1, 2].map((k) =>
      this.lit(this.entry("w", k, { name: `w${k + 1}`, label: `turning w${k + 1}`, unit: "rad/s", low: -0.5, high: 0.5, step: 0.01 }), `w${k + 1}`),
    );
    return this.fieldset(
      "What is true",
      { class: "point" },
      scale,
      ...this.velocity("v_c", "camera"),
      ...this.velocity("v_p", "object"),
      boxed,
      rate,
      ...this.swing("v_c"),
      ...this.swing("v_p"),
      ...ybar,
      ...w,
    );
  }

  measuring() {
    const { lab } = this;
    const noise = (change) => ({ noise: { ...lab.settings.noise, ...change } });
    const kind = select({
      name: "noise kind",
      label: "Noise",
      options: [
        ["uniform", "uniform"],
        ["gaussian", "Gaussian"],
      ],
      get: () => lab.settings.noise.kind,
      set: (value) => lab.change(noise({ kind: value }), true),
    });
    const size = (key, label, high) =>
      this.add(
        slider({
          name: `noise ${key}`,
          label,
          low: 0,
          high,
          step: high / 200,
          get: () => lab.settings.noise[key],
          set: (value) => lab.change(noise({ [key]: value })),
          rest: () => lab.rest(),
          allowed: (v) => v >= 0 && v <= 1,
        }),
      );
    const fits = (key) => (value) => this.fits({ [key]: value });
    return this.fieldset(
      "What is measured",
      { class: "camera" },
      this.add(kind),
      size("size", "in y1, y2", 1e-3),
      size("depth", "in ȳ3", 1e-4),
      this.number("bias", { label: "bias of ȳ3", low: -0.01, high: 0.01, step: 1e-4, least: -1, most: 1 }),
      this.number("drift", { label: "drift of ȳ3", unit: "1/s", low: -0.001, high: 0.001, step: 1e-5, least: -1, most: 1 }),
      this.number("seed", { label: "seed", low: 0, high: 100, step: 1, whole: true, least: 0, most: 2 ** 32 - 1 }),
      this.number("period", { label: "period", unit: "s", low: 1e-4, high: 0.1, log: true, least: 1e-4, most: 1, allowed: fits("period") }),
      this.number("duration", { label: "duration", unit: "s", low: 1, high: 60, step: 0.5, least: 0.1, most: 100, allowed: fits("duration") }),
    );
  }

  /** Whether settings have no more steps than the page can take, and a positive number where one is needed. */
  fits(changes) {
    const { duration, period, step } = { ...this.lab.settings, ...changes };
    const { low, high } = this.model.schema[Object.keys(changes)[0]];
    const [value] = Object.values(changes);
    return value >= low && value <= high && duration / Math.min(period, step) <= this.model.mostSteps;
  }

  running() {
    const { lab } = this;
    const choose = (key, label, options) =>
      this.add(select({ name: key, label, options, get: () => lab.settings[key], set: (value) => lab.change({ [key]: value }, true) }));
    return this.fieldset(
      "How the observers run",
      { class: "start" },
      choose("start", "ŷ starts at", [
        ["own", "the first sample"],
        ["zero", "zero"],
      ]),
      choose("hold", "Hold", HOLDS),
      this.number("step", { label: "longest step", unit: "s", low: 1e-4, high: 0.01, log: true, least: 1e-5, most: 0.1, allowed: (v) => this.fits({ step: v }) }),
      this.number("tolerance", { label: "tolerance", low: 1e-4, high: 1, log: true, least: 1e-6, most: 10 }),
    );
  }

  showing() {
    return this.fieldset(
      "Pictures",
      { class: "pictures" },
      this.pictures(PICTURE_NAMES),
    );
  }
}

function swings({ v_c_swing, v_p_swing }) {
  return [...v_c_swing, ...v_p_swing].some((value) => value !== 0);
}
