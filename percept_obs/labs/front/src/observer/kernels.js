// The functions that settings need: of the point, the surface, the structure, the observers.

import { Modules } from "../common/modules.js";
import { switchOf } from "../common/observer_list.js";

/** Name of a structure: what is seen, and what of it is measured; as in structures.py. */
export function keyOf({ surface, outputs }) {
  return `${surface} ${outputs.join("+")}`;
}

/** All functions of a model; some structures follow after it has been opened. */
export class Kernels {
  constructor(model, load) {
    this.model = model;
    this.modules = new Modules(load);
    this.whole = new Set();
    this.waiters = [];
  }

  /** Take a structure with all its observers. */
  arrive(key, structure) {
    this.model.structures[key] = structure;
    this.whole.add(key);
    for (const retry of this.waiters.splice(0)) retry();
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

  /** Wait for what settings need, and load it. */
  async prepare(settings) {
    while (!this.has(settings)) await new Promise((resolve) => this.waiters.push(resolve));
    await Promise.all(this.needed(settings).map(([key, texts]) => this.modules.prepare(key, texts)));
  }

  /** Whether an observer's gain may have this value. */
  allows(observer, gain, value) {
    const functions = this.modules.get(`gains of ${observer}`);
    return !functions || functions[`allow_${gain}`]([value], [0])[0] === 1;
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
      const allowed = Object.fromEntries(this.model.observers[name].gains.map((g) => [`allow_${g.name}`, g.allowed]));
      groups.push([`gains of ${name}`, allowed]);
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
