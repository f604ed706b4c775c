// The derivation desk: steps are filled in line by line, and Python says what it finds while somebody types.

import { same } from "../common/model/settings.js";
import { themeOf } from "../common/page/canvas.js";
import { LabBase } from "../common/page/lab_base.js";
import { build } from "./page/layout.js";
import { Panel, WORDS } from "./page/panel.js";
import { Sheet } from "./page/sheet.js";
import { Witness } from "./page/witness.js";

const DEBOUNCE = 20;
/** Milliseconds without typing after which a text that may not be complete is judged. */
const PAUSE = 1000;

export class DeskLab extends LabBase {
  constructor(widget, place, model) {
    super(widget, model, WORDS);
    this.calm = true;
    /** @type {any} the timer of what is told to Python next */
    this.telling = null;
    this.picture = new Witness(this);
    this.sheet = new Sheet(this);
    this.panel = new Panel(this);
    this.answer = { ...widget.get("analysis"), settings: this.settings };
    this.follow(build(this, place));
  }

  get figures() {
    return [this.picture];
  }

  // What the hand does.

  /** Take what stands in a line; hints on its step close, but for which lines are right. */
  type(key, text) {
    const { [key]: _old, ...others } = this.settings.typed;
    const typed = text ? { ...others, [key]: text } : others;
    const step = this.stepKey();
    const open = this.settings.hints[step] ?? 0;
    this.change({ typed, hints: open > 1 ? { ...this.settings.hints, [step]: 1 } : this.settings.hints });
  }

  stepKey() {
    return `${this.settings.part} ${this.answer?.step ?? this.settings.step}`;
  }

  openHint(number) {
    this.change({ hints: { ...this.settings.hints, [this.stepKey()]: number } }, true);
  }

  turnTo(step) {
    this.change({ step }, true);
  }

  clear() {
    this.change({ typed: {}, hints: {} }, true);
  }

  touched(chosen) {
    clearTimeout(this.telling);
    clearTimeout(this.resting);
    this.calm = chosen;
    if (chosen) {
      this.panel.show();
      this.rest();
    } else {
      this.resting = setTimeout(() => this.rest(), PAUSE);
      this.telling = setTimeout(() => this.tell(), DEBOUNCE);
    }
    this.schedule();
  }

  /** Nobody types any more: one step of the history ends, and what is not right may be said. */
  rest() {
    clearTimeout(this.resting);
    this.resting = null;
    this.state.release();
    this.calm = true;
    this.tell();
    this.schedule();
  }

  /** Tell Python what is there, unless it knows. */
  tell() {
    clearTimeout(this.telling);
    if (this.closed || this.link?.sent?.settings === this.settings) return;
    this.link?.send(this.settings, { serial: ++this.serial });
  }

  analysed(answer) {
    this.answer = answer;
    this.schedule();
  }

  // What is shown.

  /** Return true if Python's answer is about the text that stands in a line now. */
  isOf(key) {
    return this.answer?.settings.typed[key] === this.settings.typed[key];
  }

  paint() {
    this.pending = false;
    cancelAnimationFrame(this.frame);
    const { answer, settings } = this;
    const current = answer?.settings === settings;
    const sameSheet = ["student", "motion", "surface", "outputs", "observer", "part", "step"].every((name) =>
      same(answer?.settings[name], settings[name]),
    );
    this.theme ??= themeOf(this.view.root);
    this.shown = answer;
    this.view.problem(answer?.problem ?? "");
    this.view.show(answer, sameSheet);
    this.view.steps(this.state);
    if (sameSheet && !answer.problem) this.sheet.show(answer, current);
    this.picture.show(current ? answer : null, this.theme);
    if (current && this.calm) this.view.announce(this.sheet.told(answer));
  }
}
