// The first screen of a lab: two pictures of one time, a chart to move it, one sentence, and questions.

import { between } from "../engine/between.js";
import { button, element, setAttribute, setText } from "./dom.js";
import { Handle } from "../draw/handle.js";
import { TimeChart } from "../draw/chart.js";
import { Clock, LONGEST_STALL } from "./clock.js";
import { Questions } from "./questions.js";
import { View } from "../draw/view.js";

/** Letters from which on a sentence is written smaller. */
const LONG = 64;
/** Milliseconds of rest after which a sentence is read out. */
const SPOKEN_AFTER = 500;

/**
 * @typedef {object} Scene     what is shown
 * @property {any} shown       the result
 * @property {any} ghost       the result of the kept run, or null
 * @property {string} kept     its name
 * @property {number} now      time in seconds
 * @property {number} end      last time
 * @property {{sample: number, part: number}} at  place of the time between samples
 * @property {boolean} why     whether the copies at other distances are shown
 * @property {boolean} secret  whether the future of the estimate is hidden
 * @property {any} theme
 * @property {any} [body]      what a lab has read off the result for this time
 * @property {any} [worlds]    that make what is seen, of a lab that looks at several
 */

/**
 * The first screen of a lab.  A screen of its own draws `drawImage(scene)` and `drawWorld(scene)`, says what the chart
 * holds in `chartOf(scene)` and what is seen in `sentence(scene)`, and puts handles into the pictures.
 */
export class FirstScreen {
  /** @type {Handle[]} */
  handles = [];
  why = false;
  /** True once the hand has changed something. */
  moved = false;
  drawn = 0;
  /** @type {Scene | null} the last one that was drawn */
  scene = null;
  spoken = "";
  /** Timer of the sentence that is read out. */
  timer = 0;

  /** @param {{image: string, world: string, axis: string, why?: boolean}} captions */
  constructor(lab, captions, controls, /** @type {import("./questions.js").Question[]} */ questions) {
    this.lab = lab;
    this.controls = controls;
    this.clock = new Clock(lab, () => this.questions.asking);
    this.questions = new Questions(lab, this.clock, questions, () => this.turned());
    this.image = new View("image", captions.image, captions.image);
    this.world = new View("world", captions.world, captions.world, true);
    this.chart = new TimeChart(captions.axis, (time) => this.clock.put(time));
    this.says = element("p", { class: "says" });
    this.aloud = element("p", { class: "unseen", role: "status" });
    this.whyButton = button("Why?", () => this.setWhy(!this.why), {
      ...{ class: "why-button", "data-control": "why", "aria-pressed": "false", hidden: captions.why === false },
    });
    this.image.figure.append(this.whyButton);
    const again = { class: "again", "data-control": "again", hidden: true };
    this.resetButton = button("Start again", () => this.again(), again);
    this.world.figure.append(this.resetButton);
    const other = button("Workbench", () => lab.turn("workbench"), { class: "link", "data-control": "workbench" });
    this.body = element(
      "section",
      { class: "first-screen", "aria-label": "First screen" },
      element("div", { class: "heading" }, this.says, this.aloud, this.questions.strip),
      element("div", { class: "views" }, this.image.figure, this.world.figure),
      element("div", { class: "time" }, this.clock.press, this.chart.figure),
      element("div", { class: "handy" }, ...controls.map(({ row }) => row), other),
    );
    for (const { figure } of [this.image, this.world]) {
      figure.addEventListener("pointerdown", (event) => event.target.closest("button") || this.clock.pause());
    }
  }

  get views() {
    return [this.image, this.world, this.chart];
  }

  /** Begin to play once the screen is in sight. */
  follow() {
    const seen = new IntersectionObserver((entries) => {
      if (!entries.some(({ isIntersecting }) => isIntersecting) || this.clock.begun) return;
      seen.disconnect();
      this.clock.begin(() => !this.moved && !this.questions.open);
    });
    seen.observe(this.body);
    this.leave = () => seen.disconnect();
  }

