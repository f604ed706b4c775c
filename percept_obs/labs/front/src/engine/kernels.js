// @ts-check
// The functions that settings need, made from the texts that were printed for them.

import { Modules } from "./modules.js";

/**
 * @typedef {{key: string, texts: Record<string, string>, observer?: string, aside?: boolean, refusal?: string}} Module
 */

/**
 * Settings without the observers that are refused, and why those went; one that always exists takes the place of all.
 */
export function withoutRefused(settings, refused, observers, always) {
  const lost = settings.observers.filter((name) => refused[name]);
  if (!lost.length) return { settings, why: "" };
  const left = settings.observers.filter((name) => !refused[name]);
  const why = lost.map((name) => `The ${observers[name].title} observer was dropped: ${refused[name]}.`);
  return { settings: { ...settings, observers: left.length ? left : [always] }, why: why.join(" ") };
}

/** Functions of a model; those of a lab say which modules settings need. */
export class PrintedKernels {
  constructor(model, load) {
    this.model = model;
    this.modules = new Modules(load);
    const allowed = Object.entries(model.observers ?? {}).flatMap(([observer, { gains }]) =>
      gains.map((gain) => [`${observer}_${gain.name}`, gain.allowed]),
    );
    /** @type {Module[]} which gains are allowed: of all at once, so that none can be moved before that is known */
    this.limits = allowed.length ? [{ key: "gains", texts: Object.fromEntries(allowed), aside: true }] : [];
  }

  /** Names and texts of the modules that settings need, with the observer whose loop one is. */
  needed(_settings) {
    return /** @type {Module[]} */ ([]);
  }

  /** The functions that settings need, those of observers by their names; undefined while one is not loaded. */
  of(settings) {
    const found = { observers: {} };
    for (const { key, observer, aside } of [...this.limits, ...this.needed(settings)]) {
      const functions = this.modules.get(key);
      if (!functions) return undefined;
      if (observer) found.observers[observer] = functions;
      else if (!aside) Object.assign(found, functions);
    }
    return found;
  }

  /** Load what settings need. */
  async prepare(settings) {
    const wanted = [...this.limits, ...this.needed(settings)];
    const lacking = wanted.find(({ refusal }) => refusal);
    if (lacking) throw new Error(lacking.refusal);
    await Promise.all(wanted.map(({ key, texts }) => this.modules.prepare(key, texts)));
  }

  /** The module of an observer's loop, without what it has no need of. */
  loop(key, observer, { run, start, estimate, variances, gap, fastest }) {
    const texts = Object.entries({ run, start, estimate, variances, gap, fastest }).filter(([, text]) => text);
    return { key, observer, texts: Object.fromEntries(texts) };
  }

  /** True if an observer's gain may have this value. */
  allows(observer, gain, value) {
    return this.modules.get("gains")?.[`${observer}_${gain}`]([value], [0])[0] === 1;
  }
}
