// What is derived: whose system, which motion and surface, what is measured, which observer.

import { same } from "../../../state/settings.js";
import { field, select } from "../../../ui/controls.js";
import { element } from "../../../draw/dom.js";
import { Fieldsets } from "../../../ui/fieldsets.js";

export const WORDS = {
  surface: { label: "Imaging surface" },
};

const WITH_OBSERVER = ["observer", "error"];

export class Panel extends Fieldsets {
  constructor(lab) {
    super(lab);
    const { model } = lab;
    const given = Boolean(model.given);
    const free = (row) => this.onlyIf(({ student }) => !given && !student.trim(), row);
    const whose = this.add(field(this.bound("student", true)));
    this.body = element(
      "div",
      { class: "choices-of-desk" },
      this.choice("part", { choices: model.parts, besides: () => ({ step: 1 }) }),
      this.onlyIf(() => !given, whose),
      free(this.choice("motion")),
      free(this.choice("surface", { besides: (surface) => this.possibleOutputs(surface) })),
      this.onlyIf(({ student }) => given || !student.trim(), this.outputs()),
      this.onlyIf(({ part }) => WITH_OBSERVER.includes(part), this.choice("observer", { choices: model.observers })),
    );
    this.inverse = this.number("point.2");
  }

  /** Outputs that can be measured on a surface. */
  choicesOf(surface) {
    return this.model.given?.outputs ?? this.model.surfaces[surface];
  }

  possibleOutputs(surface) {
    const choices = this.choicesOf(surface);
    return choices.some((names) => same(names, this.lab.settings.outputs)) ? {} : { outputs: choices[0] };
  }

  outputs() {
    const { lab, model } = this;
    const all = model.given ? model.given.outputs : Object.values(model.surfaces).flat();
    const choices = Object.fromEntries(all.map((names) => [names.join(), names.join(" and ")]));
    const { label } = this.schema.outputs;
    return this.add(
      select({
        ...{ name: "outputs", label, choices },
        possible: (value) => this.choicesOf(lab.settings.surface).some((names) => names.join() === value),
        get: () => lab.settings.outputs.join(),
        set: (value) => lab.change({ outputs: value.split(",") }, true),
      }),
    );
  }
}
