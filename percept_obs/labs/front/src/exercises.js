// Exercises in a page of the site: a field before each folded answer, which unfolds once something has been typed.
// A formula is judged by numbers while it is typed, as at the derivation desk.

import { button, element, formula, setText } from "./draw/dom.js";
import { answerTo } from "./labs/desk/model/answers.js";
import { Sheet } from "./labs/desk/model/sheet.js";

const LABELS = {
  words: "Your answer, in a sentence",
  formula: "Your formula",
  choice: "Your choice",
  values: "Your answer",
};
const MARKS = { right: "✓ right", begun: "… right so far", wrong: "✗ not right yet", unknown: "? cannot be told" };
/** Milliseconds without typing after which what is not right is said. */
const PAUSE = 1000;
/** Quotes around a formula, as Python has them. */
const QUOTES = /^["'\s]+|["'\s]+$/g;

let count = 0;

/** A field with its label; Return in a line of its own compares. */
function fieldOf(label, rows, onchange, compare) {
  const id = `own-answer-${++count}`;
  const field = /** @type {HTMLTextAreaElement} */ (
    element("textarea", { id, rows, spellcheck: rows > 1, autocomplete: "off", oninput: onchange })
  );
  field.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" || (rows > 1 && !event.ctrlKey && !event.metaKey)) return;
    event.preventDefault();
    compare();
  });
  return { field, row: element("p", {}, element("label", { for: id }, ...label), field) };
}

/** Lines of a formula, each with the same as mathematics and what is found of it. */
function linesOf(printed, onchange, compare) {
  const judge = new Sheet(printed, {}, printed.said);
  const keys = judge.keys("");
  let resting = 0;
  const lines = judge.lines.map(({ label }) => {
    const left = [LABELS.formula, label ? formula("span", `<mo>:</mo>${label}<mo>=</mo>`) : ""];
    const parts = fieldOf(left, 1, () => changed(false), compare);
    const shown = element("p", { class: "read" });
    const found = element("p", { class: "found", role: "status" });
    parts.row.after(shown);
    return { ...parts, shown, found };
  });
  /** Show what is typed; what is not right is said when nobody types any more. */
  function changed(calm) {
    clearTimeout(resting);
    if (!calm) resting = window.setTimeout(() => changed(true), PAUSE);
    const typed = Object.fromEntries(lines.map(({ field }, k) => [keys[k], field.value.replace(QUOTES, "")]));
    const answer = answerTo(judge, { part: "", step: 1, typed, hints: {}, outputs: [], point: [0, 0, 1] }, true);
    answer.lines.forEach(({ pieces, mark, told, refusal }, k) => {
      const { shown, found } = lines[k];
      shown.replaceChildren(...pieces.map((piece) => formula("span", piece, {}, true)));
      const hints = told.map((parts) => element("span", {}, "; ", ...parts.map(wordOf)));
      if (refusal && calm) found.replaceChildren(refusal);
      else if (mark === "right" || (calm && mark)) found.replaceChildren(MARKS[mark], ...hints);
      else found.replaceChildren();
    });
    onchange();
  }
  return lines;
}

const wordOf = ({ text, math }) => (math === undefined ? text : formula("span", math));

/** Put fields before a folded answer, which stays hidden until then. */
function ask(/** @type {HTMLDetailsElement} */ answer) {
  const { kind = "words", right = "", options = "" } = answer.dataset;
  const printed = JSON.parse(answer.querySelector("script")?.textContent ?? "null");
  const said = element("span", { class: "said", role: "status" });
  const unfold = (words) => {
    Object.assign(answer, { hidden: false, open: true });
    setText(said, words);
  };
  const place = element("div", { class: "own", role: "group", "aria-label": LABELS[kind] });
  if (kind === "choice") {
    const choose = (letter) => {
      for (const each of place.querySelectorAll("button")) each.ariaPressed = String(each.textContent === letter);
      unfold(letter === right ? `✓ Yes, ${letter}.` : `You said ${letter}, the experiment says ${right}.`);
    };
    const buttonOf = (letter) => button(letter, () => choose(letter), { "aria-pressed": "false" });
    place.append(`${LABELS.choice}: `, ...options.split(" ").map(buttonOf), said);
  } else {
    const filled = () => fields.some(({ field }) => field.value.trim());
    const compare = () => filled() && unfold("The answer is open below.");
    const onchange = () => (go.disabled = !filled());
    const go = /** @type {HTMLButtonElement} */ (button("Compare", compare, { disabled: true }));
    const fields = printed
      ? linesOf(printed, onchange, compare)
      : [fieldOf([LABELS[kind]], kind === "words" ? 3 : 1, onchange, compare)];
    for (const { row, shown, found } of fields) place.append(row, ...(shown ? [shown, found] : []));
    place.append(element("p", {}, go, said));
  }
  answer.hidden = true;
  answer.before(place);
}

/** @type {NodeListOf<HTMLDetailsElement>} */ (document.querySelectorAll("details.asked")).forEach(ask);
