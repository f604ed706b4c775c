// A worker, made of the bundle that the page was made of, which computes while the page draws.

/** Syntax of modules, removed: from a page on a disk browsers make a worker of a script only. */
const OF_MODULES = /export\s*\{[^{}]*\};?\s*$|\bimport\.meta\.url\b/g;

/**
 * Open a worker for a lab; marimo gives a lab no bundle, and there it is made of the module that this page imported.
 *
 * @param {any} widget  with the traits `_esm`, `kind`, `texts` and `model`
 * @param {object} on
 * @param {(ask: (task: any) => void) => void} on.ready  is given the function that sends a task
 * @param {(answer: any) => void} on.answer
 * @param {() => void} [on.gone]  the page's content policy forbids workers, or the browser knows none of modules
 */
export function openWorker(widget, { ready, answer, gone = () => {} }) {
  const [bundle, kind, texts, model] = ["_esm", "kind", "texts", "model"].map((trait) => widget.get(trait));
  const script = bundle?.replace(OF_MODULES, '""');
  const address = script ? URL.createObjectURL(new Blob([script], { type: "text/javascript" })) : import.meta.url;
  const worker = new Worker(address, { name: "results", type: script ? "classic" : "module" });
  worker.onerror = (event) => {
    event.preventDefault();
    worker.terminate();
    gone();
  };
  worker.onmessage = ({ data }) => {
    if (!data.ready) return answer(data);
    URL.revokeObjectURL(address);
    return ready((task) => worker.postMessage(task));
  };
  worker.postMessage({ kind, texts, model });
  return worker;
}
