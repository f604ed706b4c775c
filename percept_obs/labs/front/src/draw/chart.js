// A chart over time, linear or in decades: one drags on it to move the time, reads values under the pointer, and zooms.

import { within } from "../engine/between.js";
import { sampleAt } from "../engine/tables.js";
import { element, listen } from "./dom.js";
import { readable, roundStep, tickLabel } from "./scales.js";
import { View } from "./view.js";

const PAD = { left: 40, right: 16, top: 12, bottom: 22 };
const [STEPS_UP, PARTS] = [4, 8];
/** Opacity of a line after the present. */
const LATER = 0.28;
/** Height of a bar, and of the room that each takes; of a reset's tick; of the room between two rows of words. */
const [BAR, BARS, RESET, ROW] = [4, 6, 6, 12];
/** Pixels within which a press is meant for a line, and a pointer has not moved. */
const [NEAR, STILL] = [9, 4];
/** Pixels between two points of a path at most, and how far those left out may lie off. */
const [APART, OFF] = [6, 0.1];
/** How many places of a line may bear its name. */
const NAMED = 24;

/**
 * @typedef {object} ChartLine
 * @property {string} id
 * @property {string} [text]   beside it
 * @property {ArrayLike<number>} time
 * @property {ArrayLike<number>} values
 * @property {string} colour
 * @property {number} [width]
 * @property {number[]} [dash]
 * @property {boolean} [secret]  whether what follows after the time shown is hidden
 * @property {string} [run]    the observer that a press on it chooses
 *
 * @typedef {{low: number, high: number, log?: boolean}} Scale
 *
 * @typedef {object} Chart
 * @property {ChartLine[]} lines  from the lowest layer up
 * @property {Scale} scale
 * @property {string} unit
 * @property {(value: number) => string} [mark]  text of a value at the axis, where that is no number with a unit
 * @property {string} [title]  what is drawn
 * @property {{begin: number, end: number, text: string}[]} [spans]  hatched
 * @property {{text: string, rows: number[][][]} | null} [bars]  below, each with the times in which it is hatched
 * @property {{times: ArrayLike<number>, colour: string, text: string}[]} [resets]
 * @property {{time: ArrayLike<number>, low: ArrayLike<number>, high: ArrayLike<number>, colour: string} | null} [band]
 * @property {{value: number, text: string}} [level]
 * @property {{time: number, value: number, text: string, colour: string}[]} [found]
 * @property {{time: number, value?: number, own?: number, kept?: number, text: string} | null} [note]
 *     at a value, or at a sample of a line
 *
 * @typedef {object} Hands  what a hand asks for
 * @property {(time: number) => void} onTime
 * @property {(time: number | null) => void} onPeek
 * @property {(factor: number, about: number) => void} onZoom
 * @property {() => void} onWhole
 * @property {(run: string) => void} onRun
 */

export class TimeChart extends View {
  /** @param {Hands} hands */
  constructor(name, label, hands) {
    super(name, label);
    this.figure.classList.add("over-time");
    this.span = { low: 0, high: 1 };
    this.log = false;
    this.floor = 0;
    /** @type {Chart | null} */
    this.chart = null;
    /** Lines as they were drawn last, each with what it was drawn for. */
    this.paths = new WeakMap();
    this.take(hands);
  }

