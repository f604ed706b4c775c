// Controls that a keyboard, a screen reader and a hand can use.  Each has a row of the page, and show() brings it to
// the present settings.

import { element, formula, setText } from "./dom.js";

let count = 0;

/** Number a control of the page. */
export function nextId() {
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
export function warning(limits) {
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
export function isBeingTyped(field) {
  return document.activeElement === field && field.getAttribute("aria-invalid") === "true";
}

/** A slider and a field for a number; `meaning` says in small letters what the name stands for. */
export function slider(options) {
  const { name, label, meaning = "", letter = "", low, high, step, log = false, unit = "", get, set, rest } = options;
  const id = nextId();
  const inside = log ? Math.log10 : (v) => v;
  const outside = log ? (v) => Number((10 ** v).toPrecision(3)) : (v) => v;
  const sizes = log ? { min: inside(low), max: inside(high), step: 0.01 } : { min: low, max: high, step };
  const refused = warning(options);
  const take = (value) => {
    const good = fits(value, options);
    mark(field, good);
    refused.tell(good);
    if (!good) return;
    set(value);
    show();
  };
  const range = element("input", {
    ...{ type: "range", id, "data-control": name, ...sizes },
    oninput: () => take(outside(Number(range.value))),
    onchange: () => rest?.(),
  });
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
  const row = element("div", { class: "control" }, text, range, field, ...more, refused.node);
  let last = null;
  const show = () => {
    const value = get();
    // Writing to a page costs its styles and layout, so nothing is written that is there already.
    if (value === last && (field.value === digitsOf(value) || isBeingTyped(field))) return;
    last = value;
    row.hidden = value === undefined;
    if (row.hidden) return;
    refused.tell(true);
    const at = inside(Math.max(value, log ? low : -Infinity));
    if (document.activeElement !== range || outside(Number(range.value)) !== value) range.value = String(at);
    const near = Math.abs(Number(field.value) - value) <= 1e-9 * Math.abs(value);
    if (document.activeElement !== field || !near) field.value = digitsOf(value);
    const spoken = unit && unit !== "1" ? ` ${unit}` : "";
    range.setAttribute("aria-valuetext", `${Number(value.toPrecision(4))}${spoken}`);
    if (fits(Number(field.value), options)) mark(field, true);
  };
  return { row, show, parts: [range, field], name };
}

/** A row with a label and one box. */
function labelled(label, box) {
  box.id = nextId();
  return element("div", { class: "control" }, element("label", { for: box.id }, label), box);
}

/** A choice of one among named ones, of which some may be impossible. */
export function select({ name, label, choices, possible = (_value) => true, get, set }) {
  const options = Object.entries(choices).map(([value, text]) => element("option", { value }, text));
  const box = element("select", { "data-control": name, onchange: () => set(box.value) }, ...options);
  const show = () => {
    for (const option of options) option.disabled = !possible(option.value);
    box.value = get();
  };
  return { row: labelled(label, box), show, parts: [box], name };
}

/** A short text, taken when it is complete. */
export function field({ name, label, most, get, set }) {
  const attributes = { type: "text", maxlength: most, "data-control": name, autocomplete: "off" };
  const box = element("input", { ...attributes, onchange: () => set(box.value) });
  return { row: labelled(label, box), show: () => (box.value = get()), parts: [box], name };
}

/** A choice of one among a few, all in sight. */
export function radios({ name, label, choices, possible = (_value) => true, get, set }) {
  const group = nextId();
  const parts = Object.keys(choices).map((value) =>
    element("input", {
      ...{ type: "radio", name: group, value, "data-control": `${name} ${value}` },
      onchange: () => set(value),
    }),
  );
  const choice = (input) => element("label", { class: "choice" }, input, element("span", {}, choices[input.value]));
  const row = element("div", { class: "choices", role: "radiogroup", "aria-label": label }, ...parts.map(choice));
  const show = () => {
    for (const input of parts) {
      input.disabled = !possible(input.value);
      input.checked = input.value === get();
    }
  };
  return { row, show, parts, name };
}

export function checkbox({ name, label, swatch = /** @type {Node | string} */ (""), get, set }) {
  const input = element("input", { type: "checkbox", "data-control": name, onchange: () => set(input.checked) });
  const row = element("label", { class: "choice" }, input, swatch, element("span", {}, label));
  return { row, show: () => (input.checked = get()), parts: [input], name };
}

/** Fields for the numbers of a matrix, one after the other. */
export function grid(options) {
  const { name, label, rows, columns, step, names, get, set, rest } = options;
  const refused = warning(options);
  const fields = names.map((entry, k) => {
    const field = element("input", {
      ...{ type: "number", step, "aria-label": `${label}: ${entry}` },
      ...{ "data-control": `${name} ${entry}`, "data-entry": entry },
      oninput: () => {
        const value = Number(field.value);
        const good = field.value !== "" && fits(value, options);
        mark(field, good);
        refused.tell(good);
        if (good) set(k, value);
      },
      onchange: () => {
        mark(field, true);
        show();
        rest?.();
      },
    });
    return field;
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
