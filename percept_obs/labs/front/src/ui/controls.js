// Controls that a keyboard, a screen reader and a hand can use.  Each has a row of the page, and show() brings it to
// the present settings.

import { within } from "../engine/between.js";
import { element, formula, setAttribute, setText } from "../draw/dom.js";

let count = 0;

/** Number a control of the page. */
function nextId() {
  return `percept-${++count}`;
}

/** A unit as it is printed after a name; a number without one has none. */
function unitOf(unit) {
  return unit && unit !== "1" ? ` (${unit.replaceAll("^2", "²")})` : "";
}

/** Values that a field takes, in words. */
function expected({ least, most, above, whole, nonzero, condition, reason }) {
  const kind = whole ? "a whole number" : "a number";
  const low = above ?? least;
  const from = above === undefined ? "from" : "above";
  const range = low === undefined || Math.abs(low) >= 1e300 ? "" : ` ${from} ${low}`;
  const to = range && most !== undefined ? ` to ${most}` : "";
  const more = [condition && `with ${condition}`, reason].filter(Boolean).join("; ");
  return `${kind}${range}${to}${nonzero ? ", not 0" : ""}${more && `, ${more}`}`;
}

/** A line below a field that says what it takes, while something else stands there and after it was taken back. */
function warning(limits) {
  const node = element("p", { class: "range", role: "status", hidden: true });
  const tell = (good) => {
    node.hidden = good;
    if (!good) setText(node, `Not taken. It must be ${expected(limits)}.`);
  };
  return { node, tell };
}

/** The digits of a value that a field shows. */
function digitsOf(value) {
  if (value && Math.abs(value) < 1e-3) return value.toExponential(2).replace(/\.?0+e/, "e");
  return String(Number(value?.toPrecision(6)));
}

function fits(value, { least = -Infinity, most = Infinity, above = -Infinity, whole, nonzero, allowed }) {
  if (!Number.isFinite(value) || value < least || value > most || value <= above) return false;
  return !(whole && !Number.isInteger(value)) && !(nonzero && value === 0) && (!allowed || allowed(value));
}

function mark(field, good) {
  field.setAttribute("aria-invalid", String(!good));
}

/** Return true while somebody types what cannot be taken: it stays to be corrected, whatever is computed meanwhile. */
function isBeingTyped(field) {
  return document.activeElement === field && field.getAttribute("aria-invalid") === "true";
}

/** Parts into which a range without a step is divided, and how wide it is where these are equal ratios. */
const [PARTS, WIDE] = [1000, 20];

/** The step of a range, or whether it is divided into equal ratios. */
function stepsOf({ low, high, step, log = step === undefined && low > 0 && high / low >= WIDE }) {
  return { log, step: step ?? (high - low) / PARTS };
}

/** An input that slides, with the function that brings it to a value and its words; `take` takes what a hand asks. */
function sliding(/** @type {any} */ sizes, attributes, take, rest) {
  const { low, high } = sizes;
  const { log, step } = stepsOf(sizes);
  const ratio = (v) => within(Number((10 ** v).toPrecision(3)), low, high);
  const [inside, outside] = log ? [Math.log10, ratio] : [Number, Number];
  // Whole steps lead to both ends.
  const [min, max] = log ? [Math.floor(100 * inside(low)) / 100, Math.ceil(100 * inside(high)) / 100] : [low, high];
  const box = element("input", {
    ...{ type: "range", min, max, step: log ? 0.01 : step, ...attributes },
    oninput: () => take(outside(Number(box.value))),
    onchange: () => rest?.(),
  });
  const put = (value, text) => {
    const there = document.activeElement === box && outside(Number(box.value)) === value;
    if (!there) box.value = String(inside(Math.max(value, log ? low : -Infinity)));
    setAttribute(box, "aria-valuetext", text);
  };
  return { box, put };
}

/** A slider whose value stands beside its name; `text` writes the value, which is not there where it is null. */
export function range(/** @type {any} */ { name, label, get, set, rest, text = String, ...sizes }) {
  const value = element("output", {});
  const { box, put } = sliding(sizes, { "data-control": name, "aria-label": label }, set, rest);
  const row = element("label", { class: "sliding" }, element("span", {}, `${label} `, value), box);
  const show = () => {
    const now = get();
    row.hidden = now === undefined || now === null;
    if (row.hidden) return;
    setText(value, text(now));
    put(now, text(now));
  };
  return { row, show, name, parts: [box] };
}