  /** Let a hand drag the time, read, zoom, and choose a line. */
  take({ onTime, onPeek, onZoom, onWhole, onRun }) {
    const pad = element("div", { class: "scrub", "aria-hidden": "true" });
    let down = /** @type {number | null} */ (null);
    const place = ({ clientX, clientY }) => {
      const { left, top } = this.figure.getBoundingClientRect();
      return /** @type {[number, number]} */ ([clientX - left, clientY - top]);
    };
    const timeAt = (event) => within(this.timeAt(place(event)[0]), this.span.low, this.span.high);
    listen(pad, {
      pointerdown: (event) => {
        const run = this.runAt(place(event));
        if (run) return onRun(run);
        down = event.clientX;
        if (event.isTrusted) pad.setPointerCapture(event.pointerId);
        onPeek(null);
        return onTime(timeAt(event));
      },
      pointermove: (event) => {
        if (down === null) onPeek(event.pointerType === "mouse" ? timeAt(event) : null);
        else if (Math.abs(event.clientX - down) >= STILL) {
          down = Infinity;
          onTime(timeAt(event));
        }
      },
      "pointerup pointercancel lostpointercapture": () => (down = null),
      pointerleave: () => onPeek(null),
      dblclick: () => onWhole(),
    });
    pad.addEventListener("wheel", (event) => {
      // Without the focus in the lab the wheel belongs to the page that is read.
      if (!event.ctrlKey && !this.figure.closest(".percept-lab")?.contains(document.activeElement)) return;
      event.preventDefault();
      onZoom(Math.exp(0.002 * event.deltaY), timeAt(event));
    }, { passive: false });
    this.figure.append(pad);
  }

  ground() {
    return this.theme.paper;
  }

  get lowest() {
    return this.height - PAD.bottom - this.floor;
  }

  x(time) {
    const { low, high } = this.span;
    return PAD.left + ((time - low) / (high - low)) * (this.width - PAD.left - PAD.right);
  }

  timeAt(x) {
    const { low, high } = this.span;
    return low + ((x - PAD.left) / (this.width - PAD.left - PAD.right)) * (high - low);
  }

  y(value) {
    const [low, high] = /** @type {number[]} */ (this.at);
    const height = this.log ? Math.log10(Math.max(value, 1e-30)) : value;
    const bottom = this.lowest;
    // Outside is outside: a canvas would cut what is further away into dashes too, thousands of them.
    return within(bottom - ((height - low) / (high - low)) * (bottom - PAD.top), -60, this.height + 60);
  }

  /** The other observer whose line is at a place, if there is one. */
  runAt([x, y]) {
    if (!this.chart || x < PAD.left) return null;
    const time = this.timeAt(x);
    const apart = this.chart.lines.filter(({ run }) => run).map((line) => {
      const value = line.values[sampleAt(line.time, time)];
      return { run: line.run, off: Math.abs(this.y(value) - y) };
    });
    const [nearest] = apart.sort((one, other) => one.off - other.off);
    return nearest && nearest.off < NEAR ? nearest.run : null;
  }

  /**
   * Draw the lines up to the present, and later ones pale or not; return true while the scale is on its way.
   *
   * @param {Chart} chart
   * @param {{span: {low: number, high: number}, now: number, peek: number | null}} times
   */
  draw(chart, { span, now, peek }, theme, motion) {
    const { log = false } = chart.scale;
    this.span = span;
    this.chart = chart;
    this.floor = chart.bars ? 6 + BARS * chart.bars.rows.length : 0;
    if (log !== this.log) this.at = null;
    this.log = log;
    const moving = this.glide([chart.scale.low, chart.scale.high].map(log ? Math.log10 : Number), motion);
    this.begin(theme);
    const { height, width } = this;
    const [right, bottom] = [width - PAD.right, height - PAD.bottom];
    this.axes(chart, right, bottom);
    this.avoid(width / 2, height - PAD.bottom / 2, width / 2, PAD.bottom / 2);
    this.drawSpans(chart.spans ?? [], right, bottom);
    if (chart.bars) this.drawBars(chart.bars, now, bottom);
    if (chart.level) this.drawLevel(chart.level, right);
    const present = this.x(now);
    const { band } = chart;
    if (band) this.inside(PAD.left, right + 1, () => this.fillBand(band));
    if (present < right)
      this.inside(Math.max(present, PAD.left), right + 1, () => {
        for (const line of chart.lines) if (!line.secret) this.curve(line, LATER);
      });
    this.inside(PAD.left, present + 0.5, () => chart.lines.forEach((line) => this.curve(line, 1)));
    (chart.resets ?? []).forEach((resets, row) => this.drawResets(resets, row, right));
    for (const { time, value, text, colour } of chart.found ?? []) {
      if (time < span.low || time > span.high) continue;
      const at = [this.x(time), this.y(value)];
      this.ring(at[0], at[1], 5, colour, 2.5);
      this.tag({ id: `found ${colour}`, text, at, colour, rank: 1 });
    }
    this.line([[present, PAD.top - 6], [present, bottom]], theme.ink);
    this.dot(present, bottom, 6, theme.ink);
    this.avoidLine([present, PAD.top], [present, bottom]);
    if (peek !== null) this.line([[this.x(peek), PAD.top - 6], [this.x(peek), bottom]], theme.muted, { width: 1 });
    this.head(chart, peek ?? now, peek !== null, right);
    for (const line of chart.lines) this.nameLine(line, now, right);
    if (chart.note) {
      const y = this.y(valueOf(chart.lines, chart.note));
      this.note(this.x(chart.note.time), within(y, PAD.top + 4, bottom - 4), chart.note.text);
    }
    this.end();
    return moving;
  }

