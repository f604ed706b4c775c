// What a lab is asked to show: settings, the preset that is open, the time at which values are read; and the way back.

import { same } from "./settings.js";

/**
 * @typedef {import("../../types.js").Settings} Settings
 * @typedef {{name: string, act: number, before: Settings | null}} Preset  an act is shown from 0 on
 * @typedef {{settings: Settings, preset: Preset | null}} Moment
 */

const MOST_STEPS = 200;

/** Settings with their history: one step is what a hand does from taking hold to letting go. */
export class State {
  constructor(settings) {
    /** @type {Moment} */
    this.now = { settings, preset: null };
    /** @type {number | null} */
    this.cursor = null;
    /** @type {Moment[]} */
    this.past = [];
    /** @type {Moment[]} */
    this.future = [];
    /** @type {string | null} */
    this.held = null;
  }

  get settings() {
    return this.now.settings;
  }

  get preset() {
    return this.now.preset;
  }

  /** Take changes of a hand that may go on; those of the same settings are one step until release(). */
  move(changes) {
    const keys = Object.keys(changes).join();
    const settings = { ...this.settings, ...changes };
    if (this.held === keys) this.now = { ...this.now, settings };
    else this.step({ settings });
    this.held = keys;
  }

  /** The hand lets go; what led nowhere is no step. */
  release() {
    this.held = null;
    if (this.past.length && same(this.past.at(-1), this.now)) this.past.pop();
  }

  /** Take another state as a step of its own. */
  step(changes) {
    this.past = [...this.past, this.now].slice(-MOST_STEPS);
    this.future = [];
    this.now = { ...this.now, ...changes };
    this.held = null;
  }

  /** Put settings in the place of the present ones, which are impossible. */
  amend(settings) {
    this.now = { ...this.now, settings };
  }

  /** Go back a step; whether there was one. */
  undo() {
    this.release();
    return this.go(this.past, this.future);
  }

  /** Take back what was undone; whether there was something. */
  redo() {
    return this.go(this.future, this.past);
  }

  go(from, to) {
    if (!from.length) return false;
    to.push(this.now);
    this.now = from.pop();
    this.held = null;
    return true;
  }

  /** Open a preset's question, which changes no setting yet. */
  ask(name) {
    this.now = { ...this.now, preset: { name, act: -1, before: this.preset?.before ?? null } };
  }

  act(act, settings) {
    const before = this.preset?.before ?? this.settings;
    this.step({ settings, preset: { name: this.preset?.name, act, before } });
  }

  /** Close the preset, and go back to the settings before its acts. */
  leave() {
    const before = this.preset?.before;
    if (before) this.step({ settings: before, preset: null });
    else this.now = { ...this.now, preset: null };
  }

  reset(settings) {
    this.cursor = null;
    this.step({ settings, preset: null });
    this.release();
  }
}
