// Controls of the first screen: a slider with its value, and a switch of few places.

import { element, setAttribute, setText } from "./dom.js";

/**
 * A slider whose value stands beside its name; `text` writes the value.
 *
 * @param {Record<string, any>} parts
 */
export function range({ name, label, low, high, step = 0.01, log = false, get, set, rest, text = String }) {
  const [inside, outside] = log ? [Math.log10, (v) => Number((10 ** v).toPrecision(2))] : [Number, Number];
  const value = element("output", {});
  const box = element("input", {
    ...{ type: "range", "data-control": name, "aria-label": label },
    ...{ min: inside(low), max: inside(high), step: log ? 0.01 : step },
    oninput: () => set(outside(Number(box.value))),
    onchange: () => rest(),
  });
  const row = element("label", { class: "sliding" }, element("span", {}, `${label} `, value), box);
  const show = () => {
    const now = get();
    row.hidden = now === undefined || now === null;
    if (row.hidden) return;
    setText(value, text(now));
    setAttribute(box, "aria-valuetext", text(now));
    const there = document.activeElement === box && outside(Number(box.value)) === now;
    if (!there) box.value = String(inside(Math.max(now, low)));
  };
  return { row, show, name };
}

/** A switch with a place for each choice: one control, moved by a press on a place, a drag or the arrow keys. */
export function places({ name, label, choices, get, set }) {
  const most = choices.length - 1;
  const texts = choices.map(({ text }) => element("span", { "aria-hidden": "true" }, text));
  const box = element("input", {
    ...{ type: "range", min: 0, max: most, step: 1, "data-control": name, "aria-label": label },
    oninput: () => set(choices[Number(box.value)].value),
  });
  const row = element("label", { class: "places", style: `--places: ${choices.length}` });
  row.append(element("span", {}, `${label} `), element("span", { class: "switch" }, box, ...texts));
  const show = () => {
    const at = get();
    row.hidden = at < 0;
    if (row.hidden) return;
    box.value = String(at);
    setAttribute(box, "aria-valuetext", choices[at].spoken ?? choices[at].text);
    texts.forEach((text, k) => text.classList.toggle("on", k === at));
  };
  return { row, show, name };
}

/** A choice among several by their names. */
export function select({ name, label, choices, get, set }) {
  const options = choices.map((value) => element("option", { value }, value));
  const box = element("select", { "data-control": name, onchange: () => set(box.value) }, ...options);
  const row = element("label", { class: "choice" }, element("span", {}, `${label} `), box);
  const show = () => {
    box.value = get();
    row.hidden = !box.value;
  };
  return { row, show, name };
}

/** A box to tick; `before` is the part of its label that is left out where there is little room. */
export function tick({ name, label, before = "", get, set }) {
  const own = { type: "checkbox", "data-control": name, "aria-label": `${before} ${label}`.trim() };
  const box = element("input", { ...own, onchange: () => set(box.checked) });
  const first = before ? [element("span", { class: "before" }, `${before} `)] : [];
  const row = element("label", { class: "tick" }, box, ...first, label);
  const show = () => {
    box.checked = get();
  };
  return { row, show, name };
}
