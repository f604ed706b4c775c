// The controls of the structure lab's drawer: each reads from the settings and changes them.

import { readable } from "../../draw/scales.js";
import { HOLD, NOISE } from "../../state/schema.js";
import { changeAt } from "../../state/settings.js";
import { Fieldsets } from "../../ui/fieldsets.js";
import { Observers } from "../../ui/observers.js";
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
};

/** Names of settings in a sentence that says which have changed. */
export const NAMES = {
  velocities: "where the velocities come from", motion: "the motion over time", unknown: "what is unknown",
  earlier: "where d_s comes from", observers: "the observers", gains: "gains", ybar: "where the point starts",
  scale: "the true d_s", v_c: "the camera's velocity", v_p: "the object's velocity",
  v_c_swing: "how the camera's velocity swings",
  v_p_swing: "how the object's velocity swings", w_c: "how the camera turns", noise: "noise", bias: "the bias of ȳ3",
  drift: "the drift of ȳ3",
  hold: "what is held between samples", step: "the longest step", start: "where the estimate starts",
};

export class StructurePanel extends Fieldsets {
  constructor(lab, choice) {
    super(lab);
    const observers = new Observers(this, 0);
    this.controls.push(...choice.controls);
    this.groups = [
      { name: "known", title: "What is known", inside: [choice.body], show: () => choice.show(lab.shown) },
      ...observers.groups,
      { name: "scene", title: "What is true", inside: this.scene() },
      { name: "camera", title: "Camera", inside: this.camera() },
      {
        ...{ name: "run", title: "Start and steps" },
        inside: [this.choice("start"), this.choice("hold"), this.timing("step"), ...this.of("run")],
      },
    ];
  }

  camera() {
    const noise = this.number("noise.size", { label: "noise in y1, y2" });
    const timing = [this.timing("period"), this.timing("duration")];
    return [this.choice("noise.kind"), noise, this.number("noise.depth"), ...this.of("camera"), ...timing];
  }

  /** Choice of set or sampled velocities, where there are samples. */
  source() {
    const { lab, model: { samples } } = this;
    const last = () => Math.min(lab.settings.duration, samples.times.at(-1));
    const besides = (value) => (value === "samples" ? { motion: "", duration: last() } : {});
    return samples ? [this.choice("velocities", { besides })] : [];
  }

  scene() {
    const { lab } = this;
    const varying = this.ticked({
      name: "swings",
      label: "velocities that vary",
      get: () => swings(lab.settings),
      set: (on) => {
        const size = on ? 0.1 : 0;
        lab.change({ v_c_swing: [size, size, -size], v_p_swing: [0, 0, 0] }, true);
      },
    });
    const set = [
      ...this.litList("v_c"),
      ...this.litList("v_p"),
      varying,
      this.onlyIf(swings, this.number("rate"), ...this.each("v_c_swing"), ...this.each("v_p_swing")),
      ...this.litList("w_c"),
    ];
    const areSet = (settings) => !isSampled(settings);
    return [...this.source(), this.number("scale"), this.onlyIf(areSet, ...set), ...this.each("ybar")];
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

function swings({ v_c_swing, v_p_swing }) {
  return [...v_c_swing, ...v_p_swing].some((value) => value !== 0);
}