  /** What is drawn, and what is read at a time: of a chart with a title always, of the others under the pointer. */
  head({ title = "", lines, unit }, time, peeked, right) {
    const read = title || peeked ? readingAt(lines, time, unit) : "";
    const text = [title, peeked ? `${readable(time)} s` : "", read].filter(Boolean).join(" · ");
    const short = this.context.measureText(text).width > right - PAD.left - 16 ? title || read : text;
    if (short) this.write(short, right - 8, 8, this.theme.muted, "right");
  }

  axes(/** @type {Chart} */ { unit, mark }, right, bottom) {
    const { theme, log } = this;
    const [low, high] = /** @type {number[]} */ (this.at);
    const step = log ? Math.max(1, Math.ceil((high - low) / STEPS_UP)) : roundStep((high - low) / STEPS_UP);
    const ticks = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-9) + 1e-12; k++) ticks.push(k * step);
    ticks.forEach((tick, k) => {
      const value = log ? 10 ** tick : tick;
      const y = Math.round(this.y(value)) + 0.5;
      this.line([[PAD.left, y], [right, y]], theme.grid, { width: 1 });
      const last = k === ticks.length - 1 && unit;
      const text = mark && !log ? mark(tick) : `${tickLabel(value, log)}${last ? ` ${unit}` : ""}`;
      this.write(text, PAD.left - 6, y, theme.muted, "right");
    });
    const { low: first, high: last } = this.span;
    const seconds = roundStep((last - first) / (this.width > 500 ? PARTS : PARTS / 2));
    const end = last * (1 + 1e-9);
    for (let k = Math.ceil(first / seconds - 1e-9); k * seconds <= end; k++) {
      const unitToo = (k + 1) * seconds > end ? " s" : "";
      this.write(`${readable(k * seconds, 4)}${unitToo}`, this.x(k * seconds), bottom + 11, theme.muted);
    }
  }

  /** Hatched spans; of those with one text the widest bears it. */
  drawSpans(spans, right, bottom) {
    const widest = new Map();
    for (const { begin, end, text } of spans) {
      const [from, to] = [begin, end].map((time) => within(this.x(time), PAD.left, right));
      if (!(to > from)) continue;
      this.hatched((pen) => pen.rect(from, PAD.top, to - from, bottom - PAD.top));
      if (text && to - from > (widest.get(text)?.wide ?? 0)) widest.set(text, { wide: to - from, x: (from + to) / 2 });
    }
    for (const [text, { x }] of widest) {
      const at = [x, bottom - this.floor - 20];
      this.tag({ id: text, text, at, colour: this.theme.warning, rank: 5, gap: 0 });
    }
  }

  /** A level such as the tolerance, where the scale reaches it. */
  drawLevel({ value, text }, right) {
    const y = this.y(value);
    if (y < PAD.top || y > this.lowest) return;
    this.line([[PAD.left, y], [right, y]], this.theme.muted, { width: 1, dash: [2, 4] });
    this.tag({ id: "level", text, at: [right, y], colour: this.theme.muted, rank: 6, gap: 3, towards: [-1, 1] });
  }

  /** Ticks from the top down, one for each column of pixels in which there are resets, and how many there are. */
  drawResets({ times, colour, text }, row, right) {
    const { context: pen } = this;
    const seen = [];
    for (const time of times) {
      const x = Math.round(this.x(time));
      if (x >= PAD.left && x <= right && x !== seen.at(-1)) seen.push(x);
    }
    pen.fillStyle = colour;
    for (const x of seen) pen.fillRect(x, PAD.top, 1, RESET);
    const at = [seen[0], PAD.top + RESET + 1 + ROW * row];
    if (seen.length) this.tag({ id: `resets ${row}`, text, at, towards: [1, 1], gap: 2, colour, rank: 4 });
  }

  /** A bar for each of what is seen, full up to the present, and hatched where it is not seen. */
  drawBars({ text, rows }, now, bottom) {
    const { theme, context: pen } = this;
    const [left, right] = [PAD.left, this.width - PAD.right];
    const x = (time) => within(this.x(time), left, right);
    this.write(text, left - 6, bottom - this.floor / 2 + 3, theme.muted, "right");
    this.avoid((left + right) / 2, bottom - this.floor / 2, (right - left) / 2, this.floor / 2);
    rows.forEach((spans, k) => {
      const y = bottom - this.floor + 6 + BARS * k;
      pen.fillStyle = theme.ink;
      for (const [to, alpha] of [[right, 0.25], [x(now), 0.6]]) {
        pen.globalAlpha = alpha;
        pen.fillRect(left, y, to - left, BAR);
      }
      pen.globalAlpha = 1;
      for (const [begin, end] of spans) {
        const [from, wide] = [x(begin), x(end) - x(begin)];
        pen.fillStyle = theme.paper;
        pen.fillRect(from, y, wide, BAR);
        this.hatched((path) => path.rect(from, y, wide, BAR));
        pen.strokeStyle = theme.warning;
        pen.strokeRect(from + 0.5, y + 0.5, Math.max(wide - 1, 0), BAR - 1);
      }
    });
  }

  /** A band between two values at each time. */
  fillBand({ time, low, high, colour }) {
    const { context: pen } = this;
    const every = Math.max(1, Math.floor(time.length / (2 * this.width)));
    const there = Array.from({ length: Math.ceil(time.length / every) }, (_, j) => every * j);
    const ends = there.filter((k) => Number.isFinite(low[k]) && Number.isFinite(high[k]));
    pen.beginPath();
    for (const k of ends) pen.lineTo(this.x(time[k]), this.y(high[k]));
    for (const k of ends.reverse()) pen.lineTo(this.x(time[k]), this.y(low[k]));
    pen.globalAlpha = 0.16;
    pen.fillStyle = colour;
    pen.fill();
    pen.globalAlpha = 1;
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
    const { context: pen } = this;
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.lineJoin = "bevel";
    pen.setLineDash(dash);
    pen.globalAlpha = alpha;
    pen.stroke(this.pathOf(time, values));
    pen.globalAlpha = 1;
    pen.setLineDash([]);
  }

  /** The path of a line, which is the same as long as nothing but the time moves. */
  pathOf(time, values) {
    const key = [...(this.at ?? []), this.span.low, this.span.high, this.width, this.height, this.floor].join();
    const known = this.paths.get(values);
    if (known?.key === key && known.time === time) return known.path;
    const path = new Path2D();
    trace(path, this, time, values);
    this.paths.set(values, { key, time, path });
    return path;
  }

  /** Name a line near its beginning, or where there is room, on the side away from the others. */
  nameLine(/** @type {ChartLine} */ { id, text, time, values, colour, secret }, now, right) {
    const last = secret ? Math.min(this.x(now), right) : right;
    const places = /** @type {number[][]} */ ([]);
    const each = (right - PAD.left) / (4 * NAMED);
    for (let k = 1; k < 4 * NAMED && PAD.left + k * each <= last; k++) {
      const value = values[sampleAt(time, this.timeAt(PAD.left + k * each))];
      const y = this.y(value);
      if (!(y > PAD.top - 8 && y < this.lowest + 8)) continue;
      this.avoid(PAD.left + k * each, y, 4);
      if (k > 6 && k % 4 === 0) places.push([PAD.left + k * each, y]);
    }
    const [at = [PAD.left + 28, within(this.y(values[0]), PAD.top, this.lowest)], ...along] = places;
    if (text) this.tag({ id, text, at, along, colour, rank: id === "kept" ? 3 : 2, gap: 4, towards: [0.1, -1] });
  }
}

