// Parts of which a small screen shows one at a time; where there is room all are in sight, and the tabs are not.

import { button, element } from "./controls.js";

/** A row of buttons; `parts` have a name, a title, and the nodes that they show. */
export function tabs(label, parts) {
  const choose = (chosen) => {
    for (const { name, nodes } of parts) for (const node of nodes) node.classList.toggle("away", name !== chosen);
    for (const press of presses) press.setAttribute("aria-pressed", String(press.dataset.control === `tab ${chosen}`));
  };
  const presses = parts.map(({ name, title }) => button(title, () => choose(name), { "data-control": `tab ${name}` }));
  choose(parts[0].name);
  return element("div", { class: "tabs", role: "group", "aria-label": label }, ...presses);
}
