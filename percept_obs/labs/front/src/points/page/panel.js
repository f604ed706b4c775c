// The controls of the lab of many points: each reads from the settings and changes them.

import { HOLD, NOISE } from "../../common/model/schema.js";
import { button, element } from "../../common/page/controls.js";
import { Fieldsets } from "../../common/page/fieldsets.js";
import { typedField } from "../../common/page/typed.js";
import { OWN } from "../model/kernels.js";
import { PointList } from "./point_list.js";

/** What P begins with when a kind is chosen. */
const OWN_SIZE = { constant: 1, scheduled: 0.3, typed: 1, lyapunov: 1, riccati: 0.01 };

/** What the page calls the settings. */
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
  weight: { choices: { constant: "constant", scheduled: "scheduled", typed: "typed", lyapunov: "Lyapunov", riccati: "Riccati" } },
  velocity: { name: "velocity {}", label: "added to v, {}" },
  start: { choices: { rays: "on the first rays", error: "with a given error", zero: "at zero" } },
  noise: NOISE,
  hold: HOLD,
  pictures: { choices: { error: "error", depth: "depths", points: "error of each point", gramian: "Gramian" } },
};

/** The states that can be chosen. */
function statesOf({ states }) {
  return Object.fromEntries(Object.keys(states).map((name) => [name, WORDS.state.choices[name] ?? "a form of your own"]));
}

export class Panel extends Fieldsets {
  constructor(lab) {
    super(lab);
    this.list = new PointList(this, this.model.mostPoints);
    this.body = element(
      "div",
      { class: "columns" },
      this.fieldset("Points", {}, this.list.body),
      this.fieldset("The state holds", { class: "state" }, this.inSight("state", { choices: statesOf(this.model) })),
      this.weight(),
      this.motion(),
      this.fieldset(
        "The estimate",
        {},
        this.choice("start"),
        this.numberIf("depth", ({ start }) => start === "rays"),
        this.numberIf("error", ({ start }) => start === "error"),
      ),
      this.fieldset(
        "Camera",
        {},
        this.choice("noise.kind"),
        ...this.numbers("noise.size", "seed", "period", "dropout", "view"),
        this.choice("hold"),
      ),
      this.fieldset("Pictures", {}, this.pictures(), ...this.numbers("duration", "window")),
    );
    this.controls.push(this.list);
  }

  weight() {
    const kind = this.choice("weight", { besides: (value) => ({ size: OWN_SIZE[value] }) });
    const size = this.number("size");
    const words = size.querySelector("label span");
    const name = () => (words.textContent = this.lab.settings.weight === "constant" ? "P, times the identity" : "P at the beginning");
    this.controls.push({ row: size, show: name });
    return this.fieldset(
      "The observer's P",
      {},
      kind,
      size,
      this.onlyIf(({ weight }) => weight === "typed", this.typed("P", "P = 1 + exp(-t)", "P = ")),
      this.numberIf("final", ({ weight }) => weight === "scheduled"),
      this.numberIf("decrease", ({ weight }) => weight === "lyapunov"),
      this.numberIf("forgetting", ({ weight }) => weight === "riccati"),
      this.number("step"),
    );
  }

  motion() {
    const { letters } = this.model;
    const share = (place, holds = (_settings) => true) => this.lit(this.numberIf(place, holds, { letter: letters[place] }), place, "");
    const aim = button("Along the ray of point 1", () => this.lab.aim(), { "data-control": "aim" });
    const still = button("v = 0", () => this.lab.change({ input: 0, velocity: [0, 0, 0] }, true), { "data-control": "no input" });
    const moved = this.fieldset(
      "The motion, A(t) and v(t)",
      {},
      share("turning"),
      share("spin", ({ state }) => state !== "independent"),
      share("input"),
      ...this.litList("velocity", "v", (letter) => ({ letter: letters[letter] }), ""),
      this.typed("motion", "w3 = 0.5 cos(t)"),
      element("div", { class: "buttons" }, still, aim),
    );
    return this.onlyIf(({ state }) => state !== OWN, moved);
  }

  typed(place, hint, prefix) {
    const { label, most } = this.schema[place];
    return this.add(typedField(this.lab, { ...this.bound(place, true), label, most, hint, prefix }));
  }
}
