// A picture of the first screen.  What is written in it never overlaps and is never cut: labels look for a free place.

import { same } from "../model/settings.js";
import { Picture } from "../page/canvas.js";
import { element } from "../page/dom.js";
import { arrowMark, disc, ring, stroke } from "../page/marks.js";

/** Places around a thing, and how far off a label looks for one; from the second on with a leader to its thing. */
const SIDES = [[1, 0], [-1, 0], [0, -1], [0, 1], [1, -1], [-1, -1], [1, 1], [-1, 1]];
const OFF = [0, 16, 34];
/** Half the height of a line of letters, and the room at a picture's rim. */
const [HALF, RIM] = [8, 4];
/** Milliseconds in which a view comes most of the way to where it should be. */
const GLIDE = 90;
const HATCH = 8;

/**
 * @typedef {object} Label
 * @property {string} id       by which it stays on the side where it was
 * @property {string} text
 * @property {number[]} at     pixels of the thing that it names
 * @property {string} colour
 * @property {number} rank     0 finds its place first
 * @property {number} [gap]    pixels from the thing's middle to its rim
 * @property {number[]} [towards]  direction of the side that is tried first
 */

export class View extends Picture {
  /** @param {string} caption  that stands in a lower corner; nothing is drawn over it */
  constructor(name, label, caption = "", right = false) {
    super(`view ${name}`, label);
    /** @type {number[] | null} numbers that say what part of its world is seen */
    this.at = null;
    /** @type {Map<string, number>} */
    this.places = new Map();
    /** @type {{text: string, box: number[]}[]} what was written, with left, top, right, bottom */
    this.texts = [];
    /** @type {number[][]} boxes in which no label may stand */
    this.taken = [];
    /** @type {Label[]} */
    this.labels = [];
    this.caption = caption ? element("figcaption", { class: right ? "right" : "" }, caption) : null;
    if (this.caption) this.figure.append(this.caption);
    /** @type {{x: number, y: number, text: string} | null} */
    this.pointed = null;
    this.width = this.height = 0;
    this.theme = /** @type {any} */ (null);
  }

  /** Begin a picture: an empty canvas, in which captions and buttons have their places already. */
  begin(theme) {
    const { width, height } = this.fit(theme.font);
    Object.assign(this, { width, height, theme, texts: [], taken: [], labels: [], pointed: null });
    this.context.lineCap = "round";
    if (!this.caption) return;
    const right = this.caption.className === "right";
    const wide = 7 * (this.caption.textContent ?? "").length + 16;
    this.taken.push(right ? [width - wide, height - 28, width, height] : [0, height - 28, wide, height]);
  }

  /** Come nearer to a goal, unless a hand is at work; return true while it is still on the way. */
  glide(goal, { held, still, passed }) {
    if (!this.at || still || this.at.length !== goal.length) this.at = [...goal];
    if (held) return false;
    const part = 1 - Math.exp(-passed / GLIDE);
    const from = this.at;
    const near = goal.every((value, k) => Math.abs(value - from[k]) <= 1e-3 * Math.abs(value) + 1e-4);
    this.at = near ? [...goal] : from.map((value, k) => value + part * (goal[k] - value));
    return !near;
  }

  /** Draw a line through points; it is interrupted where one is not a number. */
  line(points, colour, { width = 1.5, dash = /** @type {number[]} */ ([]), alpha = 1 } = {}) {
    const pen = this.context;
    pen.beginPath();
    let begun = false;
    for (const [x, y] of points) {
      const there = !Number.isNaN(x + y);
      if (there && begun) pen.lineTo(x, y);
      else if (there) pen.moveTo(x, y);
      begun = there;
    }
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.setLineDash(dash);
    pen.globalAlpha = alpha;
    pen.stroke();
    pen.setLineDash([]);
    pen.globalAlpha = 1;
  }

  /** Draw a disc with a rim of the background's colour, over which no label stands. */
  dot(x, y, radius, colour, rim = 1.5) {
    disc(this.context, x, y, radius + rim, this.theme.raised);
    disc(this.context, x, y, radius, colour);
    this.avoid(x, y, radius + 2);
  }

  ring(x, y, radius, colour, width = 3) {
    ring(this.context, x, y, radius, colour, width);
    this.avoid(x, y, radius + width);
  }

  /** Draw an arrow of motion; labels keep away from it. */
  arrow(from, way, colour, width) {
    const [[x, y], [dx, dy]] = [from, way];
    if (!(Math.hypot(dx, dy) > 3)) return;
    arrowMark(this.context, [x, y], [x + dx, y + dy], { colour, dash: [], width, head: 5 + 2.2 * width });
    for (let part = 0.25; part <= 1; part += 0.25) this.avoid(x + dx * part, y + dy * part, 5);
  }

  /** Hatch the inside of a path: what cannot be seen there. */
  hatched(path) {
    const { context: pen, width, height, theme } = this;
    pen.save();
    pen.beginPath();
    path(pen);
    pen.clip();
    pen.fillStyle = pen.strokeStyle = theme.warning;
    pen.globalAlpha = 0.08;
    pen.fillRect(0, 0, width, height);
    pen.globalAlpha = 0.3;
    pen.lineWidth = 1.2;
    for (let x = -height; x < width; x += HATCH) stroke(pen, [x, height], [x + height, 0]);
    pen.restore();
  }

