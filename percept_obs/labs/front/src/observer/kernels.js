// The functions that settings need: of the point, the surface, the form, the observers.

import { PrintedKernels } from "../common/kernels.js";
import { switchOf } from "../common/observer_list.js";

/** Name of a form: what is seen, and what of it is measured; as in texts.py. */
export function keyOf({ surface, outputs }) {
  return `${surface} ${outputs.join("+")}`;
}

/** All functions of a model. */
export class Kernels extends PrintedKernels {
  /** The observers that do not exist for these settings' form or recording, with the reasons. */
  refused(settings) {
    const { forms, recordings } = this.model;
    return { ...forms[keyOf(settings)]?.refused, ...recordings[settings.scenario]?.refused };
  }

  /** The functions that settings need, or undefined while one of them is not loaded. */
  of(settings) {
    const found = Object.fromEntries(this.needed(settings).map(([key]) => [key, this.modules.get(key)]));
    return Object.values(found).every(Boolean) ? this.arranged(settings, found) : undefined;
  }

  needed(settings) {
    const key = keyOf(settings);
    const { project, ray, foe } = this.model.surfaces[settings.surface];
    const form = this.model.forms[key];
    const groups = [
      ["plant", { run: this.model.plant }],
      [settings.surface, { project, ray, foe }],
      [key, { w: form.w, ...(form.circle && { circle: form.circle }) }],
    ];
    for (const name of settings.observers.filter((n) => !form.refused[n])) {
      const { run, start, estimate, variances, gap } = form.observers[name][switchOf(settings, name)];
      groups.push(this.gains(name));
      const texts = { run, start, estimate, ...(variances && { variances }), ...(gap && { gap }) };
      groups.push([nameOf(settings, name), texts]);
    }
    return groups;
  }

  arranged(settings, found) {
    const observers = settings.observers.map((name) => [name, found[nameOf(settings, name)]]);
    return {
      plant: found.plant,
      surface: found[settings.surface],
      structure: found[keyOf(settings)],
      observers: Object.fromEntries(observers),
    };
  }
}

function nameOf(settings, name) {
  return [keyOf(settings), name, switchOf(settings, name)].filter(Boolean).join(" ");
}