/** A slider and a field for a number; `meaning` says in small letters what the name stands for. */
export function slider(options) {
  const { name, label, meaning = "", letter = "", low, unit = "", get, set, rest } = options;
  const { log, step } = stepsOf(options);
  const id = nextId();
  const refused = warning(options);
  const take = (value) => {
    const good = fits(value, options);
    mark(field, good);
    refused.tell(good);
    if (!good) return;
    set(value);
    show();
  };
  const { box, put } = sliding(options, { id, "data-control": name }, take, rest);
  const field = element("input", {
    ...{ type: "number", step: log ? low : step, "aria-label": `${label}, as a number` },
    "data-control": `${name} number`,
    oninput: () => field.value !== "" && take(Number(field.value)),
    onchange: () => {
      const good = field.getAttribute("aria-invalid") !== "true";
      mark(field, true);
      show();
      refused.tell(good);
      rest?.();
    },
  });
  const symbol = letter ? [formula("span", letter, { class: "letter", "aria-hidden": "true" })] : [];
  const text = element("label", { for: id }, ...symbol, element("span", {}, `${label}${unitOf(unit)}`));
  const more = meaning ? [element("p", { class: "meaning" }, meaning)] : [];
  const row = element("div", { class: "control" }, text, box, field, ...more, refused.node);
  let last = null;
  const show = () => {
    const value = get();
    // Writing to a page costs its styles and layout, so nothing is written that is there already.
    if (value === last && (field.value === digitsOf(value) || isBeingTyped(field))) return;
    last = value;
    row.hidden = value === undefined;
    if (row.hidden) return;
    refused.tell(true);
    put(value, `${Number(value.toPrecision(4))}${unit && unit !== "1" ? ` ${unit}` : ""}`);
    const near = Math.abs(Number(field.value) - value) <= 1e-9 * Math.abs(value);
    if (document.activeElement !== field || !near) field.value = digitsOf(value);
    if (fits(Number(field.value), options)) mark(field, true);
  };
  return { row, show, parts: [box, field], name };
}

/** A switch with a place for each choice: one control, moved by a press on a place, a drag or the arrow keys. */
export function places({ name, label, choices, get, set }) {
  const texts = choices.map(({ text }) => element("span", { "aria-hidden": "true" }, text));
  const box = element("input", {
    ...{ type: "range", min: 0, max: choices.length - 1, step: 1, "data-control": name, "aria-label": label },
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
  return { row, show, name, parts: [box] };
}

/** A choice of one among named ones, of which some may be impossible. */
export function select({ name, label, choices, possible = (_value) => true, get, set }) {
  const options = Object.entries(choices).map(([value, text]) => element("option", { value }, text));
  const box = element("select", { id: nextId(), "data-control": name, onchange: () => set(box.value) }, ...options);
  const row = element("div", { class: "control" }, element("label", { for: box.id }, label), box);
  const show = () => {
    for (const option of options) option.disabled = !possible(option.value);
    box.value = get() ?? "";
    row.hidden = !box.value && !options.some(({ value }) => value === "");
  };
  return { row, show, parts: [box], name };
}

/** A box to tick; `before` is the part of its label that is left out where there is little room. */
export function tick({ name, label, before = "", get, set }) {
  const own = { type: "checkbox", "data-control": name, "aria-label": `${before} ${label}`.trim() };
  const box = element("input", { ...own, onchange: () => set(box.checked) });
  const first = before ? [element("span", { class: "before" }, `${before} `)] : [];
  const row = element("label", { class: "tick" }, box, ...first, element("span", {}, label));
  return { row, show: () => (box.checked = get()), parts: [box], name };
}

/** A short text, taken when it is complete. */
export function field({ name, label, most, get, set }) {
  const attributes = { type: "text", id: nextId(), maxlength: most, "data-control": name, autocomplete: "off" };
  const box = element("input", { ...attributes, onchange: () => set(box.value) });
  const row = element("div", { class: "control" }, element("label", { for: box.id }, label), box);
  return { row, show: () => (box.value = get()), parts: [box], name };
}

/** Fields for the numbers of a matrix, one after the other. */
export function grid(options) {
  const { name, label, rows, columns, step, names, get, set, rest } = options;
  const refused = warning(options);
  const fields = names.map((entry, k) => {
    const box = element("input", {
      ...{ type: "number", step, "aria-label": `${label}: ${entry}` },
      ...{ "data-control": `${name} ${entry}`, "data-entry": entry },
      oninput: () => {
        const value = Number(box.value);
        const good = box.value !== "" && fits(value, options);
        mark(box, good);
        refused.tell(good);
        if (good) set(k, value);
      },
      onchange: () => {
        mark(box, true);
        show();
        rest?.();
      },
    });
    return box;
  });
  const block = element("div", { class: "grid", style: `--columns: ${columns}`, "data-rows": rows }, ...fields);
  const attributes = { class: "control block", role: "group", "aria-label": label };
  const row = element("div", attributes, element("span", {}, label), block, refused.node);
  let last = /** @type {number[]} */ ([]);
  const show = () => {
    const values = get();
    row.hidden = !values;
    const before = last;
    last = values ? [...values] : [];
    values?.forEach((value, k) => {
      if (Number(fields[k].value) === value && fields[k].value !== "") return;
      if (value === before[k] && isBeingTyped(fields[k])) return;
      fields[k].value = String(value);
      mark(fields[k], true);
    });
  };
  return { row, show, parts: fields, name };
}
