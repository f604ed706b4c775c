// The observers to choose from: what is known of each, where it is impossible and why, and the gains of the chosen one.

import { button, element, setAttribute, setOptionalText, setText } from "../draw/dom.js";
import { changeAt, switchOf } from "../state/settings.js";
import { select, slider, tick } from "./controls.js";
import { linkToFormula } from "./fieldsets.js";

/** Groups of a drawer: the observers, and the gains of the chosen one but those that stand below the pictures. */
export class Observers {
  /** @param {number} below  how many gains stand below the pictures */
  constructor(panel, below = 1) {
    this.panel = panel;
    this.below = below;
    this.lab = panel.lab;
    this.observers = Object.entries(panel.model.observers);
    const rows = this.observers.map(([name, observer], order) => this.row(name, observer, order));
    this.list = element("div", { class: "observers", role: "group", "aria-label": "Observers" }, ...rows);
    this.of = element("p", { class: "meaning" });
    this.gains = this.observers.flatMap(([name, observer]) => this.gainsOf(name, observer));
    panel.controls.push({ show: () => this.show() });
  }

  /** The groups, by which a drawer begins. */
  get groups() {
    const inside = [this.of, ...this.gains];
    return [
      { name: "observers", title: "Observers", inside: [this.list] },
      { name: "gains", title: "Gains", inside },
    ];
  }

  row(name, { title, about, gains }, order) {
    const { lab, panel } = this;
    const bead = tick({
      ...{ name: `observer ${name}`, label: "", before: title },
      get: () => lab.settings.observers.includes(name),
      set: (on) => this.take(name, on),
    });
    bead.row.classList.add("bead");
    bead.row.style.setProperty("--bead", `var(--lab-line-${order})`);
    const press = button(title, () => this.choose(name), { class: "named", "data-control": `choose ${name}` });
    const refusal = element("p", { class: "refusal", hidden: true });
    const known = element("div", { class: "known", hidden: true }, ...whatIsKnown(about, gains));
    const more = button("?", () => {
      known.hidden = !known.hidden;
      more.setAttribute("aria-expanded", String(!known.hidden));
    }, {
      ...{ class: "about", "data-control": `about ${name}`, "aria-expanded": "false" },
      ...{ "aria-label": `about the ${title} observer`, title: "What is known of it" },
    });
    const node = element("div", { class: "observer" }, bead.row, press, more, refusal, known);
    const show = () => {
      bead.show();
      const reason = lab.kernels.refused(lab.settings)[name];
      const [box] = bead.parts;
      box.disabled = press.disabled = Boolean(reason);
      setAttribute(press, "aria-pressed", String(lab.chosenName() === name));
      bead.row.classList.toggle("chosen", lab.chosenName() === name);
      setOptionalText(refusal, reason ? `Not here: ${reason}.` : "");
    };
    panel.controls.push({ ...bead, row: node, show });
    return node;
  }

  /** Let an observer run, or not; one stays. */
  take(name, on) {
    const { lab } = this;
    const { observers } = lab.settings;
    const all = this.observers.map(([each]) => each);
    const chosen = all.filter((each) => (each === name ? on : observers.includes(each)));
    if (chosen.length) return lab.change({ observers: chosen }, true);
    lab.say("At least one observer stays.");
    this.panel.shownFor = null;
    return this.panel.show();
  }

  /** Let arrows and sentence be about an observer, which runs from now on. */
  choose(name) {
    const { lab } = this;
    if (!lab.settings.observers.includes(name)) this.take(name, true);
    lab.choose(name);
  }

  gainsOf(name, { ways, gains }) {
    const { lab, panel } = this;
    const chosen = () => lab.chosenName() === name;
    const way = select({
      ...{ name: `${name} switch`, label: "switches by" },
      choices: Object.fromEntries(Object.keys(ways).map((text) => [text, text])),
      get: () => (chosen() && switchOf(lab.settings, name)) || null,
      set: (value) => lab.change(changeAt(lab.settings, `switches.${name}`, value), true),
    });
    const sliders = gains.slice(this.below).map((gain) => {
      const used = () => chosen() && ways[switchOf(lab.settings, name)]?.includes(gain.name);
      const control = slider({
        ...gain,
        name: `${name} ${gain.name}`,
        label: gain.name.replaceAll("_", " "),
        allowed: (value) => lab.kernels.allows(name, gain.name, value),
        get: () => (used() ? lab.settings.gains[name][gain.name] : undefined),
        set: (value) => lab.change(changeAt(lab.settings, `gains.${name}.${gain.name}`, value)),
        rest: () => lab.rest(),
      });
      linkToFormula(control, lab, name, gain.name);
      return panel.add(control);
    });
    return [...(Object.keys(ways).length > 1 ? [panel.add(way)] : []), ...sliders];
  }

  show() {
    const name = this.lab.chosenName();
    const { title, gains, ways } = this.panel.model.observers[name];
    const none = gains.length <= this.below && Object.keys(ways).length < 2;
    setText(this.of, none ? `${title} has no gain besides what stands below the pictures.` : `Of ${title}:`);
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
