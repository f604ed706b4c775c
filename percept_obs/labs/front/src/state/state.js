// State of a lab: settings, what of them is looked at, the question that is open; and the way back.

import { same } from "./settings.js";

/**
 * @typedef {import("../types.js").Settings} Settings
 * @typedef {object} Question       one that is open
 * @property {string} name
 * @property {Settings} before      the settings to go back to
 * @property {Settings} of          those that it, or its answer, is about
 * @property {number | null} said   which answer was chosen; null while it is asked
 * @typedef {object} View           what is looked at: it is no part of a run, and a question leaves it as it is
 * @property {string} more          the group of the drawer that is open; empty while the drawer is closed
 * @property {string[]} charts      those below the first one
 * @property {string} chosen        the observer that arrows and sentence are about; empty for the first one
 * @property {boolean} side         whether the map is turned to the side
 * @property {number[] | null} sight  the part of the time that the hand has asked for
 * @typedef {object} Moment
 * @property {Settings} settings
 * @property {Question | null} question
 * @property {View} view
 */

const MOST_STEPS = 200;
/** Name of the step while a zoom may go on; no setting is called so. */
const LOOKING = "sight";

/** Settings with their history: one step is what a hand does from taking hold to letting go. */
export class State {
  constructor(settings, view = /** @type {any} */ ({})) {
    /** @type {Moment} */
    this.now = { settings, question: null, view };
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

  get view() {
    return this.now.view;
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

  /** Look at something else of the same settings; while a wheel turns it is one step, until seen(). */
  look(changes, going = false) {
    const view = { ...this.view, ...changes };
    if (going && this.held === LOOKING) this.now = { ...this.now, view };
    else this.step({ view });
    this.held = going ? LOOKING : null;
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

  /** Put others in the place of the present settings or view, which are impossible, or not looked at any more. */
  amend(changes) {
    this.now = { ...this.now, ...changes };
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
    const { more } = this.view;
    const now = /** @type {Moment} */ (from.pop());
    this.now = now.view.more === more ? now : { ...now, view: { ...now.view, more } };
    this.held = null;
    return true;
  }

  /** Ask a question, over the settings that it is about. */
  ask(name, settings) {
    const question = { name, before: this.before, of: settings, said: null };
    this.step({ settings, view: { ...this.view, sight: null }, question });
  }

  /** Answer it, over the settings that show whether the answer is right. */
  answer(said, settings) {
    if (this.question) this.step({ settings, question: { ...this.question, of: settings, said } });
  }

  /** Close the question, and go back to the settings before it. */
  leave() {
    this.step({ settings: this.before, question: null });
  }

  reset(settings, view = this.view) {
    this.cursor = null;
    this.step({ settings, view, question: null });
    this.release();
  }
}
