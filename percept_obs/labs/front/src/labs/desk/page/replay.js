// A line is typed once more, letter by letter: the play button, its clock, and the chart that one drags.

import { within } from "../../../engine/between.js";
import { button, element, setAttribute, svg } from "../../../draw/dom.js";
import { Misses } from "./misses.js";

/** Milliseconds that a line takes to be typed, however long it is, and those at rest before. */
const [TYPED_IN, BEFORE] = [5200, 800];
const LONGEST_STALL = 60;
const [PLAY, PAUSE] = ["M3 0l12 8-12 8z", "M2 1h4v14H2zM10 1h4v14h-4z"];

export class Replay {
  playing = false;
  /** @type {number | null} how many characters are shown; null for the line as it is */
  at = null;
  clock = 0;
  last = 0;
  frame = 0;

  constructor(lab) {
    this.lab = lab;
    this.still = window.matchMedia("(prefers-reduced-motion: reduce)");
    this.chart = new Misses((at) => this.put(at));
    this.press = button("", () => this.toggle(), { class: "play", "data-control": "first play" });
    this.sign = svg("path");
    this.press.append(svg("svg", { viewBox: "0 0 16 16", width: 16, height: 16, "aria-hidden": "true" }, this.sign));
    this.press.addEventListener("keydown", (event) => this.key(event));
    this.body = element("div", { class: "time" }, this.press, this.chart.figure);
  }

  /** The line that is shown: its text, and its beginnings that were judged. */
  get line() {
    const { key, text } = this.lab.shownLine();
    return { key, text, parts: this.lab.answer?.grown?.[key] ?? [] };
  }

  /** The last beginning that is complete where the line stands; null before the first. */
  get part() {
    const { at } = this;
    return at === null ? null : (this.line.parts.filter(({ end }) => end <= at).at(-1) ?? null);
  }

  /** Play once when the desk comes in sight, unless motion is not wanted or somebody has begun. */
  follow() {
    if (this.still.matches || !this.line.parts.length) return;
    this.at = 0;
    const seen = new IntersectionObserver((entries) => {
      if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
      seen.disconnect();
      if (this.at === 0) this.play();
    });
    seen.observe(this.lab.sheet.body);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    const { parts, text } = this.line;
    if (!parts.length) return;
    if (this.still.matches) {
      const next = parts.find(({ end }) => end > (this.at ?? text.length)) ?? parts[0];
      this.put(next.end);
      return;
    }
    if (this.at === null) this.at = 0;
    this.playing = true;
    this.clock = (this.at / text.length) * TYPED_IN - (this.at ? 0 : BEFORE);
    this.last = performance.now();
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => this.tick());
    this.lab.schedule();
  }

  pause() {
    this.playing = false;
    cancelAnimationFrame(this.frame);
    this.lab.schedule();
  }

  /** Show the line as it is. */
  stop() {
    if (this.at === null && !this.playing) return;
    this.at = null;
    this.pause();
  }

  tick() {
    const now = performance.now();
    this.clock += Math.min(now - this.last, LONGEST_STALL);
    this.last = now;
    const { text } = this.line;
    const at = Math.floor((Math.max(this.clock, 0) / TYPED_IN) * text.length);
    if (at >= text.length) {
      this.stop();
      return;
    }
    if (at !== this.at) {
      this.at = at;
      this.lab.schedule();
    }
    this.frame = requestAnimationFrame(() => this.tick());
  }

  put(at) {
    this.pause();
    const { text } = this.line;
    this.at = at >= text.length ? null : within(at, 0, text.length);
    this.lab.schedule();
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
    const { text } = this.line;
    if (step) this.put((this.at ?? text.length) + step);
    else if (event.key === "Home") this.put(0);
    else if (event.key === "End") this.put(text.length);
    else return;
    event.preventDefault();
  }

  show(theme) {
    const { text, parts } = this.line;
    this.body.hidden = !parts.length;
    if (this.body.hidden) return;
    this.chart.draw(text, parts, this.at ?? text.length, theme);
    setAttribute(this.sign, "d", this.playing ? PAUSE : PLAY);
    const word = this.playing ? "Pause" : "Play the typing of this line; arrow keys go through it";
    setAttribute(this.press, "aria-label", word);
  }
}
