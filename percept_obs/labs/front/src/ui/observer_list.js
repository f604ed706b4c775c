// The observers to choose from: what is known of each, where it is impossible and why, and the gains of the chosen.

import { changeAt, switchOf } from "../state/settings.js";
import { checkbox, select, slider } from "./controls.js";
import { button, element, setOptionalText } from "./dom.js";
import { linkToFormula } from "./fieldsets.js";
import { swatch } from "../old/line_styles.js";

/** Rows for a panel: the observers, the first gain of each that is chosen, and in groups all others. */
export class ObserverList {
  constructor(panel) {
    this.panel = panel;
    this.lab = panel.lab;
    this.observers = Object.entries(panel.model.observers);
    const rows = this.observers.map(([name, observer], order) => this.row(name, observer, order));
    this.choices = element("div", { class: "observers", role: "group", "aria-label": "Observers" }, ...rows);
    this.mains = [];
    this.groups = this.observers.map(([name, observer], order) => {
      const [main, ...others] = observer.gains.map((gain, k) => this.gain(name, observer, gain, k === 0));
      this.mains.push(main);
      return this.group(name, observer, order, others);
    });
    panel.controls.push(this);
  }

  row(name, { title, about, gains }, order) {
    const { lab, panel } = this;
    const all = Object.keys(panel.model.observers);
    const bound = panel.among("observers", all, name, "At least one observer stays.");
    const choice = checkbox({ name: `observer ${name}`, label: title, swatch: swatch(order), ...bound });
    const refusal = element("p", { class: "refusal", hidden: true });
    const known = element("div", { class: "known", hidden: true }, ...whatIsKnown(about, gains));
    const unfold = () => {
      known.hidden = !known.hidden;
      more.setAttribute("aria-expanded", String(!known.hidden));
    };
    const more = button("?", unfold, {
      ...{ class: "about", "data-control": `about ${name}`, "aria-expanded": "false" },
      ...{ "aria-label": `about the ${title} observer`, title: "What is known of it" },
    });
    const show = () => {
      choice.show();
      const reason = lab.kernels.refused(lab.settings)[name];
      choice.parts[0].disabled = Boolean(reason);
      choice.row.title = reason ?? "";
      setOptionalText(refusal, reason ? `Not here: ${reason}.` : "");
    };
    return element("div", { class: "observer" }, panel.add({ ...choice, show }), more, refusal, known);
  }

  /** The slider of a gain; the first one stands among others' and says whose it is. */
  gain(name, { title, ways }, gain, main) {
    const { lab, panel } = this;
    const called = gain.name.replaceAll("_", " ");
    const used = ({ observers, switches }) =>
      observers.includes(name) && ways[switchOf({ switches }, name)].includes(gain.name);
    const control = slider({
      ...gain,
      name: `${name} ${gain.name}`,
      label: main ? `${called}, ${title}` : called,
      log: gain.low > 0 && gain.high / gain.low >= 50,
      step: (gain.high - gain.low) / 1000,
      allowed: (value) => lab.kernels.allows(name, gain.name, value),
      get: () => (used(lab.settings) ? lab.settings.gains[name][gain.name] : undefined),
      set: (value) => lab.change(changeAt(lab.settings, `gains.${name}.${gain.name}`, value)),
      rest: () => lab.rest(),
    });
    linkToFormula(control, lab, name, gain.name);
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
    const attributes = { class: "gains-of", role: "group", "aria-label": `Gains of ${title}`, hidden: true };
    return element("div", attributes, element("h4", {}, swatch(order), title), ...rows);
  }

  /** Show the gains of the chosen observers only. */
  show() {
    const { observers } = this.lab.settings;
    this.groups.forEach((group, k) => {
      group.hidden = group.children.length < 2 || !observers.includes(this.observers[k][0]);
    });
  }
}

function whatIsKnown(about, gains) {
  const conditions = gains.filter((gain) => gain.condition).map((gain) => `${gain.condition}: ${gain.reason}`);
  const facts = { Source: [about?.source], Needs: [about?.needs], Claim: [about?.claim], Gains: conditions };
  const rows = Object.entries(facts).flatMap(([term, texts]) => {
    const known = texts.filter(Boolean).map((text) => element("dd", {}, text));
    return known.length ? [element("dt", {}, term), ...known] : [];
  });
  return [...(about ? [element("p", {}, about.title)] : []), element("dl", {}, ...rows)];
}
