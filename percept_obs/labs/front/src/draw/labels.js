// A picture whose texts never overlap and are never cut: labels look for a free place, and the least important one goes
// where there is none.

import { Picture } from "./canvas.js";

/** Places around a thing, and how far off a label looks for one; from the second on with a leader to its thing. */
const SIDES = [[1, 0], [-1, 0], [0, -1], [0, 1], [1, -1], [-1, -1], [1, 1], [-1, 1]];
const OFF = [0, 16, 34];
/** Half the height of a line of letters, and the room at a picture's rim. */
const HALF = 8;
export const RIM = 4;
/** Pixels from one box to the next along a line from which labels keep away, and at most of its length. */
const [EACH, LONGEST] = [8, 2000];

/** Pixels from the corner of a picture beyond which nothing is drawn. */
const REACH = 5000;

/**
 * @typedef {object} Label
 * @property {string} id       by which it stays on the side where it was
 * @property {string} text
 * @property {number[]} at     pixels of the thing that it names
 * @property {string} colour
 * @property {number} rank     0 finds its place first
 * @property {number} [gap]    pixels from the thing's middle to its rim
 * @property {number[]} [towards]  direction of the side that is tried first
 * @property {number[][]} [along]  pixels of other places of the thing at which it may be named
 */

export class LabelledPicture extends Picture {
  constructor(className, label) {
    super(className, label);
    /** @type {Map<string, number>} */
    this.places = new Map();
    /** @type {{text: string, box: number[]}[]} what was written, with left, top, right, bottom */
    this.texts = [];
    /** @type {number[][]} boxes in which no label may stand */
    this.taken = [];
    /** @type {Label[]} */
    this.labels = [];
    this.width = this.height = 0;
    this.theme = /** @type {any} */ (null);
  }

  /** Begin a picture: an empty canvas. */
  begin(theme) {
    const { width, height } = this.fit(theme.font);
    Object.assign(this, { width, height, theme, texts: [], taken: [], labels: [] });
  }

  /** Draw a line through points; it is interrupted where one is not a number. */
  line(points, colour, { width = 1.5, dash = /** @type {number[]} */ ([]), alpha = 1 } = {}) {
    const { context: pen } = this;
    pen.beginPath();
    let [before, begun] = [/** @type {number[] | null} */ (null), false];
    for (const point of points) {
      const there = point.every(Number.isFinite);
      const part = there && before && reached(before, point);
      if (part) {
        if (!begun || part[0] !== before) pen.moveTo(part[0][0], part[0][1]);
        pen.lineTo(part[1][0], part[1][1]);
      }
      begun = Boolean(part) && part[1] === point;
      before = there ? point : null;
    }
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.setLineDash(dash);
    pen.globalAlpha = alpha;
    pen.stroke();
    pen.setLineDash([]);
    pen.globalAlpha = 1;
  }

  /** Keep labels away from a place. */
  avoid(x, y, across, down = across) {
    this.taken.push([x - across, y - down, x + across, y + down]);
  }

  /** Keep labels away from a straight line. */
  avoidLine(from, to) {
    const [[x, y], [u, v]] = [from, to];
    const count = Math.ceil(Math.min(Math.hypot(u - x, v - y), LONGEST) / EACH);
    for (let k = 1; k < count; k++) {
      const [cx, cy] = [x + ((u - x) * k) / count, y + ((v - y) * k) / count];
      this.taken.push([cx - 3, cy - 3, cx + 3, cy + 3]);
    }
  }

  /** Write a text at its own place, such as a number at an axis; left out where it would be cut or cover another. */
  write(text, x, y, colour, align = "center") {
    const wide = this.context.measureText(text).width;
    const left = x - { left: 0, center: wide / 2, right: wide }[align];
    const box = [left, y - HALF + 1, left + wide, y + HALF - 1];
    if (this.cut(box, 1) || this.texts.some((other) => meet(box, other.box))) return false;
    this.letter(text, left + wide / 2, y, colour, box);
    return true;
  }

  /** @param {Label} label */
  tag(label) {
    if (label.text && !Number.isNaN(label.at[0] + label.at[1])) this.labels.push(label);
  }

