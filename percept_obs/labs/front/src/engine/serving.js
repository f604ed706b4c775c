// @ts-check
// The worker's side of computing beside the page: the same engines, and an answer to each message.

import { same } from "../state/settings.js";
import { modelOf } from "../state/texts.js";
import { Results } from "./results.js";

/**
 * Answer messages in a worker: the first one opens a lab, of which `computing` gives the classes by its kind; each of
 * the others has settings, and is answered by their result: whole, or as much as is drawn while a hand moves.
 */
export function serve(computing, scope) {
  /** @type {any} */
  let answer = null;

  async function open({ kind, texts, model: given }) {
    const model = await modelOf(texts, given);
    const { Kernels, Engine } = computing(kind);
    answer = answering(model, new Kernels(model), () => new Engine(model), scope);
    scope.postMessage({ ready: true });
  }

  scope.onmessage = ({ data }) =>
    (answer ?? open)(data).catch((error) => scope.postMessage({ error: error.message }));
}

function answering(model, kernels, makeEngine, scope) {
  const results = new Results(kernels, makeEngine);
  // No ghost yet, so that the first answer has one: the page may have found one by itself.
  /** @type {{settings: any, kept: any, ghost: any}} */
  const last = { settings: null, kept: null, ghost: undefined };
  return async ({ settings: copy, whole, written }) => {
    Object.assign((model.written ??= {}), written);
    // Messages are copies; what is known already is found by the very object.
    const settings = same(copy, last.settings) ? last.settings : copy;
    if (same(settings.kept, last.kept)) settings.kept = last.kept;
    Object.assign(last, { settings, kept: settings.kept });
    await Promise.all([settings, settings.kept].filter(Boolean).map((each) => kernels.prepare(each)));
    const { shown, ghost } = results.of(settings, whole);
    scope.postMessage({ shown: { ...shown, settings: null }, ...(ghost !== last.ghost && { ghost }) });
    last.ghost = ghost;
  };
}
