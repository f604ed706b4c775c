// The legend: what each line is; the one that the hand or the focus is on stands out, and a press keeps it so.

import { button, element } from "./controls.js";
import { swatch } from "./lines.js";

export class Legend {
  constructor(lab) {
    this.lab = lab;
    this.body = element("ul", { class: "legend", "aria-label": "Lines" });
    this.key = "";
    /** @type {[string | number, string][]} */
    this.entries = [];
    /** @type {string | number | null} the line that stands out in the pictures, as far as they are drawn */
    this.said = null;
  }

  /** The line that was chosen to stand out, if it is there. */
  get kept() {
    const { picked } = this.lab.state.now;
    return this.entries.some(([which]) => which === picked) ? picked : null;
  }

  show(entries) {
    const key = JSON.stringify(entries);
    if (key !== this.key) {
      this.key = key;
      this.entries = entries;
      this.body.replaceChildren(...entries.map(([which, text]) => element("li", {}, this.entry(which, text))));
    }
    if (this.said !== this.kept) this.say();
  }

  entry(which, text) {
    const said = { class: "line-name", "data-control": "line", title: "Let this line stand out", "aria-pressed": String(which === this.kept) };
    const press = button("", () => this.keep(which), said);
    press.append(swatch(which), element("span", {}, text));
    press.dataset.line = which;
    for (const type of ["pointerenter", "focus"]) press.addEventListener(type, () => this.pick(which));
    for (const type of ["pointerleave", "blur"]) press.addEventListener(type, () => this.pick(this.kept));
    return press;
  }

  keep(which) {
    this.lab.choose(which === this.kept ? null : which);
    this.say();
  }

  /** Bring the buttons and the pictures to what was chosen. */
  say() {
    this.said = this.kept;
    for (const press of this.body.querySelectorAll("button")) press.setAttribute("aria-pressed", String(press.dataset.line === String(this.kept)));
    this.pick(this.kept);
  }

  pick(which) {
    const { theme } = this.lab;
    if (!theme) return;
    const named = { truth: theme.ink, kept: theme.kept, fit: theme.lines[1], bound: theme.lines[2], limit: theme.warning };
    this.lab.pick(which === null ? null : (named[which] ?? theme.lines[which]));
  }
}
