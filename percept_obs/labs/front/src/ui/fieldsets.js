// What the drawers of all labs are made of: controls that read from a lab's settings and change them.

import { schemaAt } from "../state/schema.js";
import { changeAt, valueAt } from "../state/settings.js";
import { grid, select, slider, tick } from "./controls.js";
import { element, listen } from "../draw/dom.js";

/** Controls of a lab, whose schema says of each setting what it may be. */
export class Fieldsets {
  constructor(lab) {
    this.lab = lab;
    this.model = lab.model;
    this.schema = lab.schema;
    /** @type {any[]} */
    this.controls = [];
    this.shownFor = null;
    this.computed = false;
  }

  /** Bring all controls to the present settings. */
  show() {
    const { settings, shown, state } = this.lab;
    // What some controls say is known only once something of the settings was computed.
    const computed = shown?.settings === settings;
    if (this.shownFor === state.now && this.computed === computed) return;
    Object.assign(this, { shownFor: state.now, computed });
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

  /** Controls for what the schema puts into a topic. */
  of(topic) {
    return Object.keys(this.schema).filter((place) => this.schema[place].topic === topic)
      .map((place) => (this.schema[place].kind === "number" ? this.number(place) : this.choice(place)));
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

  /** A choice of one among several. */
  choice(place, more) {
    return this.add(select(this.bound(place, true, more)));
  }

  /** A box to tick. */
  ticked(options) {
    return this.add(tick(options));
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

/** Highlight a control's letter in a lab's formulas while the hand or the focus is on it. */
export function linkToFormula(control, lab, owner, letter) {
  listen(control.row, {
    "pointerenter focusin": () => lab.formulas.highlight(owner, letter),
    "pointerleave focusout": () => lab.formulas.highlight("", ""),
  });
}
