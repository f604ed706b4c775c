// Computing beside the page: a worker, made of the bundle that the page was made of.

/** What a script may not have: a worker is made of the bundle as one, for browsers let a page from a disk have no other. */
const OF_MODULES = /export\s*\{[^{}]*\};?\s*$|\bimport\.meta\.url\b/g;

/**
 * Open a worker for a lab; `onReady` is called when it can be asked, `onAnswer` with each answer, and `onGone` if there is
 * none after all: where the page's content policy forbids workers from blob:, or a browser knows no workers of modules.
 *
 * marimo gives a lab no bundle; there the worker is made of the module that this page imported.
 *
 * @param {{bundle?: string, kind: string, texts: any, model: any}} lab
 * @param {{onReady: (worker: {ask: (task: any) => void}) => void, onAnswer: (answer: any) => void, onGone: () => void}} heard
 * @param {string} [name]  of what it is for: "maps", or the lab's results
 */
export function openBeside({ bundle, ...lab }, { onReady, onAnswer, onGone }, name = "results") {
  const script = bundle?.replace(OF_MODULES, '""');
  const address = script ? URL.createObjectURL(new Blob([script], { type: "text/javascript" })) : import.meta.url;
  const worker = new Worker(address, { name, type: script ? "classic" : "module" });
  worker.onerror = (event) => {
    event.preventDefault();
    worker.terminate();
    onGone();
  };
  worker.onmessage = ({ data }) => {
    if (!data.ready) return onAnswer(data);
    URL.revokeObjectURL(address);
    return onReady({ ask: (task) => worker.postMessage(task, task.spare) });
  };
  worker.postMessage(lab);
  return worker;
}
