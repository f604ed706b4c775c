// @ts-check
// The worker's side of computing beside the page: the same engines, and an answer to each message.

import { packed } from "./packing.js";
import { Results } from "./results.js";
import { same } from "./settings.js";
import { modelOf } from "./texts.js";

/** Answer messages; `computing` gives the Kernels and the Engine of a lab by its kind: the first one opens a lab, each of the others has settings, of which a result is sent back. */
export function serve(computing, scope) {
  const opened = { model: /** @type {any} */ (null), kernels: /** @type {any} */ (null), results: /** @type {any} */ (null) };
  /** @type {{settings: any, kept: any, ghost: any}} */
  const last = { settings: null, kept: null, ghost: null };
  /** @type {ArrayBuffer[]} those that came back */
  const rooms = [];

  async function open({ kind, texts, model: given }) {
    const { Kernels, Engine } = computing(kind);
    const model = (opened.model = await modelOf(texts, given));
    opened.kernels = new Kernels(model);
    opened.results = new Results(opened.kernels, () => new Engine(model));
    scope.postMessage({ ready: true });
  }

  async function answer({ settings: copy, whole, written, spare = [] }) {
    rooms.push(...spare);
    Object.assign((opened.model.written ??= {}), written);
    // Messages are copies; what is known already is found by the very object.
    const settings = same(copy, last.settings) ? last.settings : copy;
    if (same(settings.kept, last.kept)) settings.kept = last.kept;
    Object.assign(last, { settings, kept: settings.kept });
    await Promise.all([settings, settings.kept].filter(Boolean).map((each) => opened.kernels.prepare(each)));
    const { shown, ghost } = opened.results.of(settings, whole);
    const { data, room } = packed({ ...shown, settings: null }, rooms);
    scope.postMessage({ shown: data, room, ...(ghost !== last.ghost && { ghost }) }, [room]);
    last.ghost = ghost;
  }

  scope.onmessage = ({ data }) => {
    const done = "settings" in data ? answer(data) : open(data);
    done.catch((error) => scope.postMessage({ error: error.message }));
  };
}
