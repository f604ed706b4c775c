// The questions of a first screen: one line, three answers, and the run that shows which of them is right.

import { same } from "../state/settings.js";
import { button, element } from "../draw/dom.js";

/** Questions in sight. */
const IN_SIGHT = 3;

/**
 * @typedef {object} Question  one line, answers, and the one thing that the answer points at
 * @property {string} name
 * @property {string} chip     its name on a button
 * @property {string} ask
 * @property {string[]} answers
 * @property {number} right
 * @property {(model: any) => any} before  settings that it is asked about
 * @property {(model: any) => any} after   settings that the answer shows, with a kept run to compare with
 * @property {string} [kept]  name of the kept run
 * @property {string} tells    the answer, of at most 25 words
 * @property {(scene: import("./screen.js").Scene) => boolean} holds  whether a result is as the answer claims
 * @property {"image" | "world" | "chart"} on
 * @property {string} note     at the thing pointed at
 * @property {(scene: import("./screen.js").Scene) => any} spot  where that is, as the picture takes it
 */

/** The strip of questions.  Which one is open, and what was said, are part of the lab's state. */
export class Questions {
  /** What the strip shows, in a word. */
  shown = "";

  /**
   * @param {import("./clock.js").Clock} clock
   * @param {() => void} turned  called before another question is asked, and after one is done
   */
  constructor(lab, clock, /** @type {Question[]} */ questions, turned) {
    this.lab = lab;
    this.clock = clock;
    this.all = questions;
    this.turned = turned;
    this.queue = questions.map(({ name }) => name);
    this.strip = element("div", { class: "strip", role: "group", "aria-label": "Questions" });
  }

  named(name) {
    return /** @type {Question} */ (this.all.find((question) => question.name === name));
  }

  /** The question that is open, if one is. */
  get open() {
    const { question } = this.lab.state;
    return question ? this.named(question.name) : undefined;
  }

  /** True while an answer is waited for. */
  get asking() {
    return Boolean(this.open) && this.lab.state.question.said === null;
  }

  /** True where the answer is about what is shown. */
  get answered() {
    const { question } = this.lab.state;
    return Boolean(this.open) && question.said !== null && same(question.of, this.lab.settings);
  }

  /** True once the answer was watched, and is what is drawn. */
  get telling() {
    return this.answered && !this.clock.secret && !this.lab.late;
  }

  ask(name) {
    const { lab } = this;
    this.clock.pause();
    this.turned();
    this.clock.rewind();
    lab.state.ask(name, this.named(name).before(lab.model));
    lab.touched(true);
    this.focus();
  }

  answer(said) {
    const { lab, open } = this;
    // A step back may have closed the question whose buttons are still there.
    if (!open || !this.asking) return;
    lab.state.answer(said, open.after(lab.model));
    this.clock.rewind(true);
    lab.touched(true);
  }

  done() {
    const { lab, open } = this;
    if (!open) return;
    const { name } = open;
    this.queue = [...this.queue.filter((other) => other !== name), name];
    this.turned();
    lab.goBack();
    this.clock.finish();
    this.focus();
  }

  focus() {
    this.strip.querySelector("button")?.focus({ preventScroll: true });
  }

  /** Bring the row of buttons to the question that is open. */
  show() {
    const { open, lab } = this;
    const { said = null } = open ? lab.state.question : {};
    const now = [open?.name, said, ...this.queue].join();
    if (now === this.shown) return;
    this.shown = now;
    const inside = this.strip.contains(document.activeElement);
    const chip = (name) => {
      const { chip: text } = this.named(name);
      return button(text, () => this.ask(name), { "data-control": `question ${name}` });
    };
    const choice = (text, k) => {
      const right = said !== null && k === /** @type {Question} */ (open).right;
      const pressed = { "aria-pressed": String(k === said), class: right ? "right" : "" };
      return button(text, () => said === null && this.answer(k), { "data-control": `answer ${k}`, ...pressed });
    };
    const close = () => button("Done", () => this.done(), { class: "link", "data-control": "done" });
    const chips = this.queue.slice(0, IN_SIGHT).map(chip);
    this.strip.replaceChildren(...(open ? [...open.answers.map(choice), close()] : chips));
    if (inside) this.focus();
  }

  /** The open question's line, its answer once it was watched, or nothing where the result is no answer. */
  sentence(scene) {
    const { open } = this;
    if (open && this.asking) return open.ask;
    if (!open || !this.answered) return "";
    if (!this.telling) return "Watch …";
    return open.holds(scene) ? open.tells : "";
  }

  /** Return what an answer that was watched points at in a picture, or null. */
  note(name, scene) {
    const { open } = this;
    return open && this.telling && open.on === name ? { ...open.spot(scene), text: open.note } : null;
  }
}
