// The one chart of the first screen: a distance over time, linear.  One drags on it to move the time.

import { within } from "../engine/between.js";
import { readable } from "./scales.js";
import { scrubbed } from "../ui/scrub.js";
import { View } from "./view.js";

const PAD = { left: 40, right: 16, top: 12, bottom: 22 };
const [STEPS_UP, PARTS] = [4, 8];
/** Most points of a line that are drawn. */
const MOST = 700;
const LATER = 0.28;
/** Height of a bar, and of the room that each takes. */
const [BAR, BARS] = [4, 6];

/**
 * @typedef {object} ChartLine
 * @property {string} id
 * @property {string} [text]   beside its beginning
 * @property {ArrayLike<number>} time
 * @property {ArrayLike<number>} values
 * @property {string} colour
 * @property {number} [width]
 * @property {number[]} [dash]
 * @property {boolean} [secret]  whether what follows after the time shown is hidden
 *
 * @typedef {object} Chart
 * @property {ChartLine[]} lines  from the lowest layer up
 * @property {number} end      of the time, in seconds
 * @property {number} high     largest value
 * @property {string} unit
 * @property {(value: number) => string} [mark]  text of a value at the axis, where that is no number with a unit
 * @property {string} [title]  what is drawn, where the unit does not tell
 * @property {{begin: number, end: number, text: string}[]} [spans]  hatched
 * @property {{text: string, rows: number[][][]} | null} [bars]  below, each with the times in which it is hatched
 * @property {{time: number, value: number, text: string, colour: string} | null} [found]
 * @property {{time: number, value?: number, own?: number, kept?: number, text: string} | null} [note]
 *     at a value, or at a sample of a line
 */

export class TimeChart extends View {
  /** @param {(time: number) => void} onTime  takes the time that a hand asks for */
  constructor(label, onTime) {
    super("over-time", label);
    this.lastTime = 1;
    this.floor = 0;
    scrubbed(this, PAD, (part) => onTime(this.lastTime * part));
  }

  ground() {
    return this.theme.paper;
  }

  get lowest() {
    return this.height - PAD.bottom - this.floor;
  }

  x(time) {
    return PAD.left + (time / this.lastTime) * (this.width - PAD.left - PAD.right);
  }

  y(value) {
    const [high] = /** @type {number[]} */ (this.at);
    const bottom = this.height - PAD.bottom - this.floor;
    return bottom - (value / high) * (bottom - PAD.top);
  }

  /** Draw the lines up to the present, and later ones pale or not; return true while the scale is on its way. */
  draw(/** @type {Chart} */ chart, now, theme, motion) {
    this.lastTime = chart.end;
    this.floor = chart.bars ? 6 + BARS * chart.bars.rows.length : 0;
    const moving = this.glide([chart.high], motion);
    this.begin(theme);
    const { height, width } = this;
    const [right, bottom] = [width - PAD.right, height - PAD.bottom];
    this.axes(chart, right, bottom);
    this.avoid(width / 2, height - PAD.bottom / 2, width / 2, PAD.bottom / 2);
    const above = /** @type {[number, number]} */ ([right, PAD.top]);
    const title = { id: "title", at: above, colour: theme.muted, rank: 6, towards: [-1, 1] };
    if (chart.title) this.tag({ ...title, text: chart.title });
    for (const { begin, end, text } of chart.spans ?? []) {
      const [from, to] = [this.x(begin), this.x(end)];
      this.hatched((pen) => pen.rect(from, PAD.top, to - from, bottom - PAD.top));
      const at = [(from + to) / 2, bottom - this.floor - 20];
      if (text) this.tag({ id: text, text, at, colour: theme.warning, rank: 5, gap: 0 });
    }
    if (chart.bars) this.drawBars(chart.bars, now, bottom);
    this.inside(PAD.left, right + 1, () => {
      for (const line of chart.lines) if (!line.secret) this.curve(line, LATER);
    });
    this.inside(PAD.left, this.x(now) + 0.5, () => chart.lines.forEach((line) => this.curve(line, 1)));
    const { found, note } = chart;
    if (found) {
      const at = [this.x(found.time), this.y(found.value)];
      this.ring(at[0], at[1], 5, found.colour, 2.5);
      this.tag({ id: "found", text: found.text, at, colour: found.colour, rank: 1 });
    }
    const present = this.x(now);
    this.line([[present, PAD.top - 6], [present, bottom]], theme.ink);
    this.dot(present, bottom, 6, theme.ink);
    this.avoidLine([present, PAD.top], [present, bottom]);
    for (const line of chart.lines) this.nameLine(line, now, bottom);
    if (note) {
      const y = this.y(valueOf(chart.lines, note));
      this.note(this.x(note.time), within(y, PAD.top + 4, bottom - 4), note.text);
    }
    this.end();
    return moving;
  }

