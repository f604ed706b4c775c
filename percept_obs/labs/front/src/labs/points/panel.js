// The controls of the lab of many points: each reads from the settings and changes them.

import { readable } from "../../draw/scales.js";
import { HOLD, NOISE } from "../../state/schema.js";
import { button, element } from "../../ui/dom.js";
import { Fieldsets, topic } from "../../ui/fieldsets.js";
import { OWN } from "./kernels.js";
import { isComputed, textOfP } from "./weight.js";
import { PointList } from "./point_list.js";

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
  weight: {
    choices: {
      ...{ constant: "constant", scheduled: "scheduled", typed: "typed", lyapunov: "Lyapunov", riccati: "Riccati" },
    },
  },
  camera_velocity: { name: "velocity {}", label: "camera moves, {}" },
  start: { choices: { rays: "on the first rays", error: "with a given error", zero: "at zero" } },
  noise: NOISE,
  hold: HOLD,
  pictures: { choices: { error: "error", depth: "depths", points: "error of each point", gramian: "Gramian" } },
};

/** Names of settings in a sentence that says which have changed. */
export const NAMES = {
  state: "what the state holds", points: "the points", hidden: "when points are hidden",
  turning: "how the camera turns", spin: "how the body turns", input: "the input",
  camera_velocity: "how the camera moves", motion: "the motion that is typed",
  weight: "the kind of P", size: "P", P: "the P that is typed", P0: "the P at the beginning that is typed",
  final: "P at the end", decrease: "the decrease q", forgetting: "the forgetting λ", start: "where the estimate starts",
  depth: "the depth at which it starts", error: "the error at which it starts", noise: "noise", dropout: "lost samples",
  view: "how far the camera sees", hold: "what is held between samples", step: "the longest step",
  window: "the window", pictures: "the charts",
};

/** The states that can be chosen. */
function statesOf({ states }) {
  const called = (name) => WORDS.state.choices[name] ?? "a form of your own";
  return Object.fromEntries(Object.keys(states).map((name) => [name, called(name)]));
}

export class Panel extends Fieldsets {
  constructor(lab) {
    super(lab);
    this.list = new PointList(this, this.model.mostPoints);
    const { kind, size, rest } = this.weight();
    const ours = (holds) => (settings) => settings.state !== OWN && holds(settings);
    const share = (place, holds) => {
      const row = this.numberIf(place, ours(holds), { letter: this.model.letters[place] });
      return this.lit(row, place, "");
    };
    const always = () => true;
    const spin = share("spin", ({ state }) => state !== "independent");
    const motion = topic("motion", "More of the motion, A(t) and v(t)", spin, ...this.motion());
    const noise = this.number("noise.size", { label: "noise, bound or σ" });
    const body = [
      this.first(
        this.fieldset("The state holds", this.inSight("state", { choices: statesOf(this.model) })),
        this.fieldset("Move these", kind, size, share("turning", always), share("input", always), noise),
      ),
      topic("points-topic", "Points: depth, hide, add", this.list.body),
      topic("weight", "More of the observer's P", ...rest),
      this.onlyIf(({ state }) => state !== OWN, motion),
      topic(
        ...["estimate", "Where the estimate starts"],
        this.choice("start"),
        this.numberIf("depth", ({ start }) => start === "rays"),
        this.numberIf("error", ({ start }) => start === "error"),
      ),
      topic("camera", "Camera", this.choice("noise.kind"), ...this.numbersOf("camera"), this.choice("hold")),
      topic("pictures", "Charts", this.pictures(), this.duration(), ...this.numbersOf("pictures")),
    ];
    this.body = element("div", { class: "panel" }, ...body);
    this.controls.push(this.list);
  }

  /** At most as long as the samples of one's own motion. */
  duration() {
    const { samples } = this.model.states[OWN] ?? {};
    const allowed = (value) => !samples || this.lab.settings.state !== OWN || value <= samples.until;
    const reason = samples && `and your samples end at ${readable(samples.times.at(-1))} s`;
    return this.number("duration", { allowed, reason });
  }

  weight() {
    const kind = this.choice("weight", { besides: (value) => ({ size: OWN_SIZE[value] }) });
    const size = this.number("size");
    const words = size.querySelector("label span");
    const name = () => {
      const { settings } = this.lab;
      const plain = settings.weight === "constant" ? "P, times the identity" : "P at the beginning";
      words.textContent = textOfP(settings) ? "P in what is typed" : plain;
    };
    this.controls.push({ row: size, show: name });
    const rest = [
      this.onlyIf(({ weight }) => weight === "typed", this.typed("P", "P = [1, 1, 1 + exp(-t)]", "P = ")),
      this.onlyIf(isComputed, this.typed("P0", "P = [P, P, P/4]", "P = ")),
      this.numberIf("final", ({ weight }) => weight === "scheduled"),
      this.numberIf("decrease", ({ weight }) => weight === "lyapunov"),
      this.numberIf("forgetting", ({ weight }) => weight === "riccati"),
      ...this.numbersOf("weight"),
    ];
    return { kind, size, rest };
  }

  motion() {
    const { letters } = this.model;
    const aim = button("Along the ray of point 1", () => this.lab.aim(), { "data-control": "aim" });
    const stop = () => this.lab.changeAndSay("v = 0", { input: 0, camera_velocity: [0, 0, 0] });
    const still = button("v = 0", stop, { "data-control": "no input" });
    const added = this.litList("camera_velocity", "v_c", (letter) => ({ letter: letters[letter] }), "");
    return [...added, this.typed("motion", "w_c3 = 0.5 cos(t)"), element("div", { class: "buttons" }, still, aim)];
  }
}
