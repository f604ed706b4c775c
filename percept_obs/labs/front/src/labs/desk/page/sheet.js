// The lines of a step: what is typed, the same as mathematics, and what is found of it.

import { button, element, formula, listen, setText } from "../../../draw/dom.js";

/** Signs and words of marks; and marks of lines after which the next one is asked for. */
const MARKS = {
  ...{ "": ["", ""], right: ["✓", "right"], begun: ["…", "right so far"], wrong: ["✗", "not right"] },
  ...{ carried: ["↳", "right from there on"], unknown: ["?", "cannot be told"] },
};
const PASSED = ["right", "carried", "unknown"];

let count = 0;

export class Sheet {
  constructor(lab) {
    this.lab = lab;
    /** @type {Line[]} */
    this.lines = [];
    this.key = "";
    this.list = element("div", {});
    const open = () => lab.openHint(Number(this.hint.dataset.number));
    this.hint = button("", open, { "data-control": "hint", hidden: true });
    const work = element("p", { class: "looking", role: "status" }, "Python is looking …");
    this.body = element("div", {}, this.list, element("div", { class: "found" }, this.hint, work));
  }

  /** Show what is found of all lines that are asked for by now. */
  show(answer, current) {
    const key = JSON.stringify(answer.lines.map((line) => line.key));
    if (key !== this.key) {
      this.key = key;
      this.lines = answer.lines.map((line) => new Line(this.lab, line));
      this.list.replaceChildren(...this.lines.map(({ row }) => row));
    }
    const { calm, settings } = this.lab;
    const next = answer.lines.findIndex(({ mark }) => !PASSED.includes(mark));
    const typed = answer.lines.findLastIndex(({ key: name }) => settings.typed[name]);
    const open = Math.max(next < 0 ? this.lines.length : next + 1, typed + 1);
    this.lines.forEach((line, k) => {
      line.row.hidden = k >= open;
      line.show(answer.lines[k], calm);
    });
    // It stays where it is while somebody types, or the focus and the lines below would jump.
    if (!calm || !current) return;
    const focused = this.hint === document.activeElement;
    this.hint.hidden = !answer.hint;
    this.hint.dataset.number = answer.hint;
    setText(this.hint, answer.says ?? "");
    if (focused && !answer.hint) this.lines[open - 1].field.focus({ preventScroll: true });
  }

  /** The findings in words, for a screen reader. */
  told(answer) {
    return [answer.words, ...this.lines.map((line, k) => line.told(answer.lines[k]))].filter(Boolean).join(" ");
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
      ...{ spellcheck: "false", autocapitalize: "off", autocomplete: "off", "aria-describedby": `${id}-found` },
    });
    const enter = (event) => {
      event.preventDefault();
      lab.rest();
    };
    listen(this.field, {
      input: () => lab.type(key, this.field.value.replace(/\s*\n\s*/g, " ")),
      focus: () => lab.choose(key),
      blur: () => lab.rest(),
      keydown: (event) => event.key === "Enter" && enter(event),
    });
    const spoken = element("span", { class: "unseen" }, name);
    const words = label ? [formula("span", label, { "aria-hidden": "true" }), spoken] : [name];
    this.mark = element("span", { role: "img" });
    this.formula = element("div", { class: "as-typed", role: "group", "aria-label": `${name} as mathematics` });
    this.state = element("p", { class: "state", id: `${id}-found` });
    this.hints = element("ul", { class: "told" });
    const entry = element("div", { class: "entry" }, this.field, this.mark);
    const beneath = element("div", { class: "beneath" }, this.formula, this.state, this.hints);
    const asked = element("label", { for: id }, ...words);
    this.row = element("div", { class: label ? "typed" : "typed wordy" }, asked, entry, beneath);
    /** @type {Record<string, string>} */
    this.drawn = {};
  }

  /** True if something is not yet drawn as it is now. */
  isNew(name, ...parts) {
    const { [name]: before } = this.drawn;
    this.drawn[name] = JSON.stringify(parts);
    return this.drawn[name] !== before;
  }

  /** Show a line, or as much of it as is played. */
  show(found, calm) {
    const { at, part, line: { key } } = this.lab.replay;
    const played = at !== null && key === this.key;
    const text = (this.lab.settings.typed[this.key] ?? "").slice(0, played ? at : undefined);
    if (this.field.value !== text) this.field.value = text;
    this.write(played ? (part?.pieces ?? []) : found.pieces, text);
    const mark = !played && (calm || found.mark === PASSED[0]) ? found.mark : "";
    setText(this.mark, MARKS[mark][0]);
    Object.assign(this.mark, { className: `mark ${mark}`, hidden: !mark, ariaLabel: MARKS[mark][1] });
    const refusal = (!played && found.refusal) || "";
    this.field.ariaInvalid = String(Boolean(calm && refusal));
    const told = played ? [] : found.told;
    if (!this.isNew("state", refusal, calm, text, told)) return;
    const place = element("mark", {}, text.slice(found.position, found.position + 1) || " ");
    const quoted = element("code", {}, text.slice(Math.max(0, found.position - 30), found.position), place);
    this.state.replaceChildren(...(!refusal ? [] : calm ? [quoted, refusal] : ["not complete yet"]));
    const piece = ({ text: words, math }) => (math === undefined ? words : formula("span", math));
    this.hints.replaceChildren(...told.map((pieces) => element("li", {}, ...pieces.map(piece))));
  }

  /** Write the mathematics, let the field be as high as its text, and a keyboard reach what is too wide. */
  write(pieces, text) {
    if (this.isNew("formula", this.lab.width, pieces)) {
      this.formula.replaceChildren(...pieces.map((piece) => formula("span", piece, {}, true)));
      this.formula.tabIndex = this.formula.scrollWidth > this.formula.clientWidth ? 0 : -1;
    }
    if (!this.isNew("field", this.lab.width, this.row.hidden, text)) return;
    this.field.style.height = "auto";
    this.field.style.height = `${this.field.scrollHeight + 2}px`;
  }

  told({ refusal, mark }) {
    const hints = [...this.hints.children].map((item) => ` ${item.textContent}.`).join("");
    return refusal || mark ? `${this.name}: ${refusal ?? MARKS[mark][1]}.${hints}` : "";
  }
}
