// The time of a lab: play from start to end once, pause, step, and a button that says which.

import { within } from "../engine/between.js";
import { button, setAttribute, svg } from "../draw/dom.js";

/** Seconds that the part in sight takes to watch, however long it is; and parts into which the arrow keys divide it. */
const [SHOWN_FOR, PARTS] = [6, 40];
/** Milliseconds to read the first sentence in. */
const FIRST_LOOK = 1000;
/** Milliseconds after which play goes on from where it was, instead of leaping. */
export const LONGEST_STALL = 60;
const [PLAY, PAUSE, STEP] = ["M3 0l12 8-12 8z", "M2 1h4v14H2zM10 1h4v14h-4z", "M2 1l8 7-8 7zM11 1h3v14h-3z"];
const STEPS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -5, PageUp: 5 };
const ZOOMS = { "+": 0.5, "=": 0.5, "-": 2, _: 2 };

/** The time that a lab shows.  What the estimate will do is secret until it was played once. */
export class Clock {
  secret = true;
  playing = false;
  /** True where play is to begin once the result is there. */
  waiting = false;
  /** Milliseconds before the first play. */
  firstLook = FIRST_LOOK;
  /** True once somebody could see it. */
  begun = false;
  last = 0;
  frame = 0;
  /** Timer of the first play. */
  beginner = 0;

  /** @param {() => boolean} stopped  whether time stands still, as it does while an answer is waited for */
  constructor(lab, stopped) {
    this.lab = lab;
    this.stopped = stopped;
    this.still = window.matchMedia("(prefers-reduced-motion: reduce)");
    const named = { class: "play", "data-control": "play", "aria-label": "Play" };
    this.press = button("", () => this.toggle(), named);
    this.sign = svg("path", { d: PLAY });
    this.press.append(svg("svg", { viewBox: "0 0 16 16", width: 16, height: 16, "aria-hidden": "true" }, this.sign));
    this.press.addEventListener("keydown", (event) => this.key(event));
  }

  get start() {
    return this.lab.span.low;
  }

  get end() {
    return this.lab.span.high;
  }

  /** The time that is shown. */
  present() {
    return within(this.lab.state.cursor ?? this.start, this.start, this.end);
  }

  /** Play for the first time, if nothing else has begun by then. */
  begin(wanted) {
    this.begun = true;
    this.lab.redraw();
    if (this.still.matches) this.finish();
    else this.beginner = setTimeout(() => wanted() && this.play(), this.firstLook);
  }

  /** Go back to the start of a run that nobody has seen; play once it is there, if it is known to come. */
  rewind(waiting = false) {
    this.lab.state.cursor = null;
    this.secret = true;
    this.waiting = waiting;
  }

  put(time) {
    if (this.stopped()) return;
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
    if (this.stopped() || !(this.end > this.start)) return;
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

  /** Follow a result that has just come. */
  follow() {
    const { lab } = this;
    if (lab.late) return;
    if (this.waiting) {
      this.waiting = false;
      if (this.still.matches) this.finish();
      else this.play();
    }
    const now = this.present();
    if (!(lab.state.cursor <= now && lab.state.cursor >= now)) lab.state.cursor = now;
  }

  key(event) {
    const step = STEPS[event.key];
    const factor = ZOOMS[event.key];
    if (step) this.put(this.present() + (step * (this.end - this.start)) / PARTS);
    else if (event.key === "Home") this.put(this.start);
    else if (event.key === "End") this.put(this.end);
    else if (factor) this.lab.zoom(factor, this.present());
    else if (event.key === "0") this.lab.showAll();
    else return;
    event.preventDefault();
  }

  /** Say on the button what a press does. */
  show() {
    const [sign, word] = this.still.matches ? [STEP, "Step"] : this.playing ? [PAUSE, "Pause"] : [PLAY, "Play"];
    setAttribute(this.sign, "d", sign);
    // A time that runs would be read aloud again and again.
    const at = this.playing ? "" : `, ${this.present().toFixed(1)} of ${this.end.toFixed(1)} s`;
    setAttribute(this.press, "aria-label", `${word}${at}; arrow keys move the time, plus and minus zoom`);
    this.press.disabled = this.stopped();
  }
}
