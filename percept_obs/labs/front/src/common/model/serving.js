// @ts-check
// The worker's side of computing beside the page: the same engines, and an answer to each message.

import { Memory } from "./memory.js";
import { packed } from "./packing.js";
import { Results } from "./results.js";
import { same } from "./settings.js";
import { modelOf } from "./texts.js";
import { thinned } from "./thinned.js";

/**
 * Answer messages; `computing` gives the Kernels and the Engine of a lab by its kind: the first one opens a lab, each
 * of the others has settings, of which a result is sent back: all of it, or as much as is drawn while a hand moves.
 */
export function serve(computing, scope) {
  const opened = {
    model: /** @type {any} */ (null),
    kernels: /** @type {any} */ (null),
    results: /** @type {any} */ (null),
  };
  // No ghost yet, so that the first answer has one: the page may have found one by itself.
  /** @type {{settings: any, kept: any, ghost: any}} */
  const last = { settings: null, kept: null, ghost: undefined };
  /** @type {ArrayBuffer[]} those that came back */
  const rooms = [];

  const memory = new Memory();
  const room = (part, length) => memory.room(part, length);

  async function open({ kind, texts, model: given }) {
    const { Kernels, Engine } = computing(kind);
    const model = (opened.model = await modelOf(texts, given));
    opened.kernels = new Kernels(model);
    opened.results = new Results(opened.kernels, () => new Engine(model));
    scope.postMessage({ ready: true });
  }

  async function answer({ settings: copy, whole, sight, written, spare = [] }) {
    rooms.push(...spare);
    Object.assign((opened.model.written ??= {}), written);
    // Messages are copies; what is known already is found by the very object.
    const settings = same(copy, last.settings) ? last.settings : copy;
    if (same(settings.kept, last.kept)) settings.kept = last.kept;
    Object.assign(last, { settings, kept: settings.kept });
    await Promise.all([settings, settings.kept].filter(Boolean).map((each) => opened.kernels.prepare(each)));
    const { shown, ghost } = opened.results.of(settings, whole);
    const drawn = whole ? shown : thinned(shown, sight, room);
    const { data, room: filled } = packed({ ...drawn, settings: null }, rooms);
    scope.postMessage({ shown: data, room: filled, ...(ghost !== last.ghost && { ghost }) }, [filled]);
    last.ghost = ghost;
  }

  scope.onmessage = ({ data }) => {
    const done = "settings" in data ? answer(data) : open(data);
    done.catch((error) => scope.postMessage({ error: error.message }));
  };
}
