// The same run with one cause switched off at a time, each with its error drawn, computed while somebody looks.

import { within } from "../engine/between.js";
import { verdictInShort } from "../state/words.js";
import { element, svg } from "../ui/dom.js";
import { topic } from "../ui/fieldsets.js";

const MEANING =
  "The same run, with one thing changed at a time. " +
  "Drawn is its error over time, thin the error now, dotted the tolerance.";
const NOTHING = "There is nothing that the lab could switch off.";
/** Size of a sparkline in pixels, and the decades of the error between which it is drawn. */
const [WIDTH, HEIGHT] = [104, 26];
const [LOW, HIGH] = [-4, 2];

export class WhatIf {
  constructor(lab) {
    this.lab = lab;
    this.list = element("ul", { class: "causes" });
    const meaning = element("p", { class: "meaning" }, MEANING);
    this.body = topic("causes", "What if? One cause at a time", meaning, this.list);
    this.shownFor = /** @type {any} */ (null);
    this.body.addEventListener("toggle", () => this.show());
  }

  /** Show the causes of the settings that are shown, if somebody looks. */
  async show() {
    const { lab, list } = this;
    const { settings, model } = lab;
    if (!this.body.open || this.shownFor === settings) return;
    this.shownFor = settings;
    const engine = lab.makeEngine();
    /** The result of settings; null once the lab has others. */
    const runOf = async (changed) => {
      await lab.kernels.prepare(changed);
      const outdated = lab.closed || lab.settings !== settings || this.shownFor !== settings;
      return outdated ? null : engine.run(changed, lab.kernels.of(changed));
    };
    const now = (await runOf(settings))?.runs;
    if (!now) return;
    const items = [];
    for (const { words, settings: changed } of lab.parts.causesOf(settings, model)) {
      const refused = Object.keys(lab.kernels.refused(changed));
      if (changed.observers.some((name) => refused.includes(name))) continue;
      const shown = await runOf(changed);
      if (!shown) return;
      for (const run of shown.runs) {
        const before = now.find(({ name }) => name === run.name)?.error ?? null;
        const title = shown.runs.length > 1 ? `${words}, ${run.title}` : words;
        const text = element("span", {}, `${title}: ${verdictInShort(run, shown, model)}`);
        items.push(element("li", {}, sparkline(before, run.error, shown.tolerance), text));
      }
    }
    list.replaceChildren(...(items.length ? items : [element("li", {}, NOTHING)]));
  }
}

/** An error in the size of a word, over that of now: decades upwards, time to the right, the tolerance dotted. */
function sparkline(now, then, tolerance) {
  const lines = [["spark-now", now], ["spark-then", then]].filter(([, error]) => error);
  return svg(
    "svg",
    { class: "spark", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, "aria-hidden": "true" },
    svg("path", { class: "spark-level", d: `M0 ${heightOf(tolerance)}H${WIDTH}` }),
    ...lines.map(([style, error]) => svg("path", { class: style, d: pathOf(error) })),
  );
}

function heightOf(value) {
  const share = (Math.log10(Math.max(value, 1e-30)) - LOW) / (HIGH - LOW);
  return Number((1 + (HEIGHT - 2) * (1 - within(share, 0, 1))).toFixed(1));
}

/** One path through the largest error of each column, with gaps where there is none. */
function pathOf(error) {
  let path = "";
  let before = false;
  for (let x = 0; x < WIDTH; x++) {
    const [from, to] = [x, x + 1].map((at) => Math.floor((at * error.length) / WIDTH));
    const most = error.slice(from, Math.max(to, from + 1)).reduce((a, b) => (a >= b || Number.isNaN(b) ? a : b), NaN);
    const there = !Number.isNaN(most);
    if (there) path += `${before ? "L" : "M"}${x} ${heightOf(most)}`;
    before = there;
  }
  return path;
}
