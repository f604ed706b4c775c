// What the panels of all labs are made of: groups of controls that read from a lab's settings and change them.

import { checkbox, element, grid, slider } from "./controls.js";

/** What observers may take for the outputs between samples. */
export const HOLDS = [
  ["zero", "the last sample"],
  ["first", "a line, a sample ahead"],
  ["exact", "the exact signal"],
];

/** Controls of a lab that has settings, change(), rest(), say() and formulas. */
export class Fieldsets {
  constructor(lab) {
    this.lab = lab;
    this.controls = [];
  }

  /** Leave the settings as they are, and say why. */
  refuse(reason) {
    this.lab.say(reason);
    this.shownFor = null;
    this.show();
  }

  add(control) {
    this.controls.push(control);
    return control.row;
  }

  fieldset(legend, attributes, ...rows) {
    return element("fieldset", attributes, element("legend", {}, legend), ...rows);
  }

  number(key, options) {
    const { lab } = this;
    return this.add(
      slider({
        name: key,
        get: () => lab.settings[key],
        set: (value) => lab.change({ [key]: value }),
        rest: () => lab.rest(),
        allowed: (v) => v >= options.least && v <= options.most,
        ...options,
      }),
    );
  }

  /** A slider for one entry of a list in the settings. */
  entry(key, k, options) {
    const { lab } = this;
    const put = (value) => lab.change({ [key]: lab.settings[key].map((old, i) => (i === k ? value : old)) });
    const rest = () => lab.rest();
    const allowed = (v) => Math.abs(v) <= 1000 && !(options.notZero && v === 0) && !(options.positive && v <= 0);
    return this.add(slider({ get: () => lab.settings[key][k], set: put, rest, allowed, ...options }));
  }

  /** Boxes that say which time charts are shown, by their names; one of them stays. */
  pictures(labels) {
    const { lab } = this;
    const names = Object.keys(labels);
    const boxes = names.map((name) =>
      this.add(
        checkbox({
          name: `picture ${name}`,
          label: labels[name],
          get: () => lab.settings.pictures.includes(name),
          set: (on) => {
            const chosen = names.filter((n) => (n === name ? on : lab.settings.pictures.includes(n)));
            if (chosen.length) lab.change({ pictures: chosen }, true);
            else this.refuse("At least one chart stays.");
          },
        }),
      ),
    );
    return element("div", { class: "choices", role: "group", "aria-label": "Time charts" }, ...boxes);
  }

  matrix(name, label, get, set) {
    const { lab } = this;
    const names = [1, 2, 3].flatMap((i) => [1, 2, 3].map((j) => `a${i}${j}`));
    const control = grid({
      name,
      label,
      rows: 3,
      columns: 3,
      names,
      get: () => get()?.flat(),
      set: (k, value) => set(get().map((row, i) => row.map((old, j) => (3 * i + j === k ? value : old)))),
      rest: () => lab.rest(),
    });
    for (const field of control.parts) {
      field.addEventListener("focus", () => lab.formulas.highlight("motion", field.dataset.entry));
      field.addEventListener("blur", () => lab.formulas.highlight("", ""));
    }
    return this.add(control);
  }
}

/** Light up a control's letter in the formulas while the hand or the focus is on it. */
export function linkToFormula(control, formulas, owner, letter) {
  const on = () => formulas().highlight(owner, letter);
  const off = () => formulas().highlight("", "");
  control.row.addEventListener("pointerenter", on);
  control.row.addEventListener("pointerleave", off);
  control.row.addEventListener("focusin", on);
  control.row.addEventListener("focusout", off);
}
