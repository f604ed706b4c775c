// The functions that settings need: of the point, the surface, the structure, the observers.

import { PrintedKernels } from "../common/kernels.js";
import { switchOf } from "../common/observer_list.js";

/** Name of a structure: what is seen, and what of it is measured; as in structures.py. */
export function keyOf({ surface, outputs }) {
  return `${surface} ${outputs.join("+")}`;
}

/** All functions of a model; some structures follow after it has been opened. */
export class Kernels extends PrintedKernels {
  /** Take a structure with all its observers. */
  arrive(key, structure) {
    this.model.structures[key] = structure;
    this.came(key);
  }

  /** Whether the texts that settings need have come. */
  has(settings) {
    const structure = this.model.structures[keyOf(settings)];
    const there = (name) => structure.refused[name] || structure.observers[name]?.[switchOf(settings, name)];
    return Boolean(structure) && settings.observers.every(there);
  }

  /** The observers that do not exist for these settings' structure or recording, with the reasons. */
  refused(settings) {
    const { structures, recordings } = this.model;
    return { ...structures[keyOf(settings)]?.refused, ...recordings[settings.scenario]?.refused };
  }

  /** The functions that settings need, or undefined while one of them has to be waited for. */
  of(settings) {
    if (!this.has(settings)) return undefined;
    const found = Object.fromEntries(this.needed(settings).map(([key]) => [key, this.modules.get(key)]));
    return Object.values(found).every(Boolean) ? this.arranged(settings, found) : undefined;
  }

  needed(settings) {
    const key = keyOf(settings);
    const { project, ray, foe } = this.model.surfaces[settings.surface];
    const structure = this.model.structures[key];
    const groups = [
      ["plant", { run: this.model.plant }],
      [settings.surface, { project, ray, foe }],
      [key, { w: structure.w, ...(structure.circle && { circle: structure.circle }) }],
    ];
    for (const name of settings.observers.filter((n) => !structure.refused[n])) {
      const { run, start, estimate, variances, gap } = structure.observers[name][switchOf(settings, name)];
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
