// What the page says of Python and of itself, the way back, and the keys of a lab.

import { button, element, listen, setOptionalText, setText } from "../draw/dom.js";

const WAITING = "Python has not answered yet: it is computing, or its kernel has ended. The lab works without it.";
const GONE = "There is no Python here. The lab works without it; run its cell to have Python's sentences as well.";

/** Elements for what the page says of Python and of itself, with the functions that say it. */
export function messagesOf() {
  const paragraph = (className, role) => element("p", { class: className, role, hidden: true });
  const problem = paragraph("problem", "alert");
  const pythonError = paragraph("problem percept-obs-error", "alert");
  const silence = paragraph("silence", "status");
  const notice = paragraph("notice", "status");
  const said = element("span", { class: "said", role: "status" });
  const say = (text) => {
    setText(said, text);
    clearTimeout(said.timer);
    said.timer = setTimeout(() => setText(said, ""), 5000);
  };
  const functions = {
    say,
    notice: (text) => setOptionalText(notice, text),
    problem: (text) => setOptionalText(problem, text),
    pythonError: (text) => setOptionalText(pythonError, text && `Python says: ${text}`),
    silence: (error) => setOptionalText(silence, error === undefined ? "" : error ? GONE : WAITING),
  };
  return { problem, pythonError, silence, notice, said, say, functions };
}

/** Take the keys of undo and redo, and keep all from Jupyter, which has commands on arrows, letters and Enter. */
export function keys(root, lab) {
  // It looks for commands from the focus outwards up to this attribute, and finds some at the focus itself.
  root.addEventListener("focusin", ({ target }) => target.setAttribute("data-lm-suppress-shortcuts", "true"));
  root.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.key.toLowerCase() !== "z") return;
    event.preventDefault();
    if (event.shiftKey) lab.redo();
    else lab.undo();
  });
  listen(root, { "keydown keyup keypress": (event) => event.stopPropagation() });
}

/** The buttons of undo and redo, and the function that brings them to the history. */
export function historyButtons(lab) {
  const undo = button("Undo", () => lab.undo(), { "data-control": "undo", title: "Ctrl+Z" });
  const redo = button("Redo", () => lab.redo(), { "data-control": "redo", title: "Ctrl+Shift+Z" });
  const show = ({ past, future }) => {
    // Not disabled, which would take the focus away from the last step.
    undo.setAttribute("aria-disabled", String(!past.length));
    redo.setAttribute("aria-disabled", String(!future.length));
  };
  return { undo, redo, show };
}
