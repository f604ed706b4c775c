// The controls of the structure lab: each reads from the settings and changes them.

import { readable } from "../../draw/scales.js";
import { HOLD, NOISE } from "../../state/schema.js";
import { changeAt } from "../../state/settings.js";
import { checkbox } from "../../ui/controls.js";
import { element } from "../../ui/dom.js";
import { Fieldsets, topic } from "../../ui/fieldsets.js";
import { ObserverList } from "../../ui/observer_list.js";
import { mapTopic } from "../../old/settings_map.js";
import { axesOf } from "./axes.js";
import { isSampled } from "./camera.js";

/** Labels of the settings in the page. */
export const WORDS = {
  v_c: { label: "camera {}" },
  v_p: { label: "object {}" },
  v_c_swing: { name: "swing {}", label: "swing of {}" },
  v_p_swing: { name: "swing {}", label: "swing of {}" },
  ybar: { name: "start {}", label: "start {}" },
  w_c: { label: "turning {}" },
  velocities: { choices: { set: "set here", samples: "your samples" } },
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

/** Names of settings in a sentence that says which have changed. */
export const NAMES = {
  velocities: "where the velocities come from", motion: "the motion that is typed", unknown: "what is unknown",
  earlier: "where d_s comes from", observers: "the observers", gains: "gains", ybar: "where the point starts",
  scale: "the true d_s", v_c: "the camera's velocity", v_p: "the object's velocity",
  v_c_swing: "how the camera's velocity swings",
  v_p_swing: "how the object's velocity swings", w_c: "how the camera turns", noise: "noise", bias: "the bias of ȳ3",
  drift: "the drift of ȳ3",
  hold: "what is held between samples", step: "the longest step", start: "where the estimate starts",
  pictures: "the charts", over: "the map over two settings",
};

export class StructurePanel extends Fieldsets {
  constructor(lab, choice) {
    super(lab);
    this.list = new ObserverList(this);
    const { choices, mains, groups } = this.list;
    const speed = this.lit(this.numberIf("v_c.0", areSet), "v_c1");
    const noise = this.number("noise.size", { label: "noise in y1, y2" });
    const body = [
      this.first(
        choice.body,
        this.fieldset("Observers", choices),
        this.fieldset("Move these", ...this.source(), speed, ...mains, noise),
      ),
      topic("cases", "The paper's cases", choice.table()),
      topic("gains", "All gains", ...groups),
      topic("true", "What is true: velocities, scale, start", ...this.motion()),
      topic(
        ...["camera", "What is measured, and how well"],
        ...[this.choice("noise.kind"), this.number("noise.depth"), ...this.numbersOf("camera")],
        ...[this.timing("period"), this.timing("duration")],
      ),
      topic(
        ...["run", "How the observers run"],
        ...[this.choice("start"), this.choice("hold"), this.timing("step"), ...this.numbersOf("run")],
      ),
      topic("pictures", "Charts", this.pictures()),
      mapTopic(this, axesOf),
    ];
    this.body = element("div", { class: "panel" }, ...body);
  }

  /** Choice of set or sampled velocities, where there are samples. */
  source() {
    const { lab, model: { samples } } = this;
    const last = () => Math.min(lab.settings.duration, samples.times.at(-1));
    const besides = (value) => (value === "samples" ? { motion: "", duration: last() } : {});
    return samples ? [this.choice("velocities", { besides })] : [];
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
    const rest = [1, 2].map((k) => this.lit(this.number(`v_c.${k}`), `v_c${k + 1}`));
    const set = [
      ...rest,
      ...this.litList("v_p"),
      this.add(varying),
      this.onlyIf(swings, this.number("rate"), ...this.each("v_c_swing"), ...this.each("v_p_swing")),
      this.typed("motion", "v_c1 = 0.2 cos(t)"),
      ...this.litList("w_c"),
    ];
    return [
      this.number("scale"),
      this.onlyIf(areSet, ...set),
      ...this.each("ybar"),
    ];
  }

  /** A time that must not ask the page for more steps than it can take. */
  timing(place) {
    const { mostSteps, samples } = this.model;
    const allowed = (value) => {
      const settings = { ...this.lab.settings, ...changeAt(this.lab.settings, place, value) };
      const { duration, period, step } = settings;
      return duration / Math.min(period, step) <= mostSteps && !(isSampled(settings) && duration > samples.until);
    };
    const last = samples ? `, and your samples end at ${readable(samples.times.at(-1))} s` : "";
    const reason = `and the duration is at most ${mostSteps} periods, and so many longest steps${last}`;
    return this.number(place, { allowed, reason });
  }
}

const areSet = (settings) => !isSampled(settings);

function swings({ v_c_swing, v_p_swing }) {
  return [...v_c_swing, ...v_p_swing].some((value) => value !== 0);
}
