// The functions that settings need: of the point, of the choice of unknowns, of the observers.

import { PrintedKernels } from "../../engine/kernels.js";
import { isTyped, typedModule } from "../../engine/typed.js";
import { isSampled } from "./camera.js";

/** Name of what is unknown, as in texts.py: its quantities, and whether d_s is known from an earlier stage only. */
export function keyOf({ unknown, earlier }) {
  return [...unknown, ...(earlier && !unknown.includes("d_s") ? ["earlier"] : [])].join(" ");
}

/** True if a velocity such as v_c1 stays zero. */
export function isZero(settings, name, { written, samples }) {
  if (isSampled(settings)) return samples.zero.includes(name);
  const typed = isTyped(settings) ? written[settings.motion] : null;
  if (typed?.python?.[name] !== undefined) return typed.zero.includes(name);
  const [which, axis] = [name.slice(0, 3), Number(name.slice(3)) - 1];
  return settings[which][axis] === 0 && settings[`${which}_swing`][axis] === 0;
}

export class StructureKernels extends PrintedKernels {
  /** Why a choice is impossible; empty if it is not. */
  refusal(settings) {
    const key = keyOf(settings);
    const reason = this.model.refused[key];
    if (reason) return reason;
    const choice = this.model.unknowns[key];
    const alone = choice?.alone.length > 0 && choice.alone.every((name) => isZero(settings, name, this.model));
    return alone ? choice.withoutThem : "";
  }

  /** The corollary that states a choice, with what it wants to be zero; null for another one. */
  corollary(settings) {
    const choice = this.model.unknowns[keyOf(settings)];
    return choice?.corollary && choice.zero.every((name) => isZero(settings, name, this.model))
      ? choice.corollary
      : null;
  }

  /** The user's observers that do not exist for so many unknowns, with the reasons. */
  refused({ unknown }) {
    return this.model.forms[unknown.length]?.refused ?? {};
  }

  of(settings) {
    const functions = super.of(settings);
    return functions && { ...functions, refusal: this.refusal(settings) };
  }

  needed(settings) {
    const { rates, plant, project, swinging, unknowns, forms } = this.model;
    const point = { key: "point", texts: { rates, plant, project, swinging } };
    const typed = typedModule(this.model, settings.motion);
    if (this.refusal(settings)) return [point, ...typed];
    const count = settings.unknown.length;
    const key = keyOf(settings);
    return [
      ...[point, ...typed],
      { key: `choice ${key}`, texts: { signals: unknowns[key].signals } },
      { key: `guard ${count}`, texts: { guard: forms[count].guard } },
      ...settings.observers.map((name) => this.loop(`${count} ${name}`, name, forms[count].observers[name])),
    ];
  }
}
