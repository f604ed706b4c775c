// Texts that sympy printed become functions: each group is one module, imported once and kept.

/** Import a module's text; a Blob's address works in JupyterLab, in Voila and from a file. */
async function importText(text) {
  const address = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
  try {
    return await import(/* @vite-ignore */ address);
  } finally {
    URL.revokeObjectURL(address);
  }
}

/** Text of a module that exports each function under its key, which is a name and no more of a program. */
export function moduleText(functions) {
  const strange = Object.keys(functions).find((key) => !/^[\p{ID_Start}_][\p{ID_Continue}]*$/u.test(key));
  if (strange !== undefined) throw new Error(`${JSON.stringify(strange)} is no name of a function`);
  return Object.entries(functions)
    .map(
      ([key, text]) => `export const ${key} = (() => {\n${text}\nreturn ${text.match(/^function (\w+)/)?.[1]};\n})();`,
    )
    .join("\n");
}

export class Modules {
  constructor(load = importText) {
    this.load = load;
    this.groups = new Map();
    this.waiting = new Map();
  }

  /** A group's functions, or undefined while they are not loaded. */
  get(key) {
    return this.groups.get(key);
  }

  /** Load a group from its texts, unless it is there. */
  prepare(key, texts) {
    if (!this.waiting.has(key)) {
      const loaded = this.load(moduleText(texts)).then(
        (module) => this.groups.set(key, module),
        (error) => {
          this.waiting.delete(key);
          const hint = "a content policy of the page must allow scripts from blob:";
          throw new Error(`the functions of "${key}" could not be loaded (${hint}): ${error.message}`);
        },
      );
      this.waiting.set(key, loaded);
    }
    return this.waiting.get(key);
  }
}
