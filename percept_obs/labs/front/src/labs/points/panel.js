// The controls of the drawer of many points: each reads from the settings and changes them.

import { button, element } from "../../draw/dom.js";
import { readable } from "../../draw/scales.js";
import { HOLD, NOISE, WINDOW } from "../../state/schema.js";
import { slider, tick } from "../../ui/controls.js";
import { Fieldsets } from "../../ui/fieldsets.js";
import { OWN } from "./kernels.js";

/** Size of P when a kind is chosen. */
const OWN_SIZE = { constant: 1, scheduled: 0.3, typed: 1, lyapunov: 1, riccati: 0.01 };

/** Labels of the settings in the page. */
export const WORDS = {
  state: {
    choices: {
      body: "one rigid body: first point and offsets",
      independent: "points of their own",
      origin: "a body with an unmarked origin",
    },
  },
  points: { depth: { label: "depth", unit: "m", low: 0.5, high: 6, step: 0.05, above: 0 } },
  hidden: { step: 0.5 },
  window: WINDOW,
  weight: {
    label: "P",
    choices: {
      ...{ constant: "constant", scheduled: "scheduled", typed: "over time", lyapunov: "Lyapunov", riccati: "Riccati" },
    },
  },
  camera_velocity: { name: "velocity {}", label: "camera moves, {}" },
  start: { choices: { rays: "on the first rays", error: "with a given error", zero: "at zero" } },
  noise: NOISE,
  hold: HOLD,
};

/** Names of settings in a sentence that says which have changed. */
export const NAMES = {
  state: "what the state holds", points: "the points", hidden: "when points are hidden",
  turning: "how the camera turns", spin: "how the body turns", input: "the input",
  camera_velocity: "how the camera moves", motion: "the motion over time",
  weight: "the kind of P", size: "P", P: "the P over time", P0: "the P at the beginning",
  final: "P at the end", decrease: "the decrease q", forgetting: "the forgetting λ", start: "where the estimate starts",
  depth: "the depth at which it starts", error: "the error at which it starts", noise: "noise", dropout: "lost samples",
  view: "how far the camera sees", hold: "what is held between samples", step: "the longest step",
  window: "the window",
};

/** The states that can be chosen. */
function statesOf({ states }) {
  const called = (name) => WORDS.state.choices[name] ?? "a form of your own";
  return Object.fromEntries(Object.keys(states).map((name) => [name, called(name)]));
}

export class Panel extends Fieldsets {
  constructor(lab) {
    super(lab);
    this.groups = [
      { name: "points", title: "Points", inside: this.points() },
      { name: "weight", title: "Observer: its gain P", inside: this.weight() },
      { name: "motion", title: "Motion, A(t) and v(t)", inside: this.motion() },
      {
        ...{ name: "start", title: "Start of the estimate" },
        inside: [
          this.choice("start"),
          this.numberIf("depth", ({ start }) => start === "rays"),
          this.numberIf("error", ({ start }) => start === "error"),
        ],
      },
      {
        ...{ name: "camera", title: "Camera" },
        inside: [
          this.choice("noise.kind"),
          this.number("noise.size", { label: "noise, bound or σ" }),
          ...[...this.of("camera"), this.choice("hold"), this.duration()],
        ],
      },
    ];
  }

  /** What the state holds, and of each point its depth, whether it is hidden, and the button that removes it. */
  points() {
    const { lab, model } = this;
    const state = this.choice("state", { choices: statesOf(model) });
    const rows = Array.from({ length: model.mostPoints }, (_, k) => this.point(k));
    const add = button("Add a point", () => lab.addPoint(), { "data-control": "add point" });
    const full = () => lab.settings.points.length === model.mostPoints || !lab.layouts[lab.settings.points.length];
    this.controls.push({ row: add, name: "add point", show: () => (add.disabled = full()) });
    return [state, ...rows, add];
  }

