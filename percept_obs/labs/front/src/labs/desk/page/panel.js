// The drawer of the desk: what is derived, and whose system; the way back.

import { button, element, setText } from "../../../draw/dom.js";
import { same } from "../../../state/settings.js";
import { field } from "../../../ui/controls.js";
import { Fieldsets } from "../../../ui/fieldsets.js";
import { historyButtons } from "../../../ui/messages.js";

export const WORDS = { surface: { label: "Imaging surface" } };

export class Panel extends Fieldsets {
  constructor(lab) {
    super(lab);
    const { model } = lab;
    const free = ({ student }) => !model.given && !student.trim();
    const offered = model.given?.outputs ?? Object.values(model.surfaces).flat();
    const choicesOf = (surface) => model.given?.outputs ?? model.surfaces[surface];
    const canBe = (names, surface) => choicesOf(surface).some((each) => same(each, names));
    const possible = (surface) => (canBe(lab.settings.outputs, surface) ? {} : { outputs: model.surfaces[surface][0] });
    this.history = historyButtons(lab);
    this.more = button("More", () => lab.unfold(), { class: "link", "data-control": "more" });
    const clear = () => lab.change({ typed: {}, hints: {} }, true);
    const ways = [
      ...[this.history.undo, this.history.redo],
      button("Clear all lines", clear, { "data-control": "clear" }),
      button("Start again", () => lab.reset(), { "data-control": "reset" }),
    ];
    this.body = element(
      "section",
      { class: "drawer", "aria-label": "More controls", hidden: true },
      element("div", { class: "actions" }, ...ways),
      this.choice("part", { choices: model.parts, besides: () => ({ step: 1 }) }),
      this.onlyIf(() => !model.given, this.add(field(this.bound("student", true)))),
      this.onlyIf(free, this.choice("motion")),
      this.onlyIf(free, this.choice("surface", { besides: possible })),
      this.onlyIf(
        ({ student }) => model.given || !student.trim(),
        this.choice("outputs", {
          choices: Object.fromEntries(offered.map((names) => [names.join(), names.join(" and ")])),
          possible: (value) => canBe(value.split(","), lab.settings.surface),
          get: () => lab.settings.outputs.join(),
          set: (value) => lab.change({ outputs: value.split(",") }, true),
        }),
      ),
      this.onlyIf(({ part }) => /observer|error/.test(part), this.choice("observer", { choices: model.observers })),
      this.number("point.2"),
    );
  }

  /** Open or close the drawer, and bring its buttons to the history. */
  unfold(state) {
    const open = Boolean(state.view.more);
    this.body.hidden = !open;
    this.more.setAttribute("aria-expanded", String(open));
    setText(this.more, open ? "Less" : "More");
    this.history.show(state);
  }
}
