// The lines of a step: what is typed, the same as mathematics, and what is found of it.

import { button, element, formula, listen, setText } from "../../../draw/dom.js";

const MARKS = { right: "✓", begun: "…", wrong: "✗", carried: "↳", unknown: "?" };
const SAID = {
  ...{ right: "right", begun: "right so far", wrong: "not right" },
  ...{ carried: "right from there on", unknown: "cannot be told" },
};
/** Marks of lines after which the next one is asked for. */
const PASSED = ["right", "carried", "unknown"];
const INVITED = "Type here";
const UNFINISHED = "not complete yet";

let count = 0;

export class Sheet {
  constructor(lab) {
    this.lab = lab;
    /** @type {Line[]} */
    this.lines = [];
    this.key = "";
    this.list = element("div", { class: "sheet-lines" });
    this.words = element("p", { class: "sheet-words" });
    const open = () => lab.openHint(Number(this.hint.dataset.number));
    this.hint = button("", open, { "data-control": "hint", hidden: true });
    this.work = element("p", { class: "thinking", role: "status", hidden: true }, "Python is looking …");
    const found = element("div", { class: "found" }, this.words, this.hint, this.work);
    this.body = element("div", { class: "sheet" }, this.list, found);
  }

  /** Show what Python has found; of a line whose text is newer only that it is being looked at. */
  show(answer, current) {
    const key = JSON.stringify(answer.lines.map((line) => line.key));
    if (key !== this.key) {
      this.key = key;
      this.lines = answer.lines.map((line) => new Line(this.lab, line));
      this.list.replaceChildren(...this.lines.map(({ row }) => row));
    }
    const { calm } = this.lab;
    const open = this.lab.face === "workbench" ? this.lines.length : openOf(answer.lines);
    this.lines.forEach((line, k) => {
      line.row.hidden = k >= open;
      line.show(answer.lines[k], calm);
    });
    const said = current && (calm || answer.right);
    setText(this.words, said ? answer.words : "");
    this.words.className = `sheet-words ${said && answer.right ? "right" : ""}`;
    this.body.classList.toggle("waiting", !current);
    // It stays where it is while somebody types, or the focus and the lines below would jump.
    if (!calm || !current) return;
    const focused = this.hint === document.activeElement;
    this.hint.hidden = !answer.hint;
    this.hint.dataset.number = answer.hint;
    setText(this.hint, `Hint: ${answer.says}`);
    if (focused && !answer.hint) this.lines.at(-1)?.field.focus({ preventScroll: true });
  }

  thinking(on) {
    this.work.hidden = !on;
  }

  /** The findings in words, for a screen reader. */
  told(answer) {
    const lines = this.lines.map((line, k) => line.told(answer.lines[k])).filter(Boolean);
    return [answer.words, ...lines].filter(Boolean).join(" ");
  }
}

class Line {
  constructor(lab, { key, name, label }) {
    this.lab = lab;
    this.key = key;
    this.name = name;
    const id = `percept-line-${++count}`;
    this.field = element("textarea", {
      ...{ id, rows: 1, maxlength: lab.schema.typed.of.most, "data-control": `line ${key}`, placeholder: "Type here" },
      ...{ spellcheck: "false", autocapitalize: "off", autocomplete: "off", autocorrect: "off" },
      "aria-describedby": `${id}-found`,
    });
    listen(this.field, {
      input: () => lab.type(key, this.field.value.replace(/\s*\n\s*/g, " ")),
      focus: () => lab.choose(key),
      blur: () => lab.rest(),
      keydown: (event) => {
        if (event.key !== "Enter") return;
        event.preventDefault();
        lab.rest();
      },
    });
    const words = label
      ? [formula("span", label, { "aria-hidden": "true" }), element("span", { class: "unseen" }, name)]
      : [name];
    this.mark = element("span", { class: "mark", role: "img" });
    this.formula = element("div", { class: "as-typed", role: "group", "aria-label": `${name} as mathematics` });
    this.state = element("p", { class: "state", id: `${id}-found` });
    this.hints = element("ul", { class: "told" });
    this.row = element(
      "div",
      { class: label ? "typed" : "typed wordy" },
      element("label", { for: id }, ...words),
      element("div", { class: "entry" }, this.field, this.mark),
      element("div", { class: "beneath" }, this.formula, this.state, this.hints),
    );
    this.markup = this.hinted = this.measured = this.grown = "";
  }