  axes(/** @type {Chart} */ { end, unit, mark }, right, bottom) {
    const { theme } = this;
    const [high] = /** @type {number[]} */ (this.at);
    const step = roundStep(high / STEPS_UP);
    const top = Math.floor(high / step + 1e-9);
    for (let k = 0; k <= top; k++) {
      const y = Math.round(this.y(k * step)) + 0.5;
      this.line([[PAD.left, y], [right, y]], theme.grid, { width: 1 });
      const text = mark ? mark(k * step) : `${readable(k * step)}${k === top ? ` ${unit}` : ""}`;
      this.write(text, PAD.left - 6, y, theme.muted, "right");
    }
    const seconds = roundStep(end / (this.width > 500 ? PARTS : PARTS / 2));
    for (let k = 0; k * seconds <= end * (1 + 1e-9); k++) {
      const last = (k + 1) * seconds > end * (1 + 1e-9);
      this.write(`${readable(k * seconds)}${last ? " s" : ""}`, this.x(k * seconds), bottom + 11, theme.muted);
    }
  }

  /** A bar for each of what is seen, full up to the present, and hatched where it is not seen. */
  drawBars({ text, rows }, now, bottom) {
    const { theme, context: pen } = this;
    const [left, right] = [this.x(0), this.x(this.lastTime)];
    this.write(text, left - 6, bottom - this.floor / 2 + 3, theme.muted, "right");
    this.avoid((left + right) / 2, bottom - this.floor / 2, (right - left) / 2, this.floor / 2);
    rows.forEach((spans, k) => {
      const y = bottom - this.floor + 6 + BARS * k;
      pen.fillStyle = theme.ink;
      for (const [to, alpha] of [[right, 0.25], [this.x(now), 0.6]]) {
        pen.globalAlpha = alpha;
        pen.fillRect(left, y, to - left, BAR);
      }
      pen.globalAlpha = 1;
      for (const [begin, end] of spans) {
        const [x, wide] = [this.x(begin), this.x(end) - this.x(begin)];
        pen.fillStyle = theme.paper;
        pen.fillRect(x, y, wide, BAR);
        this.hatched((path) => path.rect(x, y, wide, BAR));
        pen.strokeStyle = theme.warning;
        pen.strokeRect(x + 0.5, y + 0.5, Math.max(wide - 1, 0), BAR - 1);
      }
    });
  }

  /** Draw inside of the chart, between two places. */
  inside(left, right, draw) {
    const pen = this.context;
    pen.save();
    pen.beginPath();
    pen.rect(left, 0, right - left, this.height - PAD.bottom + 2);
    pen.clip();
    draw();
    pen.restore();
  }

  curve(/** @type {ChartLine} */ { time, values, colour, width = 2, dash = [] }, alpha) {
    const every = Math.max(1, Math.floor(time.length / MOST));
    const points = [];
    for (let k = 0; k < time.length; k += every) points.push([this.x(time[k]), Math.max(this.y(values[k]), -60)]);
    const last = time.length - 1;
    if (last % every) points.push([this.x(time[last]), Math.max(this.y(values[last]), -60)]);
    this.line(points, colour, { width, dash, alpha });
  }

  /** Name a line near its beginning, on the side away from the others. */
  nameLine(/** @type {ChartLine} */ { id, text, time, values, colour, secret }, now, bottom) {
    const every = Math.ceil(time.length / 80);
    for (let k = 0; k < time.length; k += every) {
      if (!secret || time[k] <= now) this.avoid(this.x(time[k]), within(this.y(values[k]), 0, this.height), 4);
    }
    if (!text) return;
    const at = Array.prototype.findIndex.call(time, (value) => this.x(value) >= PAD.left + 24);
    const first = Math.max(at, 0);
    const y = within(this.y(values[first]), PAD.top, bottom);
    const x = Math.max(this.x(time[first]), PAD.left + 24) + 4;
    const rank = id === "kept" ? 3 : 2;
    this.tag({ id, text, at: [x, y], colour, rank, gap: 4, towards: [0.1, -1] });
  }
}

/** The smallest of 1, 2 and 5 times a power of ten that is not below a value. */
export function roundStep(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * ([1, 2, 5].find((factor) => factor * power >= value * (1 - 1e-9)) ?? 10);
}

/** The value that a note points at: its own, or a sample of the kept run or of the estimate. */
function valueOf(lines, /** @type {any} */ { own, kept, value }) {
  if (value !== undefined) return value;
  const line = lines.find(({ id }) => id === (own === undefined ? "kept" : "estimate"));
  return line.values[own ?? kept];
}
