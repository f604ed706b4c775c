// Time charts: lines of which the least and greatest value of each pixel column are drawn, so that 8,000 points cost as
// 800.

import { within } from "../engine/between.js";
import { tickLabel } from "./scales.js";
import { indicesIn } from "../old/timeline.js";
import { drawBars, drawEvent, drawLevel, drawOutside, drawResets, horizontal } from "../old/chart_events.js";
import { nameLine, sayNothing, shade, shows } from "../old/chart_events.js";
import { element } from "../ui/dom.js";
import { clipTo } from "../old/image_frame.js";
import { LabelledPicture } from "./labels.js";
import { opacityOf } from "../old/line_styles.js";

const LEFT = 48;
const RIGHT = 12;
const TOP = 21;
const BOTTOM = 18;

export class TimeChart extends LabelledPicture {
  constructor(label) {
    super("chart", label);
    this.now = element("div", { class: "now", hidden: true });
    this.figure.append(this.now);
    /** @type {Place | null} */
    this.place = null;
    /** @type {any[]} lines of a kept run, which lie below all others and stay as they are */
    this.kept = [];
    this.keptCount = 0;
  }

  /** @param {Record<string, any>} parts as types.js has them, with the scale and the span of time to draw them on */
  draw({ title, lines, scale, span, theme, first, last, ...more }) {
    const { band, level, regions = [], marks = [], bars = [], events = [] } = more;
    this.begin(theme);
    const { width, height } = this;
    const box = { left: LEFT, top: TOP, width: width - LEFT - RIGHT, height: height - TOP - (last ? BOTTOM : 8) };
    const place = (this.place = new Place(this, span, scale, box));
    const clipped = { left: LEFT, top: TOP - 1, width: box.width, height: box.height + 2 };
    const pen = this.context;
    const kept = this.keptOf(lines, theme);
    this.underlay([title, scale, span, last, theme, this.keptCount], (below) => {
      this.axes(place, theme, title, last);
      clipTo(below, clipped);
      for (const line of kept) strokeLine(below, place, line, theme);
    });
    pen.save();
    clipTo(pen, clipped);
    for (const region of regions) shade(pen, place, region, theme, first);
    if (level !== undefined) drawLevel(pen, place, level, theme);
    if (band) fillBand(pen, place, band);
    for (const line of lines.slice(kept.length)) strokeLine(pen, place, line, theme);
    drawResets(pen, place, marks, theme, first);
    drawBars(pen, place, bars);
    for (const event of events) drawEvent(pen, place, event, level);
    for (const line of lines) drawOutside(pen, place, line, theme);
    for (const line of lines) nameLine(place, line, theme);
    pen.restore();
    if (!lines.some((line) => shows(line, place))) sayNothing(place, lines, theme);
    this.end();
  }

  /** The lines of a kept run, before all others; a count of them tells whether what lies below is still right. */
  keptOf(lines, { kept }) {
    const others = lines.findIndex(({ colour }) => colour !== kept);
    const found = others < 0 ? lines : lines.slice(0, others);
    const same = ({ values, dash }, k) => values === this.kept[k].values && dash === this.kept[k].dash;
    if (found.length !== this.kept.length || !found.every(same)) this.keptCount += 1;
    this.kept = found;
    return found;
  }

  /** Mark a time, without drawing anything again. */
  point(time) {
    const { now, place } = this;
    const seen = time !== null && place && time >= place.span.low && time <= place.span.high;
    now.hidden = !seen;
    if (seen) now.style.transform = `translateX(${Math.round(place.x(time))}px)`;
  }

  axes(place, theme, title, last) {
    const { pen, width } = this;
    this.write(this.shortened(title, width - 8), 4, 7, theme.ink, "left");
    for (const tick of place.scale.ticks) {
      const y = Math.round(place.y(tick)) + 0.5;
      horizontal(pen, place, tick, theme.grid, []);
      this.write(tickLabel(tick, place.scale.log), place.left - 6, y, theme.muted, "right");
    }
    if (!last) return;
    const { low, high, ticks } = place.span;
    // The last one, which has the unit, is wanted most.
    for (const tick of ticks.filter((each) => each >= low && each <= high).toReversed()) {
      const text = tickLabel(tick, false) + (tick === ticks.at(-1) ? " s" : "");
      const most = width - 1 - pen.measureText(text).width / 2;
      this.write(text, Math.min(place.x(tick), most), place.bottom + 10, theme.muted);
    }
  }

