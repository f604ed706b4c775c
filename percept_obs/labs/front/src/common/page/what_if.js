// What if: the same run with one cause switched off at a time, computed while its part of the page is open.

import { verdict } from "../model/words.js";
import { element } from "./controls.js";
import { topic } from "./fieldsets.js";
import { fill } from "./put.js";

export class WhatIf {
  constructor(lab) {
    this.lab = lab;
    this.list = element("ul", { class: "causes" });
    const said = element("p", { class: "meaning" }, "The same run, with one thing changed at a time:");
    this.body = topic("causes", "What if? One cause at a time", said, this.list);
    /** @type {any} the settings that are told of */
    this.told = null;
    this.body.addEventListener("toggle", () => this.show());
  }

  /** Tell of the settings that are shown, if somebody looks. */
  async show() {
    const { lab, list } = this;
    const { settings, model } = lab;
    if (!this.body.open || this.told === settings) return;
    this.told = settings;
    const engine = lab.makeEngine();
    const lines = [];
    for (const cause of lab.parts.causesOf(settings, model)) {
      const refused = Object.keys(lab.kernels.refused(cause.settings));
      if (cause.settings.observers.some((name) => refused.includes(name))) continue;
      await lab.kernels.prepare(cause.settings);
      if (this.told !== lab.settings || lab.closed) return;
      const shown = engine.run(cause.settings, lab.kernels.of(cause.settings));
      const many = shown.runs.length > 1;
      lines.push(...(shown.runs ?? []).map((run) => `${cause.words}${many ? `, ${run.title}` : ""}: ${verdict(run, shown, model)}`));
    }
    fill(list, lines.length ? lines : ["There is nothing that the lab could switch off."]);
  }
}
