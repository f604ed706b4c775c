// @ts-check
// A field for an expression, which Python reads and prints for the page: nothing typed is ever run as it stands.

import { nextId } from "../ui/controls.js";
import { element, setOptionalText } from "../ui/dom.js";

const PATIENCE = 4000;
const NO_PYTHON = "Python reads what is typed, and this page has none: open the lab in a notebook.";
const NO_ANSWER =
  "Python reads what is typed, and it does not answer: it is busy or gone. The numbers still move the point.";

/**
 * A field whose text takes effect once Python has read it; why it cannot read a text stands below.
 *
 * @param {any} lab
 * @param {Record<string, any>} options  a schema's `label` and `most`, `hint`, `prefix` of a text without "=", get, set
 */
export function typedField(lab, { name, label, hint, most, prefix, get, set }) {
  const { widget, model } = lab;
  const id = nextId();
  const refusal = element("p", { class: "refusal", id: `${id}-said`, role: "status", hidden: true });
  const box = element("input", {
    ...{ type: "text", id, maxlength: most, placeholder: hint, autocomplete: "off", spellcheck: "false" },
    ...{ "data-control": name, "aria-describedby": `${id}-said` },
    onchange: () => take(),
    onkeydown: (event) => event.key === "Enter" && take(),
  });
  const row = element("div", { class: "expression" }, element("label", { for: id }, label), box, refusal);
  let waiting = /** @type {string | null} */ (null);
  let timer = /** @type {any} */ (0);

  const tell = (text, wrong) => {
    setOptionalText(refusal, text);
    box.setAttribute("aria-invalid", String(wrong));
  };
  const accept = (text) => {
    tell("", false);
    if (text !== get()) set(text);
  };
  const answered = (text) => {
    const answer = model.written[text];
    waiting = null;
    clearTimeout(timer);
    if (answer.source) return accept(text);
    tell(answer.refusal, true);
    if (answer.position !== null) box.setSelectionRange(answer.position, answer.position + 1);
    return undefined;
  };
  const take = () => {
    const typed = box.value.trim();
    const text = typed && !typed.includes("=") ? prefix + typed : typed;
    if (!text || text === get()) return accept(text);
    if (model.written[text]) return answered(text);
    clearTimeout(timer);
    if (!widget.save_changes) return tell(NO_PYTHON, true);
    waiting = text;
    timer = setTimeout(() => tell(NO_ANSWER, false), PATIENCE);
    widget.set("asked", text);
    widget.save_changes();
    return undefined;
  };
  const hear = () => {
    Object.assign((model.written ??= {}), widget.get("written"));
    if (waiting !== null && model.written[waiting]) answered(waiting);
  };
  hear();
  widget.on("change:written", hear);
  const show = () => {
    if (document.activeElement !== box && waiting === null) box.value = get();
  };
  const close = () => {
    clearTimeout(timer);
    widget.off("change:written", hear);
  };
  return { row, show, parts: [box], name, close };
}
