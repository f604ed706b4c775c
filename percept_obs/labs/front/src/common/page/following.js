// What every page does: it follows the hand, keeps the way back, and tells Python.

import { schemaOf } from "../model/schema.js";
import { same } from "../model/settings.js";
import { State } from "../model/state.js";
import { Link } from "./link.js";
import { surround } from "./surroundings.js";

/**
 * Settings with their history, and the line to Python.  A page of its own gives it a view and figures, and says what
 * happens when settings are touched, when a picture is due, and when Python answers.
 */
export class Following {
  constructor(widget, model, words) {
    this.widget = widget;
    this.model = model;
    this.schema = schemaOf(model.schema, words);
    this.state = new State(structuredClone(widget.get("settings")));
    /** @type {any} */
    this.panel = this.view = null;
    /** @type {any} the result that is shown */
    this.shown = null;
    /** @type {Record<string, any> | null} what Python has answered, with the settings that it is about */
    this.answer = null;
    /** @type {Link | null} */
    this.link = null;
    /** @type {any} the colours that pictures are drawn in */
    this.theme = null;
    this.width = 800;
    this.serial = 0;
    this.frame = 0;
    this.pending = this.closed = false;
    /** @type {any} the timer that runs while the hand may go on */
    this.resting = null;
    this.leave = () => {};
  }

  get settings() {
    return this.state.settings;
  }

  /** Whether what is drawn is of settings before the present ones. */
  get late() {
    return false;
  }

  /** @returns {any[]} pictures, each with its figure */
  get figures() {
    return [];
  }

  /** Begin to follow, once the page is built: the hand, the page's size and theme, Python. */
  follow(view) {
    this.view = view;
    this.link = new Link(this.widget, {
      onSettings: (settings) => same(settings, this.settings) || this.replace(settings),
      onAnalysis: (analysis, settings) => this.analysed({ ...analysis, settings }),
      onError: (text) => this.view.pythonError(text),
      onSilence: (silence) => this.view.silence(silence),
    });
    this.leave = surround(this.view.root, {
      figures: this.figures.map(({ figure }) => figure),
      onSize: (node, size) => this.resized(node, size),
      onTheme: () => this.retheme(),
    });
    this.view.root.classList.toggle("alone", !this.widget.save_changes);
    this.panel.show();
    this.schedule();
    this.rest();
  }

  resized(node, size) {
    const picture = this.figures.find(({ figure }) => figure === node);
    if (picture) picture.size = size;
    else this.width = size.width;
    this.schedule();
  }

  retheme() {
    this.theme = null;
    this.schedule();
  }

  close() {
    this.closed = true;
    cancelAnimationFrame(this.frame);
    clearTimeout(this.resting);
    for (const control of this.panel?.controls ?? []) control.close?.();
    this.link?.close();
    this.leave();
  }

  // What the hand does.

  /** Take changed settings; what is chosen rather than moved is a step of its own, and told to Python at once. */
  change(changes, chosen = false) {
    if (chosen) this.state.step({ settings: { ...this.settings, ...changes } });
    else this.state.move(changes);
    this.touched(chosen);
  }

  /** Take whole settings, which Python has set. */
  replace(settings) {
    this.state.step({ settings: structuredClone(settings) });
    this.touched(true);
  }

  reset() {
    this.state.reset(structuredClone(this.model.opening));
    this.touched(true);
  }

  undo() {
    if (this.state.undo()) this.touched(true);
  }

  redo() {
    if (this.state.redo()) this.touched(true);
  }

  // What there is to do then.

  touched(_chosen) {}

  rest() {}

  analysed(_answer) {}

  paint() {}

  schedule() {
    if (this.pending || this.closed) return;
    this.pending = true;
    this.frame = requestAnimationFrame(() => this.pending && this.paint());
  }

  say(text) {
    this.view.say(text);
  }

  fail(error) {
    this.view.problem(error.message);
  }
}
