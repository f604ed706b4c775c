// The functions that settings need: of the point, of the choice of unknowns, of the observers.

import { PrintedKernels } from "../common/kernels.js";

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

  /** The functions that settings need, or undefined while one of them has to be waited for. */
  of(settings) {
    if (!this.has(settings)) return undefined;
    const groups = this.needed(settings).map(([key]) => this.modules.get(key));
    if (!groups.every(Boolean)) return undefined;
    const [point, choice, guard] = groups;
    const names = this.refusal(settings) ? [] : settings.observers;
    const observers = Object.fromEntries(names.map((name, k) => [name, groups[3 + 2 * k]]));
    return { ...point, ...choice, ...guard, observers };
  }

  needed(settings) {
    const { plant, project, swinging, choices, kernels } = this.model;
    const point = ["point", { plant, project, swinging }];
    if (this.refusal(settings)) return [point];
    const count = settings.unknown.length;
    const key = keyOf(settings);
    const groups = [
      point,
      [`choice ${key}`, { signals: choices[key].signals }],
      [`guard ${count}`, { guard: kernels[count].guard }],
    ];
    for (const name of settings.observers) {
      const { run, start, estimate, variances, gap, fastest } = kernels[count].observers[name];
      const texts = { run, start, estimate, variances, gap, fastest };
      groups.push([`${count} ${name}`, Object.fromEntries(Object.entries(texts).filter(([, text]) => text))]);
      groups.push(this.gains(name));
    }
    return groups;
  }
}
