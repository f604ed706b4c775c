// What the panels of all labs are made of: groups of controls that read from a lab's settings and change them.

import { schemaAt } from "../state/schema.js";
import { changeAt, valueAt } from "../state/settings.js";
import { checkbox, grid, radios, select, slider } from "./controls.js";
import { element, listen } from "./dom.js";
import { typedField } from "../old/typed.js";

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

  add(control) {
    this.controls.push(control);
    return control.row;
  }

  /** A part of the page that is there only where it has a meaning. */
  onlyIf(holds, ...rows) {
    const row = rows.length === 1 ? rows[0] : element("div", {}, ...rows);
    this.controls.push({ row, show: () => (row.hidden = !holds(this.lab.settings)) });
    return row;
  }

  /** Controls under a name of their own. */
  fieldset(legend, ...rows) {
    return element("fieldset", {}, element("legend", {}, legend), ...rows);
  }

  /** The first controls, all in sight. */
  first(...rows) {
    return element("div", { class: "first" }, ...rows);
  }

  /** Options of a control for the setting at a place: its schema, its name, and functions to read and change it. */
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

  /** Sliders for the numbers that the schema puts into a topic. */
  numbersOf(name) {
    return this.numbers(...Object.keys(this.schema).filter((place) => this.schema[place].topic === name));
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
    const { lab } = this;
    const get = () => (holds(lab.settings) ? valueAt(lab.settings, place) : undefined);
    return this.number(place, { ...more, get });
  }

  /** A choice of one among several, in a list to open, or all in sight. */
  choice(place, more) {
    return this.add(select(this.bound(place, true, more)));
  }

  inSight(place, more) {
    return this.add(radios(this.bound(place, true, more)));
  }

  /** Functions to read and change whether a name is in the list at a place; with a refusal one name stays. */
  among(place, all, name, refusal = "") {
    const { lab } = this;
    const set = (on) => {
      const chosen = all.filter((n) => (n === name ? on : lab.settings[place].includes(n)));
      if (chosen.length || !refusal) return lab.change({ [place]: chosen }, true);
      lab.say(refusal);
      this.shownFor = null;
      return this.show();
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

  /** Fields for the 3 x 3 matrix at a place. */
  matrix(place) {
    const { lab } = this;
    const bound = this.bound(place, false);
    const change = (k, value) => bound.get().map((row, i) => row.map((old, j) => (3 * i + j === k ? value : old)));
    const control = grid({
      ...bound,
      names: [1, 2, 3].flatMap((i) => [1, 2, 3].map((j) => `a${i}${j}`)),
      get: () => bound.get()?.flat(),
      set: (k, value) => bound.set(change(k, value)),
    });
    for (const field of control.parts) {
      listen(field, {
        focus: () => lab.formulas.highlight("motion", field.dataset.entry),
        blur: () => lab.formulas.highlight("", ""),
      });
    }
    return this.add(control);
  }

  /** A field for an expression, which Python reads; a text without "=" takes the prefix. */
  typed(place, hint, prefix = "") {
    const { label, most } = this.schema[place];
    return this.add(typedField(this.lab, { ...this.bound(place, true), label, most, hint, prefix }));
  }

  /** Highlight the last control's letter in the formulas while the hand or the focus is on it. */
  lit(row, letter, owner = "motion") {
    linkToFormula(this.controls.at(-1), this.lab, owner, letter);
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
  const summary = element("summary", { "data-control": `topic ${name}` }, title);
  return element("details", { class: `topic ${name}` }, summary, ...inside);
}

/** Highlight a control's letter in a lab's formulas while the hand or the focus is on it. */
export function linkToFormula(control, lab, owner, letter) {
  listen(control.row, {
    "pointerenter focusin": () => lab.formulas.highlight(owner, letter),
    "pointerleave focusout": () => lab.formulas.highlight("", ""),
  });
}