  /** Keep labels away from a place. */
  avoid(x, y, across, down = across) {
    this.taken.push([x - across, y - down, x + across, y + down]);
  }

  /** Keep labels away from a straight line. */
  avoidLine(from, to) {
    const [[x, y], [u, v]] = [from, to];
    const count = Math.ceil(Math.min(Math.hypot(u - x, v - y), 2000) / 8);
    for (let k = 1; k < count; k++) this.avoid(x + ((u - x) * k) / count, y + ((v - y) * k) / count, 3);
  }

  /** Write a text at its own place, such as a number at an axis; left out where it would be cut or cover another. */
  write(text, x, y, colour, align = "center") {
    const wide = this.context.measureText(text).width;
    const left = x - { left: 0, center: wide / 2, right: wide }[align];
    const box = [left, y - HALF + 1, left + wide, y + HALF - 1];
    if (this.cut(box) || this.texts.some((other) => meet(box, other.box))) return;
    this.letter(text, left + wide / 2, y, colour, box);
  }

  /** @param {Label} label */
  tag(label) {
    this.labels.push(label);
  }

  /** Point at one place with a filled note, which nobody takes for an arrow of motion. */
  note(x, y, text) {
    this.pointed = { x, y, text };
  }

  /** Write the labels, the important ones first, each where it stood if that is free; and the note. */
  end() {
    if (this.pointed) this.drawNote(this.pointed);
    for (const label of this.labels.sort((one, other) => one.rank - other.rank)) this.place(label);
  }

  place(/** @type {Label} */ { id, text, at: [x, y], colour, gap = 9, towards }) {
    const pen = this.context;
    const half = pen.measureText(text).width / 2;
    const [ahead, down] = towards ?? [0, 0];
    const along = (/** @type {number[]} */ [u, v]) => (u * ahead + v * down) / Math.hypot(u, v);
    const sides = towards ? [...SIDES].sort((one, other) => along(other) - along(one)) : SIDES;
    const spots = OFF.flatMap((off) =>
      sides.map(([u, v]) => {
        const across = (gap + off + half + 3) * (u && v ? 0.9 : 1);
        return { off, side: [u, v], at: [x + u * across, y + v * (gap + off + HALF + 1)] };
      }),
    );
    const keyOf = ({ off, side }) => OFF.length * SIDES.findIndex((each) => same(each, side)) + OFF.indexOf(off);
    const boxOf = (/** @type {any} */ { at: [cx, cy] }) => [cx - half - 2, cy - HALF, cx + half + 2, cy + HALF];
    const free = (spot) => !this.cut(boxOf(spot)) && !this.taken.some((other) => meet(boxOf(spot), other));
    const before = spots.find((spot) => keyOf(spot) === this.places.get(id));
    const spot = before && free(before) ? before : spots.find(free);
    if (!spot) {
      this.places.delete(id);
      return;
    }
    this.places.set(id, keyOf(spot));
    const [cx, cy] = spot.at;
    if (spot.off && gap) {
      const far = Math.hypot(cx - x, cy - y);
      const from = [x + ((cx - x) * gap) / far, y + ((cy - y) * gap) / far];
      const to = [Math.min(Math.max(x, cx - half), cx + half), Math.min(Math.max(y, cy - HALF + 1), cy + HALF - 1)];
      this.line([from, to], colour, { width: 1, alpha: 0.6 });
    }
    this.letter(text, cx, cy, colour, boxOf(spot));
  }

  /** Write letters that can be read on whatever lies below them, and report their box. */
  letter(text, x, y, colour, box) {
    const pen = this.context;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.lineWidth = 4;
    pen.strokeStyle = this.ground();
    pen.strokeText(text, x, y);
    pen.lineWidth = 1;
    pen.fillStyle = colour;
    pen.fillText(text, x, y);
    this.texts.push({ text, box });
    this.taken.push(box);
  }

  /** Where a note may not reach. */
  get lowest() {
    return this.height;
  }

  /** Colour below the letters. */
  ground() {
    return this.theme.raised;
  }

  cut(/** @type {number[]} */ [left, top, right, bottom]) {
    return !(left > RIM && top > RIM - 1 && right < this.width - RIM && bottom < this.height - RIM + 1);
  }

  drawNote({ x, y, text }) {
    const { context: pen, width, theme } = this;
    const half = pen.measureText(text).width / 2 + 9;
    const side = y + 46 > this.lowest ? -1 : 1;
    const [top, middle] = [y + 6 * side, y + 28 * side];
    const cx = Math.min(Math.max(x, half + RIM + 1), width - half - RIM - 1);
    const box = [cx - half, middle - 11, cx + half, middle + 11];
    pen.fillStyle = theme.ink;
    pen.beginPath();
    for (const [u, v] of [[x, top], [x - 7, middle], [x + 7, middle]]) pen.lineTo(u, v);
    pen.fill();
    pen.beginPath();
    pen.roundRect(box[0], box[1], 2 * half, 22, 11);
    pen.fill();
    pen.fillStyle = theme.paper;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillText(text, cx, middle + 0.5);
    this.texts.push({ text, box });
    this.taken.push(box);
  }
}

function meet(one, other) {
  return one[0] < other[2] && one[2] > other[0] && one[1] < other[3] && one[3] > other[1];
}
