// The observers to choose from: what is known of each, where it is impossible and why, and the gains of the chosen.

import { changeAt, switchOf } from "../model/settings.js";
import { button, checkbox, element, select, slider } from "./controls.js";
import { linkToFormula } from "./fieldsets.js";
import { swatch } from "./lines.js";

const OPEN_AT_ONCE = 3;

/** Rows and groups for a panel, which shows them with its other controls. */
export class ObserverList {
  constructor(panel) {
    this.panel = panel;
    this.lab = panel.lab;
    this.observers = Object.entries(panel.model.observers);
    this.rows = this.observers.map(([name, observer], order) => this.row(name, observer, order));
    this.groups = this.observers.map(([name, observer], order) => this.group(name, observer, order));
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
    const said = { "aria-expanded": "false", "aria-label": `about the ${title} observer` };
    const more = button("about", unfold, { class: "about", "data-control": `about ${name}`, ...said });
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

  group(name, { title, gains, ways }, order) {
    const { lab, panel } = this;
    const sliders = gains.map((gain) => {
      const control = slider({
        ...gain,
        name: `${name} ${gain.name}`,
        label: gain.name.replaceAll("_", " "),
        hint: gain.condition ? `${gain.meaning}; needs ${gain.condition}` : gain.meaning,
        log: gain.low > 0 && gain.high / gain.low >= 50,
        step: (gain.high - gain.low) / 1000,
        allowed: (value) => lab.kernels.allows(name, gain.name, value),
        get: () => (ways[switchOf(lab.settings, name)].includes(gain.name) ? lab.settings.gains[name][gain.name] : undefined),
        set: (value) => lab.change(changeAt(lab.settings, `gains.${name}.${gain.name}`, value)),
        rest: () => lab.rest(),
      });
      linkToFormula(control, () => lab.formulas, name, gain.name);
      return panel.add(control);
    });
    const way = select({
      name: `${name} switch`,
      label: "switches by",
      choices: Object.fromEntries(Object.keys(ways).map((text) => [text, text])),
      get: () => lab.settings.switches[name],
      set: (value) => lab.change(changeAt(lab.settings, `switches.${name}`, value), true),
    });
    const head = element("summary", { "data-control": `gains of ${name}` }, swatch(order), title);
    return element("details", { class: "gains-of", hidden: true }, head, ...(switchOf(lab.settings, name) ? [panel.add(way)] : []), ...sliders);
  }

  /** Show the gains of the chosen observers only; where they are many, closed until asked for. */
  show() {
    const { observers } = this.lab.settings;
    this.groups.forEach((group, k) => {
      const chosen = observers.includes(this.observers[k][0]);
      if (chosen && group.hidden) group.open = observers.length <= OPEN_AT_ONCE;
      group.hidden = !chosen;
    });
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
