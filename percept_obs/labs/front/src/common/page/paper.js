// @ts-check
// A lab on paper: when its page is printed, the pictures as they are, what is said of them, a question, the settings.

import { element } from "./controls.js";

/** Points of a picture to one of the screen: paper shows more than a screen does. */
const SHARPNESS = 3;
/** Height of a page, below a title, in points of the screen: of A4 and of US Letter. */
const HEIGHT = 880;
/** Of a line to write on. */
const LINE = 26;
const FEWEST_LINES = 3;
const FREE = { question: "What do you see, and why is it so?", answers: [] };

/** Puts a lab on one page of paper while it is printed. */
export class Paper {
  constructor(lab, presets) {
    this.lab = lab;
    this.presets = presets;
    this.body = element("div", { class: "on-paper" });
    this.dark = false;
    /** @type {any[]} of the pictures on the screen */
    this.sizes = [];
    this.listeners = { beforeprint: () => this.take(), afterprint: () => this.leave() };
    for (const [event, listener] of Object.entries(this.listeners)) window.addEventListener(event, listener);
  }

  take() {
    const { lab, body } = this;
    const { root } = lab.view;
    const space = element("div", {}, ...Array.from({ length: FEWEST_LINES }, line));
    body.replaceChildren(...this.question(), space, element("h4", {}, "Settings"), settingsOf(lab.panel.body), ...this.link());
    this.dark = root.classList.contains("dark");
    root.classList.add("sheet");
    root.classList.remove("dark");
    root.append(body);
    const left = HEIGHT - root.offsetHeight;
    space.append(...Array.from({ length: Math.max(0, Math.floor(left / LINE)) }, line));
    root.style.zoom = String(Math.min(1, HEIGHT / root.offsetHeight));
    this.sizes = lab.figures.map(({ size }) => size);
    this.draw(SHARPNESS, lab.figures.map(({ figure }) => ({ width: figure.clientWidth, height: figure.clientHeight })));
  }

  leave() {
    const { root } = this.lab.view;
    this.body.remove();
    root.classList.remove("sheet");
    root.classList.toggle("dark", this.dark);
    root.style.zoom = "";
    this.draw(undefined, this.sizes);
  }

  /** Draw the pictures for other sizes and colours, now. */
  draw(sharpness, sizes) {
    const { lab } = this;
    lab.figures.forEach((picture, k) => Object.assign(picture, { sharpness, size: sizes[k] }));
    lab.retheme();
    lab.paint();
  }

  /** The question that is open, or one that fits everywhere. */
  question() {
    const { question, answers } = this.presets.find(({ name }) => name === this.lab.state.preset?.name) ?? FREE;
    const boxes = answers.map((answer) => element("li", {}, "☐ ", answer));
    return [element("h4", {}, "Question"), element("p", {}, question), element("ul", {}, ...boxes)];
  }

  /** Where the lab opens as it is on the paper; of a page that is a file, what follows its name. */
  link() {
    const link = this.lab.address?.link();
    return link ? [element("p", { class: "address" }, `Open the lab with ${link.replace(/^file:[^#]*/, "")}`)] : [];
  }

  close() {
    for (const [event, listener] of Object.entries(this.listeners)) window.removeEventListener(event, listener);
  }
}

const line = () => element("div", { class: "ruled", style: `height: ${LINE}px` });

/** What the controls of a panel say, as far as they have a meaning now: a table of names and values. */
function settingsOf(panel) {
  const rows = [...panel.querySelectorAll(".ticked, .control, .observers, .choices, .expression, .span")].filter((row) => !row.closest("[hidden]")).map(said);
  const told = rows.filter(([name, value]) => name && value).map(([name, value]) => element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, value)));
  return element("table", { class: "set" }, ...told);
}

/** What one control is called, and what it says. */
function said(row) {
  const boxes = [...row.querySelectorAll("input:is([type=checkbox], [type=radio])")];
  const fields = [...row.querySelectorAll("input:is([type=number], [type=text]), select")];
  const values = fields.map((field) => field.selectedOptions?.[0].textContent ?? field.value);
  const ticked = boxes.filter((box) => box.checked).map((box) => box.closest("label").textContent.trim());
  // The last part of a label is its words; a letter may stand before them.
  const name = row.getAttribute("aria-label") ?? row.querySelector("label")?.lastChild.textContent ?? "";
  const whose = row.closest(".gains-of, .one, .unknowns")?.getAttribute("aria-label").replace(/^Gains of /, "");
  return [whose ? `${name}, ${whose}` : name, (boxes.length ? ticked : values).join(", ")];
}
