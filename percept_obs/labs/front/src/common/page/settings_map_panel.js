// The controls of the map over two settings: what it shows, of which observer, and the setting along each axis.

import { planOf } from "../model/axes.js";
import { changeAt } from "../model/settings.js";
import { element, select } from "./controls.js";
import { topic } from "./fieldsets.js";

const SHOWS = { nothing: "no map", settling: "settling time", error: "error at the end" };

export function mapTopic(panel, axesOf) {
  const { lab, model } = panel;
  const plan = () => {
    const functions = lab.kernels.of(lab.settings);
    return functions && planOf(lab.settings, model, axesOf, functions);
  };
  const set = (part) => (value) => lab.change(changeAt(lab.settings, `over.${part}`, value), true);
  const shows = select({ name: "map shows", label: "shows", choices: SHOWS, get: () => lab.settings.over.shows, set: set("shows") });
  const titles = Object.fromEntries(Object.entries(model.observers).map(([name, { title }]) => [name, title]));
  const followed = ({ over, observers }) => (observers.includes(over.observer) ? over.observer : observers[0]);
  const observer = select({
    ...{ name: "map observer", label: "observer", choices: titles, set: set("observer") },
    get: () => followed(lab.settings),
    possible: (name) => lab.settings.observers.includes(name),
  });
  const axes = ["across", "up"].map((part) => axisChoice({ name: `map ${part}`, label: part, set: set(part) }, part, plan));
  const rows = [observer, ...axes].map((control) => panel.add(control));
  const more = element("div", {}, ...rows, element("p", { class: "meaning" }, "Each place is a whole run with all other settings as they are; noise has the same seed everywhere."));
  const body = topic("over", "Map over two settings", panel.add(shows), panel.onlyIf(({ over }) => over.shows !== "nothing", more));
  for (const near of ["pointerenter", "focusin", "toggle"]) body.addEventListener(near, () => lab.planes.find((plane) => plane.sweep).hire());
  return body;
}

/** A choice among the axes that have a meaning at present, besides that of the other side. */
function axisChoice(named, part, plan) {
  const control = select({ ...named, choices: {}, get: () => "" });
  const [box] = control.parts;
  let there = "";
  const show = () => {
    const now = plan();
    if (!now) return;
    const other = now[part === "across" ? "up" : "across"];
    const offered = now.axes.filter((axis) => axis !== other);
    const key = offered.map(({ place }) => place).join();
    if (key !== there) box.replaceChildren(...offered.map(({ place, label }) => element("option", { value: place }, label)));
    there = key;
    box.value = now[part]?.place ?? "";
  };
  return { ...control, show };
}
