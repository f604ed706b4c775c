// The functions that settings need, made from the texts that were printed for them.

import { Modules } from "./modules.js";

/**
 * Functions of a model.  A lab of its own says in methods of its own:
 *   needed(settings)   names and texts of the modules that they are made of
 */
export class PrintedKernels {
  constructor(model, load) {
    this.model = model;
    this.modules = new Modules(load);
  }

  /** Load what settings need. */
  async prepare(settings) {
    await Promise.all(this.needed(settings).map(([key, texts]) => this.modules.prepare(key, texts)));
  }

  /** Name and texts of the module that says which gains of an observer are allowed. */
  gains(observer) {
    const { gains } = this.model.observers[observer];
    return [`gains of ${observer}`, Object.fromEntries(gains.map((gain) => [`allow_${gain.name}`, gain.allowed]))];
  }

  /** Whether an observer's gain may have this value. */
  allows(observer, gain, value) {
    const functions = this.modules.get(`gains of ${observer}`);
    return !functions || functions[`allow_${gain}`]([value], [0])[0] === 1;
  }
}
