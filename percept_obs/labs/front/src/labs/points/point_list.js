// The points to drag: depth, when they are hidden, adding and removing.

import { isBeingTyped, slider, warning } from "../../ui/controls.js";
import { button, element, listen } from "../../ui/dom.js";
import { swatch } from "../../old/line_styles.js";

export class PointList {
  constructor(panel, most) {
    this.panel = panel;
    this.lab = panel.lab;
    this.most = most;
    this.rows = Array.from({ length: most }, (_, k) => this.row(k));
    this.add = button("Add a point", () => this.lab.addPoint(), { "data-control": "add point" });
    this.body = element("div", { class: "points" }, ...this.rows.map(({ node }) => node), this.add);
  }

  row(k) {
    const { lab, panel } = this;
    const there = () => k < lab.settings.points.length;
    const depth = slider({
      name: `depth ${k + 1}`,
      ...panel.schema.points.depth,
      most: panel.schema.points.most,
      get: () => (there() ? lab.depthOf(k) : undefined),
      set: (value) => lab.moveDepth(k, value),
      rest: () => lab.rest(),
    });
    const hide = element("input", { type: "checkbox", "data-control": `hide ${k + 1}` });
    hide.addEventListener("change", () => lab.hide(k, hide.checked ? lab.someTime() : null));
    const times = ["from", "to"].map((word, end) => this.time(k, word, end));
    const refused = warning({ least: 0, most: panel.schema.hidden.most, reason: "and the end after the beginning" });
    const attributes = { class: "span", role: "group", "aria-label": "not seen from, to, in s" };
    const span = element("div", attributes, "not seen", ...times.map(({ node }) => node), "s", refused.node);
    listen(span, { "input change": () => refused.tell(!span.querySelector("[aria-invalid=true]")) });
    const said = { "data-control": `remove ${k + 1}`, "aria-label": `remove point ${k + 1}` };
    const remove = button("×", () => lab.removePoint(k), { class: "remove", ...said });
    const hiding = element("label", { class: "choice" }, hide, element("span", {}, "hide"));
    const head = element("div", { class: "head" }, swatch(k), element("strong", {}, `point ${k + 1}`), hiding, remove);
    const row = element("div", { class: "one", role: "group", "aria-label": `Point ${k + 1}` }, head, span, depth.row);
    panel.add(depth);
    const show = () => {
      row.hidden = !there();
      if (row.hidden) return;
      const hidden = lab.settings.hidden[k];
      hide.checked = hidden !== null;
      span.hidden = hidden === null;
      remove.disabled = !lab.layouts[lab.settings.points.length - 2];
      if (hidden) times.forEach((time, end) => time.show(hidden[end]));
    };
    return { node: row, show };
  }

  time(k, word, end) {
    const { lab } = this;
    const { step, most } = this.panel.schema.hidden;
    const field = element("input", {
      ...{ type: "number", step, min: 0, "aria-label": `point ${k + 1} is hidden ${word}, in s` },
    });
    field.dataset.control = `hidden ${word} ${k + 1}`;
    field.addEventListener("input", () => {
      const times = [...lab.settings.hidden[k]];
      times[end] = Number(field.value);
      const good = field.value !== "" && times[0] >= 0 && times[1] > times[0] && times[1] <= most;
      field.setAttribute("aria-invalid", String(!good));
      if (good) lab.hide(k, times, false);
    });
    field.addEventListener("change", () => lab.rest());
    const show = (value) => {
      if (isBeingTyped(field)) return;
      if (Number(field.value) !== value || field.value === "") field.value = String(value);
      field.setAttribute("aria-invalid", "false");
    };
    return { node: element("label", {}, `${word} `, field), field, show };
  }

  show() {
    this.rows.forEach(({ show }) => show());
    const { layouts, settings } = this.lab;
    this.add.disabled = settings.points.length === this.most || !layouts[settings.points.length];
  }
}