/** Values of the lines that have a name at a time; of a level line the axis tells it. */
function readingAt(lines, time, unit) {
  const level = ({ values }) => values.every((value) => value === values[0]);
  const told = lines.filter((line) => line.text && !level(line)).map(({ text, time: times, values }) => {
    const value = values[sampleAt(times, time)];
    return `${text} ${Number.isFinite(value) ? `${readable(value)}${unit && ` ${unit}`}` : "–"}`;
  });
  return told.join(", ");
}

/** Points of a path, without those that lie on the way from one to the next: a page pays for each. */
class Way {
  /** The last two points: the first was drawn, the second waits for the next. */
  drawn = [NaN, NaN];
  waiting = /** @type {number[] | null} */ (null);

  constructor(pen) {
    this.pen = pen;
  }

  begin(x, y) {
    this.pen.moveTo(x, y);
    this.drawn = [x, y];
  }

  to(x, y) {
    const { drawn: [u, v], waiting } = this;
    if (waiting) {
      const [x1, y1] = waiting;
      const off = y1 - (v + ((y - v) * (x1 - u)) / (x - u));
      if (!(x - u < APART && Math.abs(off) < OFF)) this.end();
    }
    this.waiting = [x, y];
  }

  end() {
    if (!this.waiting) return;
    const [x, y] = this.waiting;
    this.pen.lineTo(x, y);
    this.drawn = this.waiting;
    this.waiting = null;
  }
}

