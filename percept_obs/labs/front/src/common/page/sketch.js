// A sketch of the error as one expects it, drawn on its chart by pointer or keys; it stays there to be compared.

import { within } from "../model/playback.js";
import { readable } from "../model/scales.js";
import { element, listen, setAttribute, svg } from "./dom.js";

const POINTS = 33;
const KEY_STEP = 0.25;
const HOW = "Your sketch of the error: left and right choose a time, up and down draw from there on, Enter ends";

export class Sketch {
  constructor(lab) {
    this.lab = lab;
    this.chart = lab.charts.error;
    this.path = svg("path");
    this.pad = element("div", {
      ...{ class: "pad", hidden: true, tabindex: 0, role: "slider", "aria-label": HOW, "data-control": "sketch" },
    });
    this.chart.figure.append(svg("svg", { class: "sketched", "aria-hidden": "true" }, this.path), this.pad);
    /** @type {{low: number, high: number, levels: number[]} | null} being drawn: decades at equal steps of time */
    this.draft = null;
    this.at = 0;
    this.listen();
  }

  begin() {
    const { figure, place } = this.chart;
    if (figure.hidden || !place) {
      this.lab.say("Tick the chart of the error first.");
      return;
    }
    const { low, high } = place.span;
    const middle = (Math.log10(place.scale.low) + Math.log10(place.scale.high)) / 2;
    this.draft = this.lab.state.preset?.sketch ?? { low, high, levels: new Array(POINTS).fill(middle) };
    this.at = 0;
    this.pad.hidden = false;
    this.pad.focus();
    this.show();
  }

  end() {
    if (!this.draft) return;
    const sketch = this.draft;
    this.draft = null;
    this.pad.hidden = true;
    this.lab.predict({ sketch });
  }

  listen() {
    const { pad } = this;
    let down = false;
    listen(pad, {
      pointerdown: (event) => {
        down = true;
        this.at = -1;
        if (event.isTrusted) pad.setPointerCapture(event.pointerId);
        this.follow(event);
      },
      pointermove: (event) => down && this.follow(event),
      "pointerup pointercancel": () => {
        if (down) this.end();
        down = false;
      },
      blur: () => down || this.end(),
      keydown: (event) => {
        const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
        const turn = { ArrowUp: KEY_STEP, ArrowDown: -KEY_STEP }[event.key];
        if (event.key === "Enter" || event.key === "Escape") this.end();
        else if (step) this.at = within(this.at + step, 0, POINTS - 1);
        else if (turn && this.draft) this.draw(this.at, POINTS - 1, this.draft.levels[this.at] + turn);
        else return;
        event.preventDefault();
        this.show();
      },
    });
  }

  /** Draw where the pointer is, and between there and where it was. */
  follow(event) {
    const { chart, draft } = this;
    if (!draft) return;
    const { height, base, perUnit, bottom } = chart.place;
    const y = event.clientY - chart.canvas.getBoundingClientRect().top;
    const level = base + within(bottom - y, 0, height) / perUnit;
    const share = (chart.nearest(event.clientX) - draft.low) / (draft.high - draft.low);
    const now = within(Math.round(share * (POINTS - 1)), 0, POINTS - 1);
    const from = this.at < 0 ? now : this.at;
    this.draw(Math.min(from, now), this.at < 0 ? POINTS - 1 : Math.max(from, now), level);
    this.at = now;
    this.show();
  }

  draw(first, last, level) {
    if (!this.draft) return;
    const levels = this.draft.levels.map((old, k) => (k >= first && k <= last ? level : old));
    this.draft = { ...this.draft, levels };
  }

  /** Put the curve where its times and values are on the chart now. */
  show() {
    const { chart: { place }, pad, path } = this;
    const sketch = this.draft ?? this.lab.state.preset?.sketch;
    const step = sketch && (sketch.high - sketch.low) / (POINTS - 1);
    const pointOf = (level, k) => `${place.x(sketch.low + k * step).toFixed(1)},${place.y(10 ** level).toFixed(1)}`;
    setAttribute(path, "d", sketch && place ? `M${sketch.levels.map(pointOf).join("L")}` : "");
    if (!this.draft) return;
    const at = Math.max(this.at, 0);
    pad.setAttribute("aria-valuenow", String(at));
    const level = readable(10 ** this.draft.levels[at]);
    pad.setAttribute("aria-valuetext", `at ${readable(this.draft.low + at * step)} s, ${level}`);
  }
}
