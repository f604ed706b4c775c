// @ts-check
// The worker's side of computing beside the page: the same engines, and an answer to each message.

import { Results } from "./results.js";
import { same } from "../state/settings.js";
import { modelOf } from "../state/texts.js";
import { thinned } from "./thinned.js";

/**
 * Answer messages in a worker: the first one opens a lab, of which `computing` gives the classes by its kind, and what
 * `begin` makes of its model and these answers each of the others.
 */
export function answering(computing, scope, begin) {
  /** @type {any} */
  let answer = null;

  async function open({ kind, texts, model: given }) {
    const model = await modelOf(texts, given);
    const found = begin(model, computing(kind));
    answer = ({ written, ...task }) => {
      Object.assign((model.written ??= {}), written);
      return found(task);
    };
    scope.postMessage({ ready: true });
  }

  scope.onmessage = ({ data }) =>
    (answer ?? open)(data).catch((error) => scope.postMessage({ error: error.message }));
}

/** Answer settings by their result: all of it, or as much as is drawn while a hand moves. */
export function serve(computing, scope) {
  answering(computing, scope, (model, { Kernels, Engine }) => {
    const kernels = new Kernels(model);
    const results = new Results(kernels, () => new Engine(model));
    // No ghost yet, so that the first answer has one: the page may have found one by itself.
    /** @type {{settings: any, kept: any, ghost: any}} */
    const last = { settings: null, kept: null, ghost: undefined };
    return async ({ settings: copy, whole, sight }) => {
      // Messages are copies; what is known already is found by the very object.
      const settings = same(copy, last.settings) ? last.settings : copy;
      if (same(settings.kept, last.kept)) settings.kept = last.kept;
      Object.assign(last, { settings, kept: settings.kept });
      await Promise.all([settings, settings.kept].filter(Boolean).map((each) => kernels.prepare(each)));
      const { shown, ghost } = results.of(settings, whole);
      const drawn = whole ? shown : thinned(shown, sight);
      scope.postMessage({ shown: { ...drawn, settings: null }, ...(ghost !== last.ghost && { ghost }) });
      last.ghost = ghost;
    };
  });
}
