// The controls of the structure lab: each reads from the settings and changes them.

import { HOLD, NOISE } from "../../common/model/schema.js";
import { changeAt } from "../../common/model/settings.js";
import { checkbox, element } from "../../common/page/controls.js";
import { Fieldsets } from "../../common/page/fieldsets.js";
import { typedField } from "../../common/page/typed.js";
import { ObserverList } from "../../common/page/observer_list.js";

/** What the page calls the settings. */
export const WORDS = {
  v_c: { label: "camera {}" },
  v_p: { label: "object {}" },
  v_c_swing: { name: "swing {}", label: "swing of {}" },
  v_p_swing: { name: "swing {}", label: "swing of {}" },
  ybar: { name: "start {}", label: "start {}" },
  w: { label: "turning {}" },
  noise: NOISE,
  start: { choices: { own: "the first sample", zero: "zero" } },
  hold: HOLD,
  pictures: {
    choices: {
      unknowns: "the unknowns", error: "error", image: "image coordinates", depth: "scaled inverse depth",
      innovation: "innovation", determinant: "determinant", range: "range",
    },
  },
};

export class StructurePanel extends Fieldsets {
  constructor(lab) {
    super(lab);
    this.list = new ObserverList(this);
    this.body = element(
      "div",
      { class: "panel" },
      element("div", { class: "observe" }, this.fieldset("Observe with", {}, ...this.list.rows)),
      this.fieldset("Gains", { class: "gains" }, ...this.list.groups),
      this.motion(),
      this.fieldset(
        "What is measured",
        { class: "camera" },
        this.choice("noise.kind"),
        ...this.numbers("noise.size", "noise.depth", "bias", "drift", "seed"),
        this.timing("period"),
        this.timing("duration"),
      ),
      this.fieldset(
        "How the observers run",
        { class: "start" },
        ...[this.choice("start"), this.choice("hold"), this.timing("step"), this.number("tolerance")],
      ),
      this.fieldset("Pictures", { class: "pictures" }, this.pictures()),
    );
  }

  motion() {
    const { lab } = this;
    const varying = checkbox({
      name: "swings",
      label: "velocities that vary",
      get: () => swings(lab.settings),
      set: (on) => {
        const size = on ? 0.1 : 0;
        lab.change({ v_c_swing: [size, size, -size], v_p_swing: [0, 0, 0] }, true);
      },
    });
    return this.fieldset(
      "What is true",
      { class: "point" },
      this.number("scale"),
      ...this.litList("v_c"),
      ...this.litList("v_p"),
      this.add(varying),
      this.onlyIf(swings, element("div", {}, this.number("rate"), ...this.each("v_c_swing"), ...this.each("v_p_swing"))),
      this.add(typedField(lab, { ...this.bound("motion", true), ...this.schema.motion, hint: "v_c1 = 0.2 cos(t)" })),
      ...this.each("ybar"),
      ...this.litList("w"),
    );
  }

  /** A time that must not ask the page for more steps than it can take. */
  timing(place) {
    const allowed = (value) => {
      const { duration, period, step } = { ...this.lab.settings, ...changeAt(this.lab.settings, place, value) };
      return duration / Math.min(period, step) <= this.model.mostSteps;
    };
    return this.number(place, { allowed });
  }
}

function swings({ v_c_swing, v_p_swing }) {
  return [...v_c_swing, ...v_p_swing].some((value) => value !== 0);
}
