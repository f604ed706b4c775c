// What if: the same run with one cause switched off at a time, each with its error drawn, computed while somebody looks.

import { verdictInShort } from "../model/words.js";
import { element } from "./controls.js";
import { topic } from "./fieldsets.js";
import { spark } from "./spark.js";

const MEANING = "The same run, with one thing changed at a time. Drawn is its error over time, thin the error now, dotted the tolerance.";

export class WhatIf {
  constructor(lab) {
    this.lab = lab;
    this.list = element("ul", { class: "causes" });
    this.body = topic("causes", "What if? One cause at a time", element("p", { class: "meaning" }, MEANING), this.list);
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
    const outdated = () => lab.closed || lab.settings !== settings || this.told !== settings;
    const engine = lab.makeEngine();
    await lab.kernels.prepare(settings);
    if (outdated()) return;
    const now = engine.run(settings, lab.kernels.of(settings)).runs;
    const lines = [];
    for (const cause of lab.parts.causesOf(settings, model)) {
      const refused = Object.keys(lab.kernels.refused(cause.settings));
      if (cause.settings.observers.some((name) => refused.includes(name))) continue;
      await lab.kernels.prepare(cause.settings);
      if (outdated()) return;
      const shown = engine.run(cause.settings, lab.kernels.of(cause.settings));
      const many = shown.runs.length > 1;
      for (const run of shown.runs) {
        const before = now.find(({ name }) => name === run.name)?.error ?? null;
        const text = `${cause.words}${many ? `, ${run.title}` : ""}: ${verdictInShort(run, shown, model)}`;
        lines.push(element("li", {}, spark([["spark-now", before], ["spark-then", run.error]], shown.tolerance), element("span", {}, text)));
      }
    }
    list.replaceChildren(...(lines.length ? lines : [element("li", {}, "There is nothing that the lab could switch off.")]));
  }
}
