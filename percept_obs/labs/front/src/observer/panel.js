// The controls of the observer lab: each reads from the settings and changes them.

import { checkbox, element, radios, select, slider } from "../common/controls.js";
import { Fieldsets, HOLDS, linkToFormula } from "../common/fieldsets.js";
import { ObserverList } from "../common/observer_list.js";

const OUTPUT_NAMES = { "y1+y2": "y1 and y2", y1: "y1 only", y2: "y2 only" };
const PICTURE_NAMES = {
  outputs: "image coordinates",
  inverse: "inverse distance",
  distance: "distance",
  error: "error",
  excitation: "excitation",
};

/** Fieldsets of controls; show() brings all of them to the present settings. */
export class Panel extends Fieldsets {
  constructor(model, lab) {
    super(lab);
    this.model = model;
    this.list = new ObserverList(this);
    this.body = element("div", { class: "panel" });
    this.body.append(
      element("div", { class: "observe" }, this.measuring(), this.fieldset("Observe with", {}, ...this.list.rows)),
      this.fieldset("Gains", { class: "gains" }, ...this.list.groups),
      this.point(),
      this.camera(),
      this.belief(),
      this.showing(),
    );
    this.simulated = this.body.querySelectorAll("[data-simulated]");
  }

  show() {
    const { lab, model } = this;
    if (this.shownFor === lab.settings) return;
    this.shownFor = lab.settings;
    for (const control of this.controls) control.show();
    this.list.show();
    const recorded = lab.settings.scenario in model.recordings;
    for (const node of this.simulated) node.hidden = recorded;
  }

  measuring() {
    const { lab, model } = this;
    const outputs = radios({
      name: "outputs",
      label: "Measured outputs",
      options: Object.entries(OUTPUT_NAMES),
      get: () => lab.settings.outputs.join("+"),
      set: (value) => lab.change({ outputs: value.split("+") }, true),
    });
    const show = outputs.show;
    outputs.show = () => {
      show();
      const track = model.recordings[lab.settings.scenario];
      for (const input of outputs.parts) {
        const names = input.value.split("+");
        const lost = track && !names.every((name) => track.names.includes(name));
        const { outputs } = model.surfaces[lab.settings.surface];
        input.disabled = Boolean(lost) || !outputs.some((allowed) => allowed.join("+") === input.value);
      }
    };
    return this.fieldset("Measure", {}, this.add(outputs));
  }

  point() {
    const { lab, model } = this;
    const names = [
      ...Object.entries(model.scenarios).map(([name, { title }]) => [name, title]),
      ...Object.keys(model.recordings).map((name) => [name, name]),
    ];
    const scenario = select({
      name: "scenario",
      label: "Scenario",
      options: names,
      get: () => lab.settings.scenario,
      set: (name) => lab.chooseScenario(name),
    });
    const surface = select({
      name: "surface",
      label: "Imaging surface",
      options: Object.keys(model.surfaces).map((name) => [name, name]),
      get: () => lab.settings.surface,
      set: (name) => lab.change({ surface: name }, true),
    });
    const b = ["b1", "b2", "b3"].map((name, k) => {
      const row = this.entry("b", k, { name, label: name, unit: "m/s", low: -1, high: 1, step: 0.01 });
      linkToFormula(this.controls.at(-1), () => lab.formulas, "motion", name);
      return row;
    });
    const X0 = ["X", "Y", "Z"].map((name, k) =>
      this.entry("X0", k, { name: `X0 ${name}`, label: `start ${name}`, unit: "m", low: -5, high: 10, step: 0.05 }),
    );
    const normal = ["n1", "n2", "n3"].map((name, k) => {
      const options = { name, label: `normal ${name}`, low: -1, high: 1, step: 0.05, notZero: k === 2 };
      const row = this.entry("normal", k, options);
      const control = this.controls.at(-1);
      const show = control.show;
      control.show = () => {
        show();
        row.hidden = lab.settings.surface !== "plane";
      };
      return row;
    });
    const A = this.matrix("A", "Motion A", () => lab.settings.A, (value) => lab.change({ A: value }));
    const duration = this.number("duration", {
      label: "duration", unit: "s", low: 2, high: 120, step: 1, least: 0.1, most: 200,
    });
    const own = element("div", { "data-simulated": true }, this.add(surface), ...normal, duration, ...b, A, ...X0);
    return this.fieldset("The point and its motion", { class: "point" }, this.add(scenario), own);
  }

