// @ts-check
// The functions that settings need: of the point, of the choice of unknowns, of the observers.

import { PrintedKernels } from "../../common/model/kernels.js";

/** Name of a choice, as in choices.py: its unknowns, and whether d_s is known from an earlier stage only. */
export function keyOf({ unknown, earlier }) {
  return [...unknown, ...(earlier && !unknown.includes("d_s") ? ["earlier"] : [])].join(" ");
}

/** Whether a velocity such as v_c1 is zero and stays so. */
export function isZero(settings, name) {
  const [which, axis] = [name.slice(0, 3), Number(name.slice(3)) - 1];
  return settings[which][axis] === 0 && settings[`${which}_swing`][axis] === 0;
}

/** All functions of a model; most choices follow after it has been opened. */
export class StructureKernels extends PrintedKernels {
  /** Take the choices, or the loops for a number of unknowns. */
  arrive(part, texts) {
    if (part === "choices") this.model.choices = texts;
    else this.model.kernels[parseInt(part, 10)] = texts;
    this.came(part);
  }

  /** Why a choice is impossible; empty if it is not, or not known yet. */
  refusal(settings) {
    const key = keyOf(settings);
    const reason = this.model.refused[key];
    if (reason) return reason;
    const choice = this.model.choices[key];
    const alone = choice?.alone.length > 0 && choice.alone.every((name) => isZero(settings, name));
    return alone ? choice.withoutThem : "";
  }

  /** The corollary that states a choice, with what it wants to be zero; null for another one. */
  corollary(settings) {
    const choice = this.model.choices[keyOf(settings)];
    return choice?.corollary && choice.zero.every((name) => isZero(settings, name)) ? choice.corollary : null;
  }

  /** No observer is impossible where the choice is possible. */
  refused() {
    return {};
  }

  has(settings) {
    if (this.refusal(settings)) return true;
    const kernels = this.model.kernels[settings.unknown.length];
    return Boolean(this.model.choices[keyOf(settings)]) && settings.observers.every((name) => kernels?.observers[name]);
  }

  of(settings) {
    const functions = super.of(settings);
    return functions && { ...functions, refusal: this.refusal(settings) };
  }

  needed(settings) {
    const { plant, project, swinging, choices, kernels } = this.model;
    const point = { key: "point", texts: { plant, project, swinging } };
    if (this.refusal(settings)) return [point];
    const count = settings.unknown.length;
    const key = keyOf(settings);
    return [
      point,
      { key: `choice ${key}`, texts: { signals: choices[key].signals } },
      { key: `guard ${count}`, texts: { guard: kernels[count].guard } },
      ...settings.observers.map((name) => this.loop(`${count} ${name}`, name, kernels[count].observers[name])),
    ];
  }
}
