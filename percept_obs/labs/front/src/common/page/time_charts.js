// The time charts of a lab: which are shown, over which time, and on scales that stand still while the hand moves.

import { keptScale, linearScale, spread } from "../model/scales.js";
import { indicesIn, Timeline } from "../model/timeline.js";
import { chartInWords } from "./chart_parts.js";
import { TimeChart } from "./charts.js";

/** @typedef {import("../../types.js").ChartParts} ChartParts */

export class TimeCharts {
  constructor(labels) {
    /** @type {Record<string, TimeChart>} */
    this.charts = Object.fromEntries(Object.entries(labels).map(([name, label]) => [name, new TimeChart(label)]));
    /** @type {Record<string, ChartParts>} */
    this.drawn = {};
    /** @type {Record<string, any>} the scales that were drawn last, by the titles of charts */
    this.scales = {};
    this.timeline = new Timeline();
  }

  /** Draw the charts of these names, whose parts `partsOf` tells. */
  draw(names, partsOf, { theme, held, narrow }) {
    for (const [name, chart] of Object.entries(this.charts)) chart.figure.hidden = !names.includes(name);
    this.drawn = Object.fromEntries(names.map((name) => [name, partsOf(name)]));
    const { low, high } = this.timeline.span;
    const span = { low, high, ticks: linearScale(low, high, narrow ? 4 : 8).ticks };
    const within = (line, options) => spread(seen(line, span), options);
    this.scales = Object.fromEntries(Object.values(this.drawn).map(({ title, scale }) => {
      const before = this.scales[title];
      return [title, before && held ? before : keptScale(before, scale(within))];
    }));
    names.forEach((name, k) => {
      const parts = this.drawn[name];
      const place = { first: k === 0, last: k === names.length - 1 };
      this.charts[name].draw({ ...parts, scale: this.scales[parts.title], span, theme, ...place });
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
function seen({ time, values }, span) {
  const [first, last] = indicesIn(time, span);
  return "subarray" in values ? values.subarray(first, last + 1) : values.slice(first, last + 1);
}
