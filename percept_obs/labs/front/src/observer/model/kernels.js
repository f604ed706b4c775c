// @ts-check
// The functions that settings need: of the point, the surface, the structure, the observers.

import { PrintedKernels } from "../../common/model/kernels.js";
import { switchOf } from "../../common/model/settings.js";

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

  needed(settings) {
    const key = keyOf(settings);
    const { project, ray, foe } = this.model.surfaces[settings.surface];
    const { w, circle, refused, observers } = this.model.structures[key];
    const loops = settings.observers
      .filter((name) => !refused[name])
      .map((name) => {
        const way = switchOf(settings, name);
        return this.loop([key, name, way].filter(Boolean).join(" "), name, observers[name][way]);
      });
    return [
      { key: "plant", texts: { plant: this.model.plant } },
      { key: settings.surface, texts: { project, ray, foe } },
      { key, texts: { w, ...(circle && { circle }) } },
      ...loops,
    ];
  }
}
