// The drawer beside the pictures: groups that fold, of which one is open at a time.

import { button, element, setItems, setText } from "../draw/dom.js";
import { tick } from "./controls.js";
import { historyButtons } from "./messages.js";

const NO_CLIPBOARD = "The browser does not let the lab copy; select the lines below.";
/** Name of the state in which the drawer is open and all groups are folded. */
const FOLDED = "folded";

/**
 * @typedef {object} Group
 * @property {string} name    by which the page's address knows it
 * @property {string} title
 * @property {Node[]} inside
 * @property {() => void} [show]  brings it to what is shown, while it is open
 */

export class Drawer {
  /**
   * @param {any} lab
   * @param {import("./fieldsets.js").Fieldsets} panel  the controls of all groups
   * @param {Group[]} groups  those of the lab itself
   */
  constructor(lab, panel, groups, messages) {
    this.lab = lab;
    this.panel = panel;
    this.messages = messages;
    this.history = historyButtons(lab);
    this.code = element("pre", { class: "code", hidden: true, tabindex: 0 });
    this.write = () => "";
    this.keep = button("Keep", () => lab.keep(), {
      ...{ "data-control": "keep", "aria-pressed": "false", title: "Keep this run to compare with" },
    });
    /** @type {Group[]} */
    this.groups = [...groups, ...this.own()];
    /** What is open when the drawer opens again. */
    this.last = this.groups[0].name;
    this.folds = this.groups.map(({ name, title, inside }) => {
      const summary = element("summary", { "data-control": `group ${name}` }, title);
      // The view says which is open, so that it can be sent and saved.
      summary.addEventListener("click", (event) => {
        event.preventDefault();
        lab.unfold(lab.state.view.more === name ? FOLDED : name);
      });
      return element("details", { class: `group group-${name}` }, summary, ...inside);
    });
    this.more = button("More", () => lab.unfold(lab.state.view.more ? "" : this.last), {
      ...{ class: "link", "data-control": "more", "aria-expanded": "false" },
    });
    this.body = element(
      "aside",
      { class: "drawer", "aria-label": "More controls", hidden: true },
      this.actions(),
      messages.said,
      this.code,
      ...this.folds,
    );
  }

  actions() {
    const { lab, history, keep } = this;
    const copy = button("Copy code", () => this.copyCode(), {
      ...{ "data-control": "copy code", title: "Python code of this run" },
    });
    const link = button("Link", () => this.copyLink(), {
      ...{ "data-control": "copy link", title: "The address of this page, with the settings of this lab" },
    });
    return element("div", { class: "actions" }, history.undo, history.redo, keep, copy, ...(lab.address ? [link] : []));
  }

  copyCode() {
    return this.copy(() => this.lab.copy(), "Python code of this run", "Copied: paste it into a cell.");
  }

  copyLink() {
    const then = window.location.protocol === "file:" ? "it opens where this file is" : "it opens the lab as it is now";
    return this.copy(() => this.lab.address.link(), "Link to this lab as it is now", `Copied: ${then}.`);
  }

  /** Copy a text, which stands there as long as it is of what is shown. */
  async copy(write, label, then) {
    const { code, messages } = this;
    const text = write();
    this.write = write;
    code.textContent = text;
    code.setAttribute("aria-label", label);
    code.hidden = false;
    try {
      await navigator.clipboard.writeText(text);
      messages.say(then);
    } catch {
      messages.say(NO_CLIPBOARD);
    }
  }

  /** The groups that every lab has: charts, words, equations, symbols. */
  own() {
    const { lab } = this;
    const [verdicts, why, analysis] = ["verdicts", "why", "analysis"].map((name) => element("ul", { class: name }));
    const speak = () => {
      const { verdicts: told, reasons } = lab.told();
      setItems(verdicts, told.map(({ title, text }) => `${title}: ${text}`));
      setItems(why, reasons);
      const answer = lab.answered();
      setItems(analysis, (answer?.sentences ?? []).filter(Boolean));
    };
    return [
      { name: "charts", title: "Charts", inside: [this.charts(), ...this.panel.of("charts")] },
      { name: "words", title: "In words", inside: [verdicts, why, analysis], show: speak },
      {
        ...{ name: "equations", title: "Equations", inside: [lab.formulas.body] },
        show: () => lab.formulas.show(lab.shown.settings),
      },
      { name: "symbols", title: "Symbols and words", inside: [symbolTable(lab.parts.symbols)] },
    ];
  }

  /** Boxes to tick for charts below the first, and buttons for the part of the time that they show. */
  charts() {
    const { lab } = this;
    const boxes = Object.entries(lab.parts.charts).map(([name, label]) =>
      tick({
        ...{ name: `chart ${name}`, label },
        get: () => lab.state.view.charts.includes(name),
        set: (on) => lab.showChart(name, on),
      }),
    );
    this.boxes = boxes;
    const zoom = (sign, name, title, press) =>
      button(sign, press, { "data-control": name, "aria-label": title, title });
    const zooms = [
      zoom("−", "zoom out", "Show more of the time", () => lab.zoom(2)),
      zoom("+", "zoom in", "Show less of the time", () => lab.zoom(0.5)),
      zoom("All", "zoom whole", "Show all of the time", () => lab.showAll()),
    ];
    return element("div", {}, ...boxes.map(({ row }) => row), element("div", { class: "buttons" }, "Time:", ...zooms));
  }

  /** Bring the drawer to what is shown. */
  show() {
    const { lab, panel } = this;
    const { more } = lab.state.view;
    this.body.hidden = !more;
    this.more.setAttribute("aria-expanded", String(Boolean(more)));
    setText(this.more, more ? "Less" : "More");
    this.folds.forEach((fold, k) => (fold.open = this.groups[k].name === more));
    if (!more) return;
    this.last = more;
    this.history.show(lab.state);
    setText(this.keep, lab.settings.kept ? "Forget" : "Keep");
    this.keep.setAttribute("aria-pressed", String(Boolean(lab.settings.kept)));
    for (const box of this.boxes ?? []) box.show();
    panel.show();
  }

  /** Bring the words of the open group to what is shown. */
  speak() {
    const { lab } = this;
    if (!lab.state.view.more || !lab.shown || lab.shown.problem) return;
    this.groups.find(({ name }) => name === lab.state.view.more)?.show?.();
    this.code.hidden ||= this.code.textContent !== this.write();
  }
}

/** Table of symbols and their meaning. */
function symbolTable(entries) {
  const rows = entries.map(([symbol, meaning]) => {
    const term = element("th", { scope: "row" });
    term.innerHTML = symbol;
    return element("tr", {}, term, element("td", {}, meaning));
  });
  return element("table", { class: "symbols" }, ...rows);
}
