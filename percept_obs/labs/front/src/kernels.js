// Texts that sympy printed become functions: each group is one module, imported once and kept.

/** Import a module's text; a Blob's address works in JupyterLab, in Voila and from a file. */
export async function importText(text) {
  const address = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
  try {
    return await import(/* @vite-ignore */ address);
  } finally {
    URL.revokeObjectURL(address);
  }
}

/** Text of a module that exports each function under its key. */
export function moduleText(functions) {
  return Object.entries(functions)
    .map(([key, text]) => `export const ${key} = (() => {\n${text}\nreturn ${text.match(/^function (\w+)/)?.[1]};\n})();`)
    .join("\n");
}

/** All functions of a model, by surface, by structure and by observer. */
export class Kernels {
  constructor(model, load = importText) {
    this.model = model;
    this.load = load;
    this.groups = new Map();
    this.waiting = new Map();
  }

  /** The functions that settings need, or undefined while one of them is still being loaded. */
  of(settings) {
    const found = Object.fromEntries(this.needed(settings).map(([key]) => [key, this.groups.get(key)]));
    return Object.values(found).every(Boolean) ? this.arranged(settings, found) : undefined;
  }

  /** Load what settings need. */
  async prepare(settings) {
    await Promise.all(this.needed(settings).map(([key, functions]) => this.group(key, functions)));
  }

  /** Load everything that the model offers, so that no change has to wait. */
  async prepareAll() {
    const names = Object.keys(this.model.observers);
    for (const [surface, { structures }] of Object.entries(this.model.surfaces)) {
      for (const key of Object.keys(structures)) {
        await this.prepare({ surface, outputs: key.split("+"), observers: names });
      }
    }
  }

  needed({ surface, outputs, observers }) {
    const key = outputs.join("+");
    const chart = this.model.surfaces[surface];
    const structure = chart.structures[key];
    const { project, ray, foe } = chart;
    const groups = [
      ["plant", { run: this.model.plant }],
      [surface, { project, ray, foe }],
      [`${surface} ${key}`, { w: structure.w, ...(structure.circle && { circle: structure.circle }) }],
    ];
    for (const name of observers) {
      const { run, start, estimate, variances } = structure.observers[name];
      const allowed = Object.fromEntries(this.model.observers[name].gains.map((g) => [`allow_${g.name}`, g.allowed]));
      groups.push([`gains of ${name}`, allowed]);
      groups.push([`${surface} ${key} ${name}`, { run, start, estimate, ...(variances && { variances }) }]);
    }
    return groups;
  }

  arranged({ surface, outputs, observers }, found) {
    const key = `${surface} ${outputs.join("+")}`;
    const byObserver = Object.fromEntries(observers.map((name) => [name, found[`${key} ${name}`]]));
    return { plant: found.plant, surface: found[surface], structure: found[key], observers: byObserver };
  }

  group(key, functions) {
    if (!this.waiting.has(key)) {
      const loaded = this.load(moduleText(functions)).then(
        (module) => this.groups.set(key, module),
        (error) => {
          this.waiting.delete(key);
          throw new Error(`the functions of "${key}" could not be loaded: ${error.message}`);
        },
      );
      this.waiting.set(key, loaded);
    }
    return this.waiting.get(key);
  }
}
