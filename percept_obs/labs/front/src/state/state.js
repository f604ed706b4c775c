// State of a lab: settings, the question that is open, the span of time and the line that stand out; and the way back.

import { same } from "./settings.js";

/**
 * @typedef {import("../types.js").Settings} Settings
 * @typedef {object} Question       one that is open
 * @property {string} name
 * @property {Settings} before      the settings to go back to
 * @property {Settings} of          those that it, or its answer, is about
 * @property {number | null} said   which answer was chosen; null while it is asked
 * @typedef {object} Sight         the part of the time that the hand has asked for
 * @property {import("../old/timeline.js").Span} span
 * @property {string} of           scenario and times of the run in which it has: another one shows all
 * @typedef {object} Moment
 * @property {Settings} settings
 * @property {Question | null} question
 * @property {Sight | null} sight
 * @property {string | number | null} picked  the line that stands out
 */

const MOST_STEPS = 200;
/** Name of the step while a zoom may go on; no setting is called so. */
const LOOKING = "sight";

/** Settings with their history: one step is what a hand does from taking hold to letting go. */
export class State {
  constructor(settings) {
    /** @type {Moment} */
    this.now = { settings, question: null, sight: null, picked: null };
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

  get question() {
    return this.now.question;
  }

  /** The settings before a question, to which it leads back. */
  get before() {
    return this.question?.before ?? this.settings;
  }

  /** Take changes of a hand that may go on; those of the same settings are one step until release(). */
  move(changes) {
    const keys = Object.keys(changes).join();
    const settings = { ...this.settings, ...changes };
    if (this.held === keys) this.now = { ...this.now, settings };
    else this.step({ settings });
    this.held = keys;
  }

  /** Take another sight of the same settings; while a wheel turns it is one step, until seen(). */
  look(sight) {
    if (this.held === LOOKING) this.now = { ...this.now, sight };
    else this.step({ sight });
    this.held = LOOKING;
  }

  seen() {
    if (this.held === LOOKING) this.held = null;
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

  /** Ask a question, over the settings that it is about. */
  ask(name, settings) {
    this.step({ settings, question: { name, before: this.before, of: settings, said: null } });
  }

  /** Answer it, over the settings that show whether the answer is right. */
  answer(said, settings) {
    if (this.question) this.step({ settings, question: { ...this.question, of: settings, said } });
  }

  /** Close the question, and go back to the settings before it. */
  leave() {
    this.step({ settings: this.before, question: null });
  }

  reset(settings) {
    this.cursor = null;
    this.step({ settings, question: null, sight: null, picked: null });
    this.release();
  }
}
