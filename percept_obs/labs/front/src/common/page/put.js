// Texts are put into the page only when they change, for each change makes it lay itself out.

import { element } from "./controls.js";
import { swatch } from "./lines.js";

export function put(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Put in a text that is there only if it says something. */
export function show(node, text) {
  put(node, text);
  node.hidden = !text;
}

/** Put in entries, each beside a piece of its line. */
export function beside(list, found, entryOf) {
  const key = JSON.stringify(found);
  if (list.dataset.key === key) return;
  list.dataset.key = key;
  list.replaceChildren(...found.map(([which, ...words]) => element("li", {}, swatch(which), ...entryOf(...words))));
}

export function fill(list, texts) {
  texts.forEach((text, k) => {
    if (!list.children[k]) list.append(element("li"));
    put(list.children[k], text);
  });
  while (list.children.length > texts.length) list.lastChild.remove();
}
