// The result of the latest settings, and of the run that is kept beside it; each is computed once.

/** Runs an engine, and a second one for the kept run, which seldom changes. */
export class Results {
  constructor(kernels, makeEngine) {
    this.kernels = kernels;
    this.engines = [makeEngine(), makeEngine()];
    /** @type {any[]} */
    this.found = [null, null];
  }

  /** Result of settings and of their kept run; whole, or as far as it is drawn. */
  of(settings, whole) {
    const { kept } = settings;
    const ghost = kept ? this.find(1, kept, true) : null;
    const possible = ghost && !ghost.problem && !ghost.refusal;
    return { shown: this.find(0, settings, whole), ghost: possible ? ghost : null };
  }

  find(which, settings, whole) {
    const found = this.found[which];
    const engine = this.engines[which];
    const there = found?.settings === settings;
    if (there && (found.whole || !whole)) return found;
    const functions = this.kernels.of(settings);
    return (this.found[which] = there ? engine.completed(found, functions) : engine.run(settings, functions, whole));
  }
}
