// The observers to choose from: what is known of each, where it is impossible and why, and the gains of the chosen.

import { changeAt, switchOf } from "../model/settings.js";
import { button, checkbox, element, select, slider } from "./controls.js";
import { linkToFormula } from "./fieldsets.js";
import { swatch } from "./lines.js";

/** Rows for a panel: the observers, the first gain of each that is chosen, and in groups all others. */
export class ObserverList {
  constructor(panel) {
    this.panel = panel;
    this.lab = panel.lab;
    this.observers = Object.entries(panel.model.observers);
    const rows = this.observers.map(([name, observer], order) => this.row(name, observer, order));
    this.choices = element("div", { class: "observers", role: "group", "aria-label": "Observers" }, ...rows);
    const sliders = this.observers.map(([name, observer]) => observer.gains.map((gain, k) => this.gain(name, observer, gain, k === 0)));
    this.mains = sliders.map(([main]) => main);
    this.groups = this.observers.map(([name, observer], order) => this.group(name, observer, order, sliders[order].slice(1)));
    panel.controls.push(this);
  }

  row(name, { title, about, gains }, order) {
    const { lab, panel } = this;
    const choice = checkbox({
      name: `observer ${name}`,
      label: title,
      swatch: swatch(order),
      ...panel.among("observers", Object.keys(panel.model.observers), name, "At least one observer stays."),
    });
    const refusal = element("p", { class: "refusal", hidden: true });
    const known = element("div", { class: "known", hidden: true }, ...whatIsKnown(about, gains));
    const unfold = () => {
      known.hidden = !known.hidden;
      more.setAttribute("aria-expanded", String(!known.hidden));
    };
    const said = { "aria-expanded": "false", "aria-label": `about the ${title} observer`, title: "What is known of it" };
    const more = button("?", unfold, { class: "about", "data-control": `about ${name}`, ...said });
    const showChoice = choice.show;
    choice.show = () => {
      showChoice();
      const reason = lab.kernels.refused(lab.settings)[name];
      choice.parts[0].disabled = Boolean(reason);
      choice.row.title = reason ?? "";
      refusal.hidden = !reason;
      refusal.textContent = reason ? `Not here: ${reason}.` : "";
    };
    return element("div", { class: "observer" }, panel.add(choice), more, refusal, known);
  }

  /** The slider of a gain; the first one stands among others' and says whose it is. */
  gain(name, { title, ways }, gain, main) {
    const { lab, panel } = this;
    const called = gain.name.replaceAll("_", " ");
    const there = ({ observers, gains }, way) => (observers.includes(name) && ways[way].includes(gain.name) ? gains[name][gain.name] : undefined);
    const control = slider({
      ...gain,
      name: `${name} ${gain.name}`,
      label: main ? `${called}, ${title}` : called,
      log: gain.low > 0 && gain.high / gain.low >= 50,
      step: (gain.high - gain.low) / 1000,
      allowed: (value) => lab.kernels.allows(name, gain.name, value),
      get: () => there(lab.settings, switchOf(lab.settings, name)),
      set: (value) => lab.change(changeAt(lab.settings, `gains.${name}.${gain.name}`, value)),
      rest: () => lab.rest(),
    });
    linkToFormula(control, () => lab.formulas, name, gain.name);
    return panel.add(control);
  }

  group(name, { title, ways }, order, sliders) {
    const { lab, panel } = this;
    const way = select({
      name: `${name} switch`,
      label: "switches by",
      choices: Object.fromEntries(Object.keys(ways).map((text) => [text, text])),
      get: () => lab.settings.switches[name],
      set: (value) => lab.change(changeAt(lab.settings, `switches.${name}`, value), true),
    });
    const rows = [...(switchOf(lab.settings, name) ? [panel.add(way)] : []), ...sliders];
    return element("div", { class: "gains-of", role: "group", "aria-label": `Gains of ${title}`, hidden: true }, element("h4", {}, swatch(order), title), ...rows);
  }

  /** Show the gains of the chosen observers only. */
  show() {
    const { observers } = this.lab.settings;
    this.groups.forEach((group, k) => (group.hidden = group.children.length < 2 || !observers.includes(this.observers[k][0])));
  }
}

function whatIsKnown(about, gains) {
  const conditions = gains.filter((gain) => gain.condition).map((gain) => `${gain.condition}: ${gain.reason}`);
  const facts = { Source: [about?.source], Needs: [about?.needs], Claim: [about?.claim], Gains: conditions };
  const rows = Object.entries(facts).flatMap(([term, texts]) => {
    const told = texts.filter(Boolean).map((text) => element("dd", {}, text));
    return told.length ? [element("dt", {}, term), ...told] : [];
  });
  return [...(about ? [element("p", {}, about.title)] : []), element("dl", {}, ...rows)];
}