  point(k) {
    const { lab } = this;
    const there = () => k < lab.settings.points.length;
    const depth = slider({
      name: `depth ${k + 1}`,
      ...this.schema.points.depth,
      label: `point ${k + 1}, depth`,
      most: this.schema.points.most,
      get: () => (there() ? lab.depthOf(k) : undefined),
      set: (value) => lab.moveDepth(k, value),
      rest: () => lab.rest(),
    });
    const hide = tick({
      ...{ name: `hide ${k + 1}`, label: "hidden" },
      get: () => there() && lab.settings.hidden[k] !== null,
      set: (on) => lab.hide(k, on ? lab.someTime() : null),
    });
    const times = ["from", "to"].map((word, end) => this.time(k, word, end));
    const said = { "data-control": `remove ${k + 1}`, "aria-label": `remove point ${k + 1}` };
    const remove = button("×", () => lab.removePoint(k), { class: "remove", ...said });
    const head = element("div", { class: "buttons" }, hide.row, remove);
    const attributes = { role: "group", "aria-label": `Point ${k + 1}` };
    const row = element("div", attributes, depth.row, head, ...times.map((time) => time.row));
    const show = () => {
      row.hidden = !there();
      if (row.hidden) return;
      for (const control of [depth, hide, ...times]) control.show();
      remove.disabled = !lab.layouts[lab.settings.points.length - 2];
    };
    this.controls.push({ row, show, name: `point ${k + 1}` });
    return row;
  }

  /** From when, or until when, a point is hidden. */
  time(k, word, end) {
    const { lab } = this;
    const { step, most } = this.schema.hidden;
    const at = () => lab.settings.hidden[k];
    return slider({
      ...{ name: `hidden ${word} ${k + 1}`, label: `hidden ${word}`, unit: "s" },
      ...{ low: 0, high: 20, step, least: 0, most },
      allowed: (value) => (end ? value > at()[0] : value < at()[1]),
      reason: "and the end after the beginning",
      get: () => at()?.[end],
      set: (value) => lab.hide(k, at().with(end, value), false),
      rest: () => lab.rest(),
    });
  }

  /** At most as long as the samples of one's own motion. */
  duration() {
    const { samples } = this.model.states[OWN] ?? {};
    const allowed = (value) => !samples || this.lab.settings.state !== OWN || value <= samples.until;
    const reason = samples && `and your samples end at ${readable(samples.times.at(-1))} s`;
    return this.number("duration", { allowed, reason });
  }

  weight() {
    const given = ({ P, P0 }) => P.trim() || P0.trim();
    const possible = (value) => value !== "typed" || Boolean(given(this.lab.settings));
    // The constant one, over 1, is the gain below the pictures.
    const size = this.numberIf("size", ({ weight }) => weight !== "constant", { label: "P at the beginning" });
    return [
      this.choice("weight", { possible, besides: (value) => ({ size: OWN_SIZE[value] }) }),
      size,
      this.numberIf("final", ({ weight }) => weight === "scheduled"),
      this.numberIf("decrease", ({ weight }) => weight === "lyapunov"),
      this.numberIf("forgetting", ({ weight }) => weight === "riccati"),
      ...this.of("weight"),
    ];
  }

  motion() {
    const { lab, model } = this;
    const share = (place, holds) => {
      const row = this.numberIf(place, (settings) => settings.state !== OWN && holds(settings), {
        letter: model.letters[place],
      });
      return this.lit(row, place, "");
    };
    const always = () => true;
    const ours = [
      ...this.litList("camera_velocity", "v_c", (letter) => ({ letter: model.letters[letter] }), ""),
      element(
        "div",
        { class: "buttons" },
        button("v = 0", () => lab.changeAndSay("v = 0", { input: 0, camera_velocity: [0, 0, 0] }), {
          "data-control": "no input",
        }),
        button("Along the ray of point 1", () => lab.aim(), { "data-control": "aim" }),
      ),
    ];
    return [
      share("turning", always),
      share("input", always),
      share("spin", ({ state }) => state !== "independent"),
      this.onlyIf(({ state }) => state !== OWN, ...ours),
    ];
  }
}
