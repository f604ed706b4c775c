// A picture of the first screen.  What is written in it never overlaps and is never cut: labels look for a free place.

import { element } from "./dom.js";
import { LabelledPicture, meet, RIM } from "./labels.js";
import { arrowMark, disc, ring } from "./marks.js";

/** Milliseconds in which a view comes most of the way to where it should be. */
const GLIDE = 90;
const HATCH = 8;
/** Pixels between arrows of copies. */
const ASIDE = 11;

export class View extends LabelledPicture {
  /** @param {string} caption  that stands in a lower corner; nothing is drawn over it */
  constructor(name, label, caption = "", right = false) {
    super(`view ${name}`, label);
    /** @type {number[] | null} numbers that say what part of its world is seen */
    this.at = null;
    this.caption = caption ? element("figcaption", { class: right ? "right" : "" }, caption) : null;
    if (this.caption) this.figure.append(this.caption);
    /** @type {{x: number, y: number, text: string} | null} */
    this.pointed = null;
    /** True where letters stand on a film, and need a ground of their own. */
    this.plated = false;
  }

  /** Begin a picture: an empty canvas, in which captions and buttons have their places already. */
  begin(theme) {
    super.begin(theme);
    this.pointed = null;
    this.context.lineCap = "round";
    if (!this.caption) return;
    const { width, height } = this;
    const right = this.caption.className === "right";
    const wide = 8 * (this.caption.textContent ?? "").length + 16;
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

  /**
   * Functions from the picture's world to its pixels, and the frame of its handles; its middle lies some pixels above
   * that of the canvas, and upwards may be down.
   */
  mapped(raised = 0, up = 1) {
    const { width, height } = this;
    const [across, ahead, scale] = /** @type {number[]} */ (this.at);
    const x = (value) => width / 2 + (value - across) * scale;
    const y = (value) => height / 2 - raised - up * (value - ahead) * scale;
    const frame = { box: { left: 8, top: 8, width: width - 16, height: height - 16 }, scale, x, y };
    return { x, y, scale, frame };
  }

  /** Draw a small pale disc, from which no label keeps away. */
  speck([x, y], radius, colour) {
    this.context.globalAlpha = 0.7;
    disc(this.context, x, y, radius, colour);
    this.context.globalAlpha = 1;
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

  /** Draw how three copies of a thing at other distances move, side by side, each with its name. */
  copies([x, y], ways, names) {
    ways.forEach(([u, v], k) => {
      const length = Math.hypot(u, v);
      const aside = length > 3 ? ((k - 1) * ASIDE) / length : 0;
      const from = [x - v * aside, y + u * aside];
      this.arrow(from, [u, v], this.theme.ink, 2.5);
      const tip = { at: [from[0] + u, from[1] + v], towards: [u, v], gap: 5 };
      if (length > 8) this.tag({ id: names[k], text: names[k], ...tip, colour: this.theme.ink, rank: k });
    });
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
    pen.beginPath();
    for (let x = -height; x < width; x += HATCH) {
      pen.moveTo(x, height);
      pen.lineTo(x + height, 0);
    }
    pen.stroke();
    pen.restore();
  }

  /** Point at one place with a filled note, which nobody takes for an arrow of motion. */
  note(x, y, text) {
    this.pointed = { x, y, text };
  }

  /** Write the note, and then the labels. */
  end() {
    if (this.pointed) this.drawNote(this.pointed);
    super.end();
  }

  letter(text, x, y, colour, box) {
    const { context: pen } = this;
    const [left, top, right, bottom] = box;
    if (this.plated) {
      pen.globalAlpha = 0.75;
      pen.fillStyle = this.ground();
      pen.beginPath();
      pen.roundRect(left - 2, top, right - left + 4, bottom - top, 4);
      pen.fill();
      pen.globalAlpha = 1;
    }
    super.letter(text, x, y, colour, box);
  }

  /** Where a note may not reach. */
  get lowest() {
    return this.height;
  }

  /** Colour below the letters. */
  ground() {
    return this.theme.raised;
  }

  drawNote({ x, y, text }) {
    const { context: pen, width, theme } = this;
    const half = pen.measureText(text).width / 2 + 9;
    // Below the place or above it, or to a side, where it covers nothing that is written.
    const places = [1, -1].flatMap((side) => [0, -0.7, 0.7].map((aside) => {
      const middle = y + 28 * side;
      const cx = Math.min(Math.max(x + aside * half, half + RIM + 1), width - half - RIM - 1);
      return { side, middle, cx, box: [cx - half, middle - 11, cx + half, middle + 11] };
    }));
    const inside = places.filter(({ middle }) => middle > 18 && middle + 18 < this.lowest);
    const free = inside.find(({ box }) => !this.texts.some((other) => meet(box, other.box)));
    const { side, middle, cx, box } = free ?? inside[0] ?? places[0];
    const top = y + 6 * side;
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
    this.report(text, box);
  }
}