  camera() {
    const { lab } = this;
    const kind = select({
      name: "noise kind",
      label: "Noise",
      options: [
        ["uniform", "uniform"],
        ["gaussian", "Gaussian"],
      ],
      get: () => lab.settings.noise.kind,
      set: (value) => lab.change({ noise: { ...lab.settings.noise, kind: value } }, true),
    });
    const size = slider({
      name: "noise size",
      label: "bound or σ",
      low: 0,
      high: 0.05,
      step: 0.0005,
      get: () => lab.settings.noise.size,
      set: (value) => lab.change({ noise: { ...lab.settings.noise, size: value } }),
      rest: () => lab.rest(),
      allowed: (v) => v >= 0 && v <= 1,
    });
    const hold = select({
      name: "hold",
      label: "Hold",
      options: HOLDS,
      get: () => lab.settings.hold,
      set: (value) => lab.change({ hold: value }, true),
    });
    const showHold = hold.show;
    hold.show = () => {
      const recorded = lab.settings.scenario in this.model.recordings;
      hold.parts[0].querySelector("[value=exact]").disabled = recorded;
      showHold();
    };
    return this.fieldset(
      "Camera",
      { class: "camera" },
      element(
        "div",
        { "data-simulated": true },
        this.add(kind),
        this.add(size),
        this.number("seed", { label: "seed", low: 0, high: 100, step: 1, whole: true, least: 0, most: 2 ** 32 - 1 }),
        this.number("period", { label: "period", unit: "s", low: 0.002, high: 0.2, log: true, least: 0.001, most: 1 }),
        this.number("dropout", { label: "lost samples", low: 0, high: 0.9, step: 0.01, least: 0, most: 0.95 }),
      ),
      this.add(hold),
    );
  }

  belief() {
    const { lab } = this;
    const mode = select({
      name: "start",
      label: "x̂ starts at",
      options: [
        ["own", "first sample and 0"],
        ["zero", "zero"],
        ["chosen", "chosen values"],
      ],
      get: () => lab.settings.start.mode,
      set: (value) => lab.change({ start: { ...lab.settings.start, mode: value } }, true),
    });
    const values = ["y1", "y2", "y3"].map((name, k) => {
      const control = slider({
        name: `start ${name}`,
        label: `start ${name}`,
        low: -2,
        high: 2,
        step: 0.01,
        allowed: (v) => Math.abs(v) <= 1000,
        get: () => (lab.settings.start.mode === "chosen" ? lab.settings.start.values[k] : undefined),
        set: (value) => {
          const { start } = lab.settings;
          lab.change({ start: { ...start, values: start.values.map((old, i) => (i === k ? value : old)) } });
        },
        rest: () => lab.rest(),
      });
      return this.add(control);
    });
    const wrong = checkbox({
      name: "believed",
      label: "believe another motion than the true one",
      get: () => lab.settings.believed !== null,
      set: (on) => lab.change({ believed: on ? { A: lab.settings.A, b: lab.settings.b } : null }, true),
    });
    const believed = (change) => lab.change({ believed: { ...lab.settings.believed, ...change } });
    const b = ["b1", "b2", "b3"].map((name, k) =>
      this.add(
        slider({
          name: `believed ${name}`,
          label: `believed ${name}`,
          unit: "m/s",
          low: -1,
          high: 1,
          step: 0.01,
          allowed: (v) => Math.abs(v) <= 1000,
          get: () => lab.settings.believed?.b[k],
          set: (value) => believed({ b: lab.settings.believed.b.map((old, i) => (i === k ? value : old)) }),
          rest: () => lab.rest(),
        }),
      ),
    );
    const A = this.matrix("believed A", "Believed A", () => lab.settings.believed?.A, (value) => believed({ A: value }));
    const simulated = element("div", { "data-simulated": true }, this.add(wrong), ...b, A);
    return this.fieldset("Start and belief", { class: "start" }, this.add(mode), ...values, simulated);
  }

  showing() {
    return this.fieldset(
      "Pictures",
      { class: "pictures" },
      this.pictures(PICTURE_NAMES),
      this.number("window", { label: "window", unit: "s", low: 0.5, high: 30, step: 0.5, least: 0.1, most: 200 }),
      this.number("threshold", { label: "threshold of |w|", low: 0, high: 0.5, step: 0.005, least: 0, most: 10 }),
    );
  }
}