/** One path, with gaps where values are not numbers; of each pixel column the first, least, greatest and last. */
function trace(pen, chart, time, values) {
  const [from, to] = [sampleAt(time, chart.span.low), Math.min(sampleAt(time, chart.span.high) + 1, time.length - 1)];
  const way = new Way(pen);
  let [column, first, least, greatest, last, at, before] = [NaN, 0, 0, 0, 0, 0, NaN];
  const flush = () => {
    if (Number.isNaN(column)) return;
    if (Number.isNaN(before)) way.begin(at, chart.y(first));
    else way.to(at, chart.y(first));
    if (least < first && least < last) way.to(at, chart.y(least));
    if (greatest > first && greatest > last) way.to(at, chart.y(greatest));
    if (last !== first) way.to(at, chart.y(last));
    before = last;
    column = NaN;
  };
  const perSecond = chart.x(1) - chart.x(0);
  const zero = chart.x(0);
  for (let k = from; k <= to; k++) {
    const value = values[k];
    if (!(value - value === 0)) {
      flush();
      way.end();
      before = NaN;
      continue;
    }
    const x = zero + time[k] * perSecond;
    // Heights grow with values, so that only those of a column's four need the scale.
    if (Math.floor(x) !== column) {
      flush();
      [column, at] = [Math.floor(x), x];
      first = least = greatest = last = value;
      continue;
    }
    if (value < least) least = value;
    if (value > greatest) greatest = value;
    last = value;
  }
  flush();
  way.end();
}

/** The value that a note points at: its own, or a sample of the kept run or of the estimate. */
function valueOf(lines, /** @type {any} */ { own, kept, value }) {
  if (value !== undefined) return value;
  const line = lines.find(({ id }) => id === (own === undefined ? "kept" : "estimate"));
  return line.values[own ?? kept];
}