  /** Write the labels, the important ones first, each where it stood if that is free. */
  end() {
    const labels = this.labels.sort((one, other) => one.rank - other.rank);
    this.labels = [];
    for (const label of labels) this.put(label);
  }

  /** Numbers of the places of a label, the best first. */
  *spotsOf(/** @type {Label} */ { along = [], towards }) {
    const [ahead, down] = towards ?? [0, 0];
    const part = (/** @type {number} */ side) => {
      const [u, v] = SIDES[side];
      return (u * ahead + v * down) / Math.hypot(u, v);
    };
    const sides = SIDES.map((_, side) => side);
    if (towards) sides.sort((one, other) => part(other) - part(one));
    for (let off = 0; off < OFF.length; off++)
      for (const side of sides)
        for (let k = 0; k <= along.length; k++) yield OFF.length * (SIDES.length * k + side) + off;
  }

  /** The place of a label with this number: what it names there, how far off it is, and its middle. */
  spot(/** @type {Label} */ { at, along = [], gap = 9 }, key, half) {
    const [place, off] = [Math.floor(key / OFF.length), OFF[key % OFF.length]];
    const [u, v] = SIDES[place % SIDES.length];
    const k = Math.floor(place / SIDES.length);
    const from = k ? along[k - 1] : at;
    const across = (gap + off + half + 3) * (u && v ? 0.9 : 1);
    const middle = from && [from[0] + u * across, from[1] + v * (gap + off + HALF + 1)];
    return { key, off, from, at: middle };
  }

  put(/** @type {Label} */ label) {
    const { id, text, colour, gap = 9 } = label;
    const half = this.context.measureText(text).width / 2;
    const boxOf = (/** @type {any} */ { at: [cx, cy] }) => [cx - half - 2, cy - HALF, cx + half + 2, cy + HALF];
    const isFree = (spot) => {
      if (!spot.from) return false;
      const box = boxOf(spot);
      return !this.cut(box) && !this.taken.some((other) => meet(box, other));
    };
    let spot = /** @type {any} */ (null);
    const before = this.places.get(id);
    for (const key of before === undefined ? this.spotsOf(label) : [before, ...this.spotsOf(label)]) {
      const one = this.spot(label, key, half);
      if (!isFree(one)) continue;
      spot = one;
      break;
    }
    if (!spot) {
      this.places.delete(id);
      return;
    }
    this.places.set(id, spot.key);
    const [[x, y], [cx, cy]] = [spot.from, spot.at];
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
    const { context: pen } = this;
    pen.setLineDash([]);
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.lineWidth = 4;
    pen.strokeStyle = this.ground();
    pen.strokeText(text, x, y);
    pen.lineWidth = 1;
    pen.fillStyle = colour;
    pen.fillText(text, x, y);
    this.report(text, box);
  }

  report(text, box) {
    this.texts.push({ text, box });
    this.taken.push(box);
  }

  /** Colour below the letters. */
  ground() {
    return this.theme.paper;
  }

  cut(/** @type {number[]} */ [left, top, right, bottom], rim = RIM) {
    return !(left >= rim && top >= rim - 1 && right <= this.width - rim && bottom <= this.height - rim + 1);
  }
}

/** The part of a way that lies within reach of a picture, or null: a page takes minutes to dash a very long line. */
function reached(from, to) {
  let [begin, end] = [0, 1];
  for (const i of [0, 1]) {
    for (const side of [-1, 1]) {
      const [room, along] = [REACH - side * from[i], side * (to[i] - from[i])];
      if (along > 0) end = Math.min(end, room / along);
      else if (along < 0) begin = Math.max(begin, room / along);
      else if (room < 0) return null;
    }
  }
  if (begin > end) return null;
  const at = (part) => from.map((value, i) => value + part * (to[i] - from[i]));
  return [begin === 0 ? from : at(begin), end === 1 ? to : at(end)];
}

/** Return true if boxes overlap. */
export function meet(one, other) {
  return one[0] < other[2] && one[2] > other[0] && one[1] < other[3] && one[3] > other[1];
}
