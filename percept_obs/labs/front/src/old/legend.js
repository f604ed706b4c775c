// The legend: what each line is; the one that the hand or the focus is on stands out, and a press keeps it so.

import { button, element, listen } from "../ui/dom.js";
import { swatch } from "./line_styles.js";

export class Legend {
  constructor(lab) {
    this.lab = lab;
    this.body = element("ul", { class: "legend", "aria-label": "Lines" });
    this.key = "";
    /** @type {[string | number, string][]} */
    this.entries = [];
    /** @type {string | number | null} the line that stands out in the pictures that are drawn */
    this.drawn = null;
  }

  /** The line that was chosen to stand out, if it is there. */
  get chosen() {
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
    if (this.drawn !== this.chosen) this.update();
  }

  entry(which, text) {
    const choose = () => {
      this.lab.choose(which === this.chosen ? null : which);
      this.update();
    };
    const press = button("", choose, {
      ...{ class: "line-name", "data-control": "line", "data-line": which, title: "Let this line stand out" },
      "aria-pressed": String(which === this.chosen),
    });
    press.append(swatch(which), element("span", {}, text));
    listen(press, { "pointerenter focus": () => this.pick(which), "pointerleave blur": () => this.pick(this.chosen) });
    return press;
  }

  /** Bring the buttons and the pictures to what was chosen. */
  update() {
    const { chosen } = this;
    this.drawn = chosen;
    for (const press of this.body.querySelectorAll("button")) {
      press.setAttribute("aria-pressed", String(press.dataset.line === String(chosen)));
    }
    this.pick(chosen);
  }

  pick(which) {
    const { theme } = this.lab;
    if (!theme) return;
    const { ink, kept, lines, warning } = theme;
    const named = { truth: ink, kept, fit: lines[1], bound: lines[2], limit: warning };
    this.lab.pick(which === null ? null : (named[which] ?? lines[which]));
  }
}