  close() {
    this.clock.pause();
    clearTimeout(this.timer);
    this.leave?.();
  }

  /** Put a handle into a picture; `onMove` takes its place in the picture's own coordinates. */
  handle(view, { name, label, onMove, ...more }) {
    const made = new Handle({
      ...{ name, label: `${label}: drag it, or use the arrow keys`, className: "grip", ...more },
      onMove: (place) => {
        this.touch();
        onMove(place);
      },
      onRest: () => this.lab.rest(),
    });
    view.figure.append(made.node);
    this.handles.push(made);
    return made;
  }

  /** The hand has changed something: nothing is secret any more. */
  touch() {
    this.moved = true;
    this.clock.secret = false;
    this.clock.waiting = false;
  }

  /** Take changes, and show from the start what they do. */
  replay(changes) {
    this.clock.pause();
    this.moved = true;
    this.clock.rewind(true);
    this.lab.change(changes, true);
  }

  /** Forget what is not in the settings, for they are about something else now. */
  renew() {}

  turned() {
    this.setWhy(false);
    this.renew();
  }

  again() {
    this.turned();
    this.moved = false;
    this.clock.secret = this.clock.waiting = true;
    this.lab.reset();
  }

  setWhy(on) {
    this.why = on;
    setAttribute(this.whyButton, "aria-pressed", String(on));
    this.lab.redraw();
  }

  /** Draw what is shown, as one scene. */
  draw(shown, ghost, theme) {
    const { lab, clock, questions, why } = this;
    // Nobody sees a lab that is folded away; it is drawn when it has a size again.
    if (this.views.some((view) => !view.measure())) return;
    clock.follow();
    const [now, { end, secret }] = [clock.present(), clock];
    const kept = (questions.answered && questions.open?.kept) || "kept run";
    const scene = { shown, ghost, kept, now, end, at: between(shown.time, now), why, secret, theme };
    const stamp = performance.now();
    const passed = Math.min(stamp - this.drawn, LONGEST_STALL);
    const motion = { held: lab.held, still: clock.still.matches, passed };
    this.drawn = stamp;
    this.scene = scene;
    const noteOn = (name) => questions.note(name, scene);
    this.resetButton.hidden = !this.moved || Boolean(questions.open);
    const late = [
      this.drawImage(scene, motion, noteOn("image")),
      this.drawWorld(scene, motion, noteOn("world")),
      this.chart.draw({ ...this.chartOf(scene), note: noteOn("chart") }, now, theme, motion),
    ];
    questions.show();
    this.say(questions.sentence(scene) || this.sentence(scene));
    clock.show();
    for (const control of this.controls) control.show();
    // A view on its way is drawn once more.
    if (late.some(Boolean)) lab.redraw();
  }

  /** Say one sentence; who does not see it hears it when it stays. */
  say(text) {
    if (text === this.spoken) return;
    this.spoken = text;
    setText(this.says, text);
    this.says.classList.toggle("long", text.length > LONG);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => setText(this.aloud, text), SPOKEN_AFTER);
  }

  describe() {
    const { spoken } = this;
    for (const view of this.views) view.tell(spoken);
    for (const handle of this.handles) handle.describe();
  }

  /** @returns {boolean} true while the view is on its way */
  drawImage(/** @type {Scene} */ _scene, _motion, _note) {
    throw new Error("a lab draws its image");
  }

  /** @returns {boolean} */
  drawWorld(/** @type {Scene} */ _scene, _motion, _note) {
    throw new Error("a lab draws its world");
  }

  /** @returns {import("../draw/chart.js").Chart} */
  chartOf(/** @type {Scene} */ _scene) {
    throw new Error("a lab says what its chart holds");
  }

  /** @returns {string} */
  sentence(/** @type {Scene} */ _scene) {
    throw new Error("a lab says what is seen");
  }
}
