// What the panels of all labs are made of: groups of controls that read from a lab's settings and change them.

import { schemaAt } from "../model/schema.js";
import { changeAt, valueAt } from "../model/settings.js";
import { checkbox, element, grid, radios, select, slider } from "./controls.js";

/** Controls of a lab, whose schema says of each setting what it may be. */
export class Fieldsets {
  constructor(lab) {
    this.lab = lab;
    this.model = lab.model;
    this.schema = lab.schema;
    this.controls = [];
    this.shownFor = null;
    this.computed = false;
  }

  /** Bring all controls to the present settings. */
  show() {
    const { settings, shown } = this.lab;
    // What some controls say is known only once something of the settings was computed.
    const computed = shown?.settings === settings;
    if (this.shownFor === settings && this.computed === computed) return;
    Object.assign(this, { shownFor: settings, computed });
    for (const control of this.controls) control.show();
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

  /** A part of the page that is there only where it has a meaning. */
  onlyIf(holds, row) {
    this.controls.push({ row, show: () => (row.hidden = !holds(this.lab.settings)) });
    return row;
  }

  /** Controls under a name of their own. */
  fieldset(legend, ...rows) {
    return element("fieldset", {}, element("legend", {}, legend), ...rows);
  }

  /** What is asked for first, all in sight. */
  first(...rows) {
    return element("div", { class: "first" }, ...rows);
  }

  /** What schema and settings say of the value at a place: its name, and how to read and change it. */
  bound(place, chosen, more = {}) {
    const { lab } = this;
    return {
      name: place.replaceAll(".", " "),
      ...schemaAt(this.schema, place),
      get: () => valueAt(lab.settings, place),
      set: (value) => lab.change({ ...changeAt(lab.settings, place, value), ...more.besides?.(value) }, chosen),
      rest: () => lab.rest(),
      ...more,
    };
  }

  numbers(...places) {
    return places.map((place) => this.number(place));
  }

  number(place, more) {
    return this.add(slider(this.bound(place, false, more)));
  }

  /** Sliders for each number of the list at a place. */
  each(place, more) {
    return schemaAt(this.schema, place).entries.map((_, k) => this.number(`${place}.${k}`, more));
  }

  /** A number that has a meaning for some settings only. */
  numberIf(place, holds, more) {
    return this.number(place, { ...more, get: () => (holds(this.lab.settings) ? valueAt(this.lab.settings, place) : undefined) });
  }

  /** A choice of one among several, in a list to open, or all in sight. */
  choice(place, more) {
    return this.add(select(this.bound(place, true, more)));
  }

  inSight(place, more) {
    return this.add(radios(this.bound(place, true, more)));
  }

  /** How to read and change whether a name is among those at a place, of which one stays if there is a refusal. */
  among(place, all, name, refusal = "") {
    const { lab } = this;
    const set = (on) => {
      const chosen = all.filter((n) => (n === name ? on : lab.settings[place].includes(n)));
      if (chosen.length || !refusal) lab.change({ [place]: chosen }, true);
      else this.refuse(refusal);
    };
    return { get: () => lab.settings[place].includes(name), set };
  }

  /** Boxes to tick for the charts. */
  pictures() {
    return this.boxes("pictures", "picture", "At least one chart stays.");
  }

  /** Boxes to tick for the names at a place. */
  boxes(place, called, refusal = "") {
    const { label, choices } = this.schema[place];
    const all = Object.keys(choices);
    const boxes = all.map((name) => {
      const bound = this.among(place, all, name, refusal);
      return this.add(checkbox({ name: `${called} ${name}`, label: choices[name], ...bound }));
    });
    return element("div", { class: "choices", role: "group", "aria-label": label }, ...boxes);
  }

  /** Fields for the matrix at a place. */
  matrix(place) {
    const { lab } = this;
    const bound = this.bound(place, false);
    const names = [1, 2, 3].flatMap((i) => [1, 2, 3].map((j) => `a${i}${j}`));
    const control = grid({
      ...bound,
      names,
      get: () => bound.get()?.flat(),
      set: (k, value) => bound.set(bound.get().map((row, i) => row.map((old, j) => (3 * i + j === k ? value : old)))),
    });
    for (const field of control.parts) {
      field.addEventListener("focus", () => lab.formulas.highlight("motion", field.dataset.entry));
      field.addEventListener("blur", () => lab.formulas.highlight("", ""));
    }
    return this.add(control);
  }

  /** Light up the last control's letter in the formulas. */
  lit(row, letter, owner = "motion") {
    linkToFormula(this.controls.at(-1), () => this.lab.formulas, owner, letter);
    return row;
  }

  /** Sliders for each number of the list at a place, with letters in the formulas. */
  litList(place, letter = place, moreOf = (_letter) => ({}), owner = "motion") {
    const letters = schemaAt(this.schema, place).entries.map((_, k) => `${letter}${k + 1}`);
    return letters.map((each, k) => this.lit(this.number(`${place}.${k}`, moreOf(each)), each, owner));
  }
}

/** A part of the page that is closed until its title is pressed. */
export function topic(name, title, ...inside) {
  return element("details", { class: `topic ${name}` }, element("summary", { "data-control": `topic ${name}` }, title), ...inside);
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
