// Moving what is not seen: a copy of the point swings along the direction that the measurements do not tell.

import { button } from "../ui/dom.js";
import { pointMark } from "../draw/marks.js";

/** Swings in a second, and the part of one that a step is where nothing may move by itself. */
const RATE = 0.4;
const STEP = 1 / 8;

/** A button on the scene, and how far the copy has swung: between -1 and 1, or null while nothing swings. */
export class Swing {
  constructor(lab) {
    this.lab = lab;
    /** @type {number | null} */
    this.amount = null;
    this.phase = 0;
    this.still = window.matchMedia("(prefers-reduced-motion: reduce)");
    this.press = button("Move what is not seen", () => this.toggle(), {
      ...{ class: "swing", hidden: true, "data-control": "swing", "aria-pressed": "false" },
    });
  }

  toggle() {
    const still = this.still.matches;
    const moving = this.amount !== null && !still;
    this.phase = still ? this.phase + STEP : 0;
    this.set(moving ? null : Math.sin(2 * Math.PI * this.phase));
    if (this.amount !== null && !still) this.tick(performance.now());
  }

  set(amount) {
    this.amount = amount;
    this.press.setAttribute("aria-pressed", String(amount !== null));
    this.lab.redraw();
  }

  tick(before) {
    requestAnimationFrame(() => {
      if (this.amount === null || this.lab.closed) return;
      const now = performance.now();
      this.phase += (RATE * (now - before)) / 1000;
      this.set(Math.sin(2 * Math.PI * this.phase));
      this.tick(now);
    });
  }

  /** Show the button where there is something that is not seen. */
  show(unseen) {
    this.press.hidden = !unseen;
    if (!unseen && this.amount !== null) this.set(null);
  }
}

/** The copies on a picture, at the places that `on` returns. */
export function drawSwung(pen, { copies }, on, theme) {
  for (const copy of copies) {
    const [left, top] = on(copy);
    pen.globalAlpha = 0.75;
    pointMark(pen, left, top, copy.colour, theme);
    pen.globalAlpha = 1;
  }
}
