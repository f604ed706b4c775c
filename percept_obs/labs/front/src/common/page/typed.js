// @ts-check
// A field for an expression, which Python reads and prints for the page: nothing typed is ever run as it stands.

import { element } from "./controls.js";

const PATIENCE = 4000;
let count = 0;

/**
 * A field whose text takes effect once Python has read it; what it says of a text that it cannot read stands below.
 *
 * @param {any} lab
 * @param {{name: string, label: string, hint: string, most: number, prefix?: string, get: () => string, set: (text: string) => void}} parts
 */
export function typedField(lab, { name, label, hint, most, prefix = "", get, set }) {
  const { widget, model } = lab;
  const id = `percept-typed-${++count}`;
  const said = element("p", { class: "refusal", id: `${id}-said`, role: "status", hidden: true });
  const box = element("input", {
    ...{ type: "text", id, maxlength: most, placeholder: hint, autocomplete: "off", spellcheck: "false" },
    ...{ "data-control": name, "aria-describedby": `${id}-said` },
  });
  const row = element("div", { class: "expression" }, element("label", { for: id }, label), box, said);
  let waiting = /** @type {string | null} */ (null);
  let timer = /** @type {any} */ (0);

  const tell = (text, wrong) => {
    said.textContent = text;
    said.hidden = !text;
    box.setAttribute("aria-invalid", String(wrong));
  };

  const settle = (text) => {
    const answer = model.written[text];
    waiting = null;
    clearTimeout(timer);
    if (answer.source) {
      tell("", false);
      set(text);
      return;
    }
    tell(answer.refusal, true);
    if (answer.position !== null) box.setSelectionRange(answer.position, answer.position + 1);
  };

  const take = () => {
    const typed = box.value.trim();
    const text = typed && !typed.includes("=") ? prefix + typed : typed;
    if (text === get()) return tell("", false);
    if (!text) {
      tell("", false);
      return set("");
    }
    if (model.written[text]) return settle(text);
    clearTimeout(timer);
    if (!widget.save_changes) return tell("Python reads what is typed, and this page has none: open the lab in a notebook.", true);
    waiting = text;
    timer = setTimeout(() => tell("Python reads what is typed, and it does not answer: it is busy or gone. The numbers still move the point.", false), PATIENCE);
    widget.set("asked", text);
    widget.save_changes();
    return undefined;
  };

  const heard = () => {
    Object.assign((model.written ??= {}), widget.get("written"));
    if (waiting !== null && model.written[waiting]) settle(waiting);
  };
  heard();
  widget.on("change:written", heard);
  box.addEventListener("change", take);
  box.addEventListener("keydown", (event) => event.key === "Enter" && take());
  const show = () => {
    if (document.activeElement !== box && waiting === null) box.value = get();
  };
  const close = () => {
    clearTimeout(timer);
    widget.off("change:written", heard);
  };
  return { row, show, parts: [box], name, close };
}