  /** The time under a pointer, or null beside the chart. */
  timeAt(clientX) {
    const time = this.nearest(clientX);
    if (!this.place || time === null) return null;
    return Math.abs(this.place.x(time) - this.left(clientX)) < 1 ? time : null;
  }

  /** The time nearest to a pointer. */
  nearest(clientX) {
    if (!this.place) return null;
    const { low, high } = this.place.span;
    return within(this.place.timeAt(this.left(clientX)), low, high);
  }

  left(clientX) {
    return clientX - this.canvas.getBoundingClientRect().left;
  }
}

/** Where times and values lie on a canvas. */
class Place {
  constructor(picture, span, scale, { left, top, width, height }) {
    this.picture = picture;
    this.span = span;
    this.scale = scale;
    this.left = left;
    this.top = top;
    this.width = width;
    this.height = height;
    this.right = left + width;
    this.bottom = top + height;
    this.perSecond = width / (span.high - span.low);
    const [low, high] = [scale.low, scale.high].map(scale.log ? Math.log10 : Number);
    this.perUnit = height / (high - low);
    this.base = low;
  }

  x(time) {
    return this.left + (time - this.span.low) * this.perSecond;
  }

  timeAt(x) {
    return this.span.low + (x - this.left) / this.perSecond;
  }

  y(value) {
    const height = this.scale.log ? Math.log10(Math.max(value, 1e-30)) : value;
    const y = this.bottom - (height - this.base) * this.perUnit;
    // Outside is outside: a canvas would cut what is further away into dashes too, thousands of them.
    return Math.min(Math.max(y, this.top - this.height), this.bottom + this.height);
  }
}

function strokeLine(pen, place, { time, values, colour, dash }, theme) {
  pen.beginPath();
  tracePath(pen, place, time, values);
  pen.strokeStyle = colour;
  pen.setLineDash(dash ?? []);
  pen.lineJoin = "bevel";
  pen.lineWidth = theme.width;
  pen.globalAlpha = opacityOf(theme, colour);
  pen.stroke();
  pen.globalAlpha = 1;
  pen.lineWidth = 1;
}

/** One path, with gaps where values are not numbers; of each pixel column the first, least, greatest and last. */
export function tracePath(pen, place, time, values) {
  const { left, perSecond } = place;
  const begin = place.span.low;
  let column = -1;
  let first = 0;
  let least = 0;
  let greatest = 0;
  let last = 0;
  let before = NaN;
  const flush = () => {
    if (column < 0) return;
    const x = column + 0.5;
    if (Number.isNaN(before)) pen.moveTo(x, place.y(first));
    // A line that only rises, or only falls, from column to column needs no more than its ends.
    else if (!((before <= first && first <= last) || (before >= first && first >= last))) pen.lineTo(x, place.y(first));
    if (least < first && least < last) pen.lineTo(x, place.y(least));
    if (greatest > first && greatest > last) pen.lineTo(x, place.y(greatest));
    pen.lineTo(last === first ? x + 0.01 : x, place.y(last));
    before = last;
    column = -1;
  };
  const [from, to] = indicesIn(time, place.span);
  for (let k = from; k <= to; k++) {
    const value = values[k];
    if (!(value - value === 0)) {
      flush();
      before = NaN;
      continue;
    }
    // Heights grow with values, so that only those of a column's four need the scale.
    const at = Math.floor(left + (time[k] - begin) * perSecond);
    if (at !== column) {
      flush();
      column = at;
      first = least = greatest = last = value;
      continue;
    }
    if (value < least) least = value;
    if (value > greatest) greatest = value;
    last = value;
  }
  flush();
}

/** A band between two values at each time, with gaps where there are none. */
export function fillBand(pen, place, { time, low, high, colour }) {
  const every = Math.max(1, Math.floor(time.length / (place.width * 2)));
  pen.beginPath();
  let stretch = [];
  const close = () => {
    const points = [...stretch.map((k) => [k, high]), ...stretch.toReversed().map((k) => [k, low])];
    points.forEach(([k, values], at) => (at ? pen.lineTo : pen.moveTo).call(pen, place.x(time[k]), place.y(values[k])));
    stretch = [];
  };
  for (let k = 0; k < time.length; k += every) {
    if (Number.isFinite(low[k]) && Number.isFinite(high[k])) stretch.push(k);
    else close();
  }
  close();
  pen.globalAlpha = 0.16;
  pen.fillStyle = colour;
  pen.fill();
  pen.globalAlpha = 1;
}
