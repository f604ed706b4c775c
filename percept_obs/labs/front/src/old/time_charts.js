// The time charts of a lab: which are shown, over which time, on scales that stand still while the hand moves, and how
// a hand zooms them.

import { keptScale, linearScale, spread } from "../draw/scales.js";
import { indicesIn, Timeline } from "./timeline.js";
import { chartInWords } from "../draw/lines.js";
import { TimeChart } from "../draw/old_charts.js";
import { element, listen } from "../ui/dom.js";

/** Pixels from which on a drag is meant. */
const MEANT = 6;

export class TimeCharts {
  constructor(labels) {
    /** @type {Record<string, TimeChart>} */
    this.charts = Object.fromEntries(Object.entries(labels).map(([name, label]) => [name, new TimeChart(label)]));
    /** @type {Record<string, import("../types.js").ChartParts>} */
    this.drawn = {};
    /** @type {Record<string, any>} the scales that were drawn last, by the keys or titles of charts */
    this.scales = {};
    this.timeline = new Timeline();
  }

  /** Draw the charts of these names, whose parts `partsOf` tells. */
  draw(names, partsOf, { theme, held, narrow }) {
    for (const [name, chart] of Object.entries(this.charts)) chart.figure.hidden = !names.includes(name);
    this.drawn = Object.fromEntries(names.map((name) => [name, partsOf(name)]));
    const { low, high } = this.timeline.span;
    const span = { low, high, ticks: linearScale(low, high, narrow ? 4 : 8).ticks };
    const boundsOf = (line, options) => spread(valuesIn(line, span), options);
    const before = this.scales;
    this.scales = {};
    names.forEach((name, k) => {
      const parts = this.drawn[name];
      const { key = parts.title } = parts;
      const last = before[key];
      const scale = (this.scales[key] = last && held ? last : keptScale(last, parts.scale(boundsOf)));
      this.charts[name].draw({ ...parts, scale, span, theme, first: k === 0, last: k === names.length - 1 });
    });
  }

  /** Mark a time in all of them. */
  point(time) {
    for (const name of Object.keys(this.drawn)) this.charts[name].point(time);
  }

  describe() {
    for (const [name, parts] of Object.entries(this.drawn)) this.charts[name].tell(chartInWords(parts));
  }
}

/** The values of a line in a span of time. */
function valuesIn({ time, values }, span) {
  const [first, last] = indicesIn(time, span);
  return "subarray" in values ? values.subarray(first, last + 1) : values.slice(first, last + 1);
}

/** Let a hand zoom a chart: a click shows the time, a drag the part that it marks, the wheel zooms, twice shows all. */
export function zoomByHand(lab, chart, player) {
  const { canvas, figure } = chart;
  const part = element("div", { class: "part", hidden: true });
  figure.append(part);
  /** @type {{x: number, time: number} | null} */
  let grip = null;
  const cover = (one, other) => {
    const [left, right] = [one, other].map((time) => chart.place.x(time)).sort((a, b) => a - b);
    part.style.transform = `translateX(${left}px)`;
    part.style.width = `${right - left}px`;
  };
  const letGo = () => {
    grip = null;
    part.hidden = true;
  };
  listen(canvas, {
    pointerdown: (event) => {
      const time = chart.timeAt(event.clientX);
      if (time === null || event.button > 0) return;
      grip = { x: event.clientX, time };
      if (event.isTrusted) canvas.setPointerCapture(event.pointerId);
    },
    pointermove: (event) => {
      if (!grip) {
        if (!player.playing) lab.peek(chart.timeAt(event.clientX));
      } else if (!part.hidden || Math.abs(event.clientX - grip.x) >= MEANT) {
        part.hidden = false;
        cover(grip.time, chart.nearest(event.clientX));
      }
    },
    pointerup: (event) => {
      if (!grip) return;
      const { time } = grip;
      if (part.hidden) player.put(time);
      else lab.zoom((timeline) => timeline.select({ low: time, high: chart.nearest(event.clientX) }));
      letGo();
    },
    pointercancel: letGo,
    pointerleave: () => lab.peek(null),
    dblclick: () => lab.zoom((timeline) => timeline.select(timeline.whole)),
  });
  canvas.addEventListener("wheel", (event) => {
    // Without the focus in this part of the lab the wheel belongs to the page that is read.
    const meant = event.ctrlKey || player.body.contains(document.activeElement);
    const about = chart.timeAt(event.clientX);
    if (!meant || about === null) return;
    event.preventDefault();
    lab.zoom((timeline) => timeline.zoom(Math.exp(0.002 * event.deltaY), about));
  }, { passive: false });
}