  show(found, calm) {
    const { at, part, line: { key } } = this.lab.replay;
    const played = at !== null && key === this.key;
    const whole = this.lab.settings.typed[this.key] ?? "";
    const text = played ? whole.slice(0, at) : whole;
    if (this.field.value !== text) this.field.value = text;
    const mine = this.lab.isOf(this.key);
    this.row.classList.toggle("late", !mine);
    const markup = played ? (part?.markup ?? "") : found.markup;
    if (mine && this.markup !== markup) {
      this.markup = markup;
      this.formula.replaceChildren(...inPieces(markup));
    }
    this.fit(text, markup);
    if (played) {
      this.mark.hidden = true;
      setText(this.state, "");
      this.state.classList.remove("pill");
      this.tell([]);
      return;
    }
    const mark = mine && (calm || PASSED[0] === found.mark) ? found.mark : "";
    setText(this.mark, MARKS[mark] ?? "");
    this.mark.className = `mark ${mark}`;
    if (mark) this.mark.setAttribute("aria-label", SAID[mark]);
    else this.mark.removeAttribute("aria-label");
    this.mark.hidden = !mark;
    const refused = Boolean(mine && found.refusal);
    this.field.setAttribute("aria-invalid", String(calm && refused));
    const invited = calm && found.mark !== "right" && text && !this.lab.byHand && this.lab.answer.hint === 2;
    this.state.classList.toggle("pill", invited);
    if (calm && refused) this.refuse(found, text);
    else setText(this.state, refused ? UNFINISHED : invited ? INVITED : "");
    this.tell(mine ? found.told : []);
  }

  /** Let the field be as high as its text, and a keyboard reach a formula that is wider than its place. */
  fit(text, markup) {
    const { width, face } = this.lab;
    const seen = [width, face, this.row.hidden, text].join(" ");
    if (seen !== this.grown) {
      this.grown = seen;
      this.field.style.height = "auto";
      this.field.style.height = `${this.field.scrollHeight + 2}px`;
    }
    const shown = `${width} ${markup}`;
    if (shown === this.measured) return;
    this.measured = shown;
    const { scrollWidth, clientWidth } = this.formula;
    if (scrollWidth > clientWidth) this.formula.setAttribute("tabindex", "0");
    else this.formula.removeAttribute("tabindex");
  }

  /** Say why a text cannot be read, with the place in it. */
  refuse({ refusal, position }, text) {
    const at = Math.min(position, text.length);
    const place = element("mark", {}, text.slice(at, at + 1) || " ");
    const quoted = element("code", {}, text.slice(Math.max(0, at - 30), at), place, text.slice(at + 1, at + 20));
    const said = `${quoted.textContent} ${refusal}`;
    if (this.state.textContent !== said) this.state.replaceChildren(quoted, ` ${refusal}`);
  }

  /** Hints, in words and mathematics. */
  tell(sentences) {
    const key = JSON.stringify(sentences);
    if (key === this.hinted) return;
    this.hinted = key;
    this.hints.replaceChildren(...sentences.map((pieces) => element("li", {}, ...pieces.map(pieceOf))));
  }

  told(found) {
    if (found.refusal) return `${this.name}: ${found.refusal}.`;
    if (!found.mark) return "";
    const hints = [...this.hints.children].map((item) => ` ${item.textContent}.`);
    return `${this.name}: ${SAID[found.mark]}.${hints.join("")}`;
  }
}

/** How many lines the first screen shows: up to the first that is not passed, and all that are typed. */
function openOf(lines) {
  const next = lines.findIndex(({ mark }) => !PASSED.includes(mark));
  const typed = lines.findLastIndex(({ markup, refusal }) => markup || refusal);
  return Math.max(next < 0 ? lines.length : next + 1, typed + 1);
}

function pieceOf({ text, math }) {
  return math === undefined ? text : formula("span", math);
}

/** A sum in pieces, a formula for each term, so that it goes on in the next line where its place is narrow. */
function inPieces(markup) {
  if (!markup) return [];
  const whole = formula("div", markup);
  /** @type {Element[][]} */
  const pieces = [[]];
  for (const node of [...whole.querySelectorAll("math > mrow > *")]) {
    const before = pieces.at(-1) ?? [];
    if (isSign(node) && before.length && !isSign(before[before.length - 1])) {
      node.setAttribute("form", "infix");
      pieces.push([]);
    }
    pieces.at(-1)?.push(node);
  }
  return pieces.map((nodes) => {
    const piece = formula("span", "", {}, true);
    piece.firstElementChild?.append(...nodes);
    return piece;
  });
}

function isSign(node) {
  return node.localName === "mo" && "+−=".includes(node.textContent);
}
