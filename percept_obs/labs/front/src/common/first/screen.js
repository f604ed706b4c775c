// The first screen of a lab: two pictures of one time, a chart to move it, one sentence, and questions.

import { between, within } from "../model/playback.js";
import { same } from "../model/settings.js";
import { button, element, setAttribute, setText, svg } from "../page/dom.js";
import { Handle } from "../page/handle.js";
import { TimeChart } from "./chart.js";
import { View } from "./view.js";

/** Seconds that a run takes to watch, however long it is; and milliseconds to read the first sentence in. */
const [SHOWN_FOR, FIRST_LOOK] = [6, 1000];
/** Questions in sight, and parts into which the arrow keys divide the time. */
const [IN_SIGHT, PARTS] = [3, 40];
const LONGEST_STALL = 60;
/** Letters from which on a sentence is written smaller. */
const LONG = 64;
/** Milliseconds of rest after which a sentence is read out. */
const SPOKEN_AFTER = 500;
const [PLAY, PAUSE, STEP] = ["M3 0l12 8-12 8z", "M2 1h4v14H2zM10 1h4v14h-4z", "M2 1l8 7-8 7zM11 1h3v14h-3z"];

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
 * @property {(scene: Scene) => boolean} holds  whether a result is as the answer claims
 * @property {"image" | "world" | "chart"} on
 * @property {string} note     at the thing pointed at
 * @property {(scene: Scene) => any} spot  where that is, as the picture takes it
 *
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
  /** True until the run was seen once: what the estimate will do is not given away. */
  secret = true;
  playing = false;
  /** True where play is to begin once the result is there. */
  waiting = false;
  /** True once the hand has changed something. */
  moved = false;
  last = 0;
  frame = 0;
  begun = false;
  /** Timer of the first play. */
  beginner = 0;
  /** Milliseconds before it plays. */
  firstLook = FIRST_LOOK;

  /** @param {{image: string, world: string, axis: string, why?: boolean}} captions */
  constructor(lab, captions, controls, /** @type {Question[]} */ questions) {
    this.lab = lab;
    this.questions = questions;
    this.controls = controls;
    this.queue = questions.map(({ name }) => name);
    this.still = window.matchMedia("(prefers-reduced-motion: reduce)");
    this.image = new View("image", captions.image, captions.image);
    this.world = new View("world", captions.world, captions.world, true);
    this.chart = new TimeChart(captions.axis, (time) => this.put(time));
    this.says = element("p", { class: "says" });
    this.aloud = element("p", { class: "unseen", role: "status" });
    this.strip = element("div", { class: "strip", role: "group", "aria-label": "Questions" });
    this.press = button("", () => this.toggle(), { class: "play", "data-control": "first play" });
    this.sign = svg("path");
    this.press.append(svg("svg", { viewBox: "0 0 16 16", width: 16, height: 16, "aria-hidden": "true" }, this.sign));
    this.press.addEventListener("keydown", (event) => this.key(event));
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
      element("div", { class: "heading" }, this.says, this.aloud, this.strip),
      element("div", { class: "views" }, this.image.figure, this.world.figure),
      element("div", { class: "time" }, this.press, this.chart.figure),
      element("div", { class: "handy" }, ...controls.map(({ row }) => row), other),
    );
    for (const { figure } of [this.image, this.world]) {
      figure.addEventListener("pointerdown", (event) => event.target.closest("button") || this.pause());
    }
    this.key_ = "";
    this.spoken = "";
    this.timer = 0;
  }

  get views() {
    return [this.image, this.world, this.chart];
  }

  /** Begin to play once the screen is in sight. */
  follow() {
    const seen = new IntersectionObserver((entries) => {
      if (!entries.some(({ isIntersecting }) => isIntersecting) || this.begun) return;
      this.begun = true;
      seen.disconnect();
      this.lab.redraw();
      if (this.still.matches) this.finish();
      else this.beginner = setTimeout(() => this.moved || this.open !== undefined || this.play(), this.firstLook);
    });
    seen.observe(this.body);
    this.leave = () => seen.disconnect();
  }

  close() {
    this.pause();
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
    this.secret = false;
    this.waiting = false;
  }

  /** Take changes, and show from the start what they do. */
  replay(changes) {
    this.pause();
    this.moved = this.secret = this.waiting = true;
    this.lab.state.cursor = null;
    this.lab.change(changes, true);
  }

  // Time.

  get end() {
    const { shown } = this.lab;
    return shown?.time?.length ? shown.time[shown.time.length - 1] : 0;
  }

  get start() {
    return this.lab.shown?.time?.[0] ?? 0;
  }

  /** The time that is shown. */
  present() {
    return within(this.lab.state.cursor ?? this.start, this.start, this.end);
  }

  put(time) {
    if (this.asking) return;
    this.pause();
    this.lab.point(within(time, this.start, this.end));
  }

  /** Show the end of the run, as if it had been played. */
  finish() {
    this.pause();
    this.secret = false;
    // The run may not be there yet, or be longer than the last one.
    this.lab.state.cursor = Infinity;
    this.lab.schedule();
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    if (this.asking || !(this.end > this.start)) return;
    if (this.present() >= this.end - 1e-9) this.lab.point(this.start);
    if (this.still.matches) {
      this.lab.point(Math.min(this.present() + (this.end - this.start) / 8, this.end));
      return;
    }
    this.playing = true;
    this.last = performance.now();
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => this.tick());
    this.lab.redraw();
  }

  pause() {
    this.waiting = false;
    clearTimeout(this.beginner);
    if (!this.playing) return;
    this.playing = false;
    cancelAnimationFrame(this.frame);
    this.lab.redraw();
  }

  tick() {
    const now = performance.now();
    const passed = Math.min(now - this.last, LONGEST_STALL);
    this.last = now;
    const time = this.present() + ((passed / 1000) * (this.end - this.start)) / SHOWN_FOR;
    this.lab.point(Math.min(time, this.end));
    if (time >= this.end) {
      this.playing = this.secret = false;
      this.lab.redraw();
      return;
    }
    this.lab.paint();
    this.frame = requestAnimationFrame(() => this.tick());
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -5, PageUp: 5 }[event.key];
    if (step) this.put(this.present() + (step * (this.end - this.start)) / PARTS);
    else if (event.key === "Home") this.put(this.start);
    else if (event.key === "End") this.put(this.end);
    else return;
    event.preventDefault();
  }

  /** Forget what is not in the settings, for they are about something else now. */
  renew() {}

  again() {
    this.renew();
    this.moved = false;
    this.secret = this.waiting = true;
    this.setWhy(false);
    this.lab.reset();
  }

  // Questions.

  /** The question that is open, if one is. */
  get open() {
    return this.questions.find(({ name }) => name === this.lab.state.question?.name);
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

  /** True once the answer was watched. */
  get telling() {
    return this.answered && !this.secret;
  }

  question(name) {
    return /** @type {Question} */ (this.questions.find((question) => question.name === name));
  }

  ask(name) {
    const { lab } = this;
    this.pause();
    this.setWhy(false);
    this.renew();
    this.secret = true;
    lab.state.cursor = null;
    lab.state.ask(name, this.question(name).before(lab.model));
    lab.touched(true);
    this.strip.querySelector("button")?.focus({ preventScroll: true });
  }

  answer(said) {
    const { lab, open } = this;
    // A step back may have closed the question whose buttons are still there.
    if (!open || !this.asking) return;
    lab.state.answer(said, open.after(lab.model));
    lab.state.cursor = null;
    this.secret = true;
    this.waiting = true;
    lab.touched(true);
  }

  done() {
    const { lab, open } = this;
    if (!open) return;
    const { name } = open;
    this.queue = [...this.queue.filter((other) => other !== name), name];
    this.renew();
    lab.goBack();
    this.finish();
    this.strip.querySelector("button")?.focus({ preventScroll: true });
  }

  /** Bring the row of buttons to the question that is open. */
  showStrip() {
    const { open, lab } = this;
    const { said = null } = open ? lab.state.question : {};
    const key = [open?.name, said, ...this.queue].join();
    if (key === this.key_) return;
    const inside = this.strip.contains(document.activeElement);
    this.key_ = key;
    const chip = (name) => {
      const { chip: text } = this.question(name);
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
    if (inside) this.strip.querySelector("button")?.focus({ preventScroll: true });
  }

  setWhy(on) {
    this.why = on;
    setAttribute(this.whyButton, "aria-pressed", String(on));
    this.lab.redraw();
  }

  // Pictures.

  /** Draw what is shown, as one scene. */
  draw(shown, ghost, theme) {
    const { lab } = this;
    // Nobody sees a lab that is folded away; it is drawn when it has a size again.
    if (this.views.some((view) => !view.measure())) return;
    if (this.waiting && !lab.late) {
      this.waiting = false;
      if (this.still.matches) this.finish();
      else this.play();
    }
    const now = this.present();
    if (!lab.late && !(lab.state.cursor <= now)) lab.state.cursor = now;
    const { why, secret, end } = this;
    const kept = (this.answered && this.open?.kept) || "kept run";
    const scene = { shown, ghost, kept, now, end, at: between(shown.time, now), why, secret, theme };
    const stamp = performance.now();
    const motion = { held: lab.held, still: this.still.matches, passed: Math.min(stamp - this.drawn, LONGEST_STALL) };
    this.drawn = stamp;
    this.scene = scene;
    const question = this.telling ? this.open : null;
    const noteOf = (/** @type {Question} */ { spot, note }) => ({ ...spot(scene), text: note });
    const noteOn = (name) => (question && question.on === name ? noteOf(question) : null);
    this.resetButton.hidden = !this.moved || Boolean(this.open);
    const late = [
      this.drawImage(scene, motion, noteOn("image")),
      this.drawWorld(scene, motion, noteOn("world")),
      this.chart.draw({ ...this.chartOf(scene), note: noteOn("chart") }, now, theme, motion),
    ];
    this.showStrip();
    this.say(this.sentenceNow(scene));
    this.label(now);
    for (const control of this.controls) control.show();
    // A view on its way is drawn once more.
    if (late.some(Boolean)) lab.redraw();
  }

  drawn = 0;
  /** @type {Scene | null} the last one that was drawn */
  scene = null;

  sentenceNow(scene) {
    const { open } = this;
    if (open && this.asking) return open.ask;
    if (open && this.answered) {
      if (!this.telling) return "Watch …";
      if (open.holds(scene)) return open.tells;
    }
    return this.sentence(scene);
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

  label(now) {
    const [sign, word] = this.still.matches ? [STEP, "Step"] : this.playing ? [PAUSE, "Pause"] : [PLAY, "Play"];
    setAttribute(this.sign, "d", sign);
    const text = `${word}, ${now.toFixed(1)} of ${this.end.toFixed(1)} s; arrow keys move the time`;
    if (!this.playing) setAttribute(this.press, "aria-label", text);
    this.press.disabled = this.asking;
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

  /** @returns {import("./chart.js").Chart} */
  chartOf(/** @type {Scene} */ _scene) {
    throw new Error("a lab says what its chart holds");
  }

  /** @returns {string} */
  sentence(/** @type {Scene} */ _scene) {
    throw new Error("a lab says what is seen");
  }
}
