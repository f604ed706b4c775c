// Play, pause, scrub and speed: the one time that image, scene and charts show.

import { advanced, begun, SPEEDS, stepped } from "../engine/between.js";
import { readable } from "../draw/scales.js";
import { button, element, setText } from "../ui/dom.js";

const FINEST = 1e-3;
/** After a stall play goes on from where it was, instead of leaping. */
const LONGEST_STALL = 0.1;
const STEPS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -5, PageUp: 5 };
const ZOOMS = {
  "-": ["−", "Show more of the time", "zoom out"],
  "+": ["+", "Show less of the time", "zoom in"],
  0: ["⟷", "Show all of the time", "zoom whole"],
};
const KEYS = { "=": "+", _: "-" };

/** The bar below the charts; it moves the time of a lab, which only draws what it has computed. */
export class Player {
  constructor(lab) {
    this.lab = lab;
    this.playing = false;
    this.last = 0;
    this.frame = 0;
    this.still = window.matchMedia("(prefers-reduced-motion: reduce)");
    this.press = button("", () => this.toggle(), { class: "play", "data-control": "play" });
    this.slider = element("input", {
      ...{ type: "range", min: 0, max: 1, step: FINEST, value: 0, "data-control": "cursor", "aria-label": "Time" },
      oninput: () => this.put(this.span.low + Number(this.slider.value) * (this.span.high - this.span.low)),
    });
    const speeds = SPEEDS.map((speed) => element("option", { value: speed, selected: speed === 1 }, `${speed}×`));
    this.speed = element("select", { class: "speed", "data-control": "speed", "aria-label": "Speed" }, ...speeds);
    this.now = element("output", {});
    const zooms = Object.entries(ZOOMS).map(([key, [sign, words, name]]) =>
      button(sign, () => this.zoom(key), {
        ...{ class: "zoom", "data-control": name, "aria-label": words, title: `${words} (${key})` },
      }),
    );
    const parts = [this.press, this.slider, this.now, this.speed, element("span", { class: "zooms" }, ...zooms)];
    this.body = element("div", { class: "player", role: "group", "aria-label": "Time" }, ...parts);
    this.body.addEventListener("keydown", (event) => this.key(event));
    this.still.addEventListener("change", () => this.pause());
    this.label();
  }

  get span() {
    return this.lab.span;
  }

  key(event) {
    if (event.target === this.speed) return;
    const zoom = KEYS[event.key] ?? event.key;
    const step = STEPS[event.key] * (event.shiftKey ? 0.1 : 1);
    if (event.key === " " && event.target !== this.press) this.toggle();
    else if (step) this.put(stepped(this.lab.state.cursor, this.span, step));
    else if (event.key === "Home") this.put(this.span.low);
    else if (event.key === "End") this.put(this.span.high);
    else if (ZOOMS[zoom]) this.zoom(zoom);
    else return;
    event.preventDefault();
  }

  /** Show less or more of the time about the present one, or all of it. */
  zoom(key) {
    const about = this.lab.state.cursor ?? this.span.low;
    this.lab.zoom((timeline) => {
      if (key === "0") timeline.select(timeline.whole);
      else timeline.zoom(key === "+" ? 0.5 : 2, about);
    });
  }

  /** Show a time that the hand asks for, which ends play. */
  put(time) {
    this.pause();
    this.lab.point(time);
    // The next key begins where this one leads, though the picture comes later.
    this.show(this.lab.state.cursor);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    const { lab } = this;
    if (!lab.span) return;
    const begin = begun(lab.state.cursor, lab.span);
    if (this.still.matches) {
      // Nothing moves by itself: each press is a step.
      lab.point(begin === lab.state.cursor ? stepped(begin, lab.span, 1) : begin);
      return;
    }
    this.playing = true;
    this.last = performance.now();
    lab.point(begin);
    this.label();
    this.frame = requestAnimationFrame(() => this.tick());
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    cancelAnimationFrame(this.frame);
    this.label();
    this.lab.redraw();
  }

  tick() {
    const now = performance.now();
    const seconds = Math.min((now - this.last) / 1000, LONGEST_STALL);
    this.last = now;
    const from = this.lab.state.cursor ?? -Infinity;
    const { time, playing } = advanced(from, this.span, Number(this.speed.value), seconds);
    this.lab.point(time);
    this.lab.paint();
    if (playing && this.playing) this.frame = requestAnimationFrame(() => this.tick());
    else this.pause();
  }

  label() {
    const [sign, words] = this.still.matches ? ["▸|", "Step"] : this.playing ? ["❚❚", "Pause"] : ["▶", "Play"];
    this.press.textContent = sign;
    this.press.setAttribute("aria-label", words);
    this.press.title = `${words} (space)`;
  }

  /** Bring the bar to the time that is shown. */
  show(cursor) {
    this.body.hidden = cursor === null;
    if (cursor === null) return;
    const { low, high } = this.span;
    const share = Math.round((cursor - low) / (high - low) / FINEST) * FINEST;
    if (Math.abs(Number(this.slider.value) - share) > FINEST / 2) this.slider.value = String(share);
    const text = `${cursor.toFixed(Math.max(0, 2 - Math.floor(Math.log10(high - low))))} s`;
    if (this.now.textContent === text) return;
    setText(this.now, text);
    this.slider.setAttribute("aria-valuetext", `${text}, of ${readable(low)} to ${readable(high)} s`);
  }
}
