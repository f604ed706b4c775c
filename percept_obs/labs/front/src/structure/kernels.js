// The functions that settings need: of the point, of the choice of unknowns, of the observers.

import { PrintedKernels } from "../common/kernels.js";

/** Name of what is unknown, as in texts.py: its quantities, and whether d_s is known from an earlier stage only. */
export function keyOf({ unknown, earlier }) {
  return [...unknown, ...(earlier && !unknown.includes("d_s") ? ["earlier"] : [])].join(" ");
}

/** Whether a velocity such as v_c1 is zero and stays so. */
export function isZero(settings, name) {
  const [which, axis] = [name.slice(0, 3), Number(name.slice(3)) - 1];
  return settings[which][axis] === 0 && settings[`${which}_swing`][axis] === 0;
}

/** All functions of a model. */
export class StructureKernels extends PrintedKernels {
  /** Why a choice is impossible; empty if it is not. */
  refusal(settings) {
    const key = keyOf(settings);
    const reason = this.model.refused[key];
    if (reason) return reason;
    const choice = this.model.unknowns[key];
    const alone = choice?.alone.length > 0 && choice.alone.every((name) => isZero(settings, name));
    return alone ? choice.withoutThem : "";
  }

  /** The corollary that states a choice, with what it wants to be zero; null for another one. */
  corollary(settings) {
    const choice = this.model.unknowns[keyOf(settings)];
    return choice?.corollary && choice.zero.every((name) => isZero(settings, name)) ? choice.corollary : null;
  }

  /** No observer is impossible where the choice is possible. */
  refused() {
    return {};
  }

  /** The functions that settings need, or undefined while one of them is not loaded. */
  of(settings) {
    const groups = this.needed(settings).map(([key]) => this.modules.get(key));
    if (!groups.every(Boolean)) return undefined;
    const [point, choice, guard] = groups;
    const names = this.refusal(settings) ? [] : settings.observers;
    const observers = Object.fromEntries(names.map((name, k) => [name, groups[3 + 2 * k]]));
    return { ...point, ...choice, ...guard, observers };
  }

  needed(settings) {
    const { plant, project, swinging, unknowns, forms } = this.model;
    const point = ["point", { plant, project, swinging }];
    if (this.refusal(settings)) return [point];
    const count = settings.unknown.length;
    const key = keyOf(settings);
    const groups = [
      point,
      [`choice ${key}`, { signals: unknowns[key].signals }],
      [`guard ${count}`, { guard: forms[count].guard }],
    ];
    for (const name of settings.observers) {
      const { run, start, estimate, variances, gap, fastest } = forms[count].observers[name];
      const texts = { run, start, estimate, variances, gap, fastest };
      groups.push([`${count} ${name}`, Object.fromEntries(Object.entries(texts).filter(([, text]) => text))]);
      groups.push(this.gains(name));
    }
    return groups;
  }
}
