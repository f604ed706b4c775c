// Controls that a keyboard, a screen reader and a hand can use; each knows how to show new settings.

let count = 0;

/** Make an element: attributes, then children. */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== undefined && value !== null) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

/** A unit as it is printed beside a name; a number without one says nothing. */
export function unitOf(unit) {
  return unit && unit !== "1" ? ` (${unit.replaceAll("^2", "²")})` : "";
}

/** What a field takes, in words. */
function expected({ least, most, above, whole, nonzero, condition, reason }) {
  const kind = whole ? "a whole number" : "a number";
  const low = above === undefined ? least : above;
  const range = low === undefined || Math.abs(low) >= 1e300 ? "" : ` ${above === undefined ? "from" : "above"} ${low}${most === undefined ? "" : ` to ${most}`}`;
  const more = [condition && `with ${condition}`, reason].filter(Boolean).join("; ");
  return `${kind}${range}${nonzero ? ", not 0" : ""}${more && `, ${more}`}`;
}

/** A line below a field that says what it takes, while something else stands there and after it was taken back. */
export function warning(limits) {
  const node = element("p", { class: "range", role: "status", hidden: true });
  const tell = (good) => {
    node.hidden = good;
    if (!good) node.textContent = `Not taken. It must be ${expected(limits)}.`;
  };
  return { node, tell };
}

/** The digits of a value that a field shows. */
function shown(value) {
  if (value && Math.abs(value) < 1e-3) return value.toExponential(2).replace(/\.?0+e/, "e");
  return String(Number(value?.toPrecision(6)));
}

function same(one, other) {
  return Math.abs(one - other) <= 1e-9 * Math.abs(other);
}

/**
 * @param {number} value
 * @param {Partial<import("../../types.js").SettingSchema> & {allowed?: (value: number) => boolean}} limits  of a schema
 */
function fits(value, { least = -Infinity, most = Infinity, above = -Infinity, whole, nonzero, allowed }) {
  if (!Number.isFinite(value) || value < least || value > most || value <= above) return false;
  return !(whole && !Number.isInteger(value)) && !(nonzero && value === 0) && (!allowed || allowed(value));
}

/** Whether somebody is typing what cannot be taken: it stays to be mended, whatever is computed meanwhile. */
function isBeingTyped(field) {
  return document.activeElement === field && field.getAttribute("aria-invalid") === "true";
}

/** `meaning` says in small letters what the name stands for. */
export function slider({ name, label, meaning = "", letter = "", low, high, step, log = false, unit = "", get, set, rest, ...limits }) {
  const id = `percept-${++count}`;
  const inside = log ? Math.log10 : (v) => v;
  const outside = log ? (v) => Number((10 ** v).toPrecision(3)) : (v) => v;
  const sizes = log ? { min: inside(low), max: inside(high), step: 0.01 } : { min: low, max: high, step };
  const range = element("input", { type: "range", id, "data-control": name, ...sizes });
  const field = element("input", { type: "number", step: log ? low : step, "aria-label": `${label}, as a number` });
  field.dataset.control = `${name} number`;
  const symbol = letter ? [element("span", { class: "letter", "aria-hidden": "true" })] : [];
  if (letter) symbol[0].innerHTML = `<math>${letter}</math>`;
  const text = element("label", { for: id }, ...symbol, element("span", {}, `${label}${unitOf(unit)}`));
  const refused = warning(limits);
  const said = meaning ? [element("p", { class: "meaning" }, meaning)] : [];
  const row = element("div", { class: "control" }, text, range, field, ...said, refused.node);
  const take = (value) => {
    const good = fits(value, limits);
    field.setAttribute("aria-invalid", String(!good));
    refused.tell(good);
    if (!good) return;
    set(value);
    show();
  };
  range.addEventListener("input", () => take(outside(Number(range.value))));
  range.addEventListener("change", () => rest?.());
  field.addEventListener("input", () => field.value !== "" && take(Number(field.value)));
  field.addEventListener("change", () => {
    const good = field.getAttribute("aria-invalid") !== "true";
    field.setAttribute("aria-invalid", "false");
    show();
    refused.tell(good);
    rest?.();
  });
  let last = null;
  const show = () => {
    const value = get();
    // Writing to a page costs its styles and layout, so nothing is written that is there already.
    if (value === last && (field.value === shown(value) || isBeingTyped(field))) return;
    last = value;
    row.hidden = value === undefined;
    if (row.hidden) return;
    refused.tell(true);
    const at = inside(Math.max(value, log ? low : -Infinity));
    if (document.activeElement !== range || outside(Number(range.value)) !== value) range.value = String(at);
    if (document.activeElement !== field || !same(Number(field.value), value)) field.value = shown(value);
    range.setAttribute("aria-valuetext", `${Number(value.toPrecision(4))}${unit && unit !== "1" ? ` ${unit}` : ""}`);
    if (fits(Number(field.value), limits)) field.setAttribute("aria-invalid", "false");
  };
  return { row, show, parts: [range, field], name };
}

/** A choice of one among named ones, of which some may be impossible. */
export function select({ name, label, choices, possible = (_value) => true, get, set }) {
  const id = `percept-${++count}`;
  const options = Object.entries(choices).map(([value, text]) => element("option", { value }, text));
  const box = element("select", { id, "data-control": name }, ...options);
  box.addEventListener("change", () => set(box.value));
  const row = element("div", { class: "control" }, element("label", { for: id }, label), box);
  const show = () => {
    for (const option of options) option.disabled = !possible(option.value);
    box.value = get();
  };
  return { row, show, parts: [box], name };
}

/** A short text, taken when it is complete. */
export function field({ name, label, most, get, set }) {
  const id = `percept-${++count}`;
  const box = element("input", { type: "text", id, maxlength: most, "data-control": name, autocomplete: "off" });
  box.addEventListener("change", () => set(box.value));
  const row = element("div", { class: "control" }, element("label", { for: id }, label), box);
  const show = () => (box.value = get());
  return { row, show, parts: [box], name };
}

/** A choice of one among a few, all in sight. */
export function radios({ name, label, choices, possible = (_value) => true, get, set }) {
  const group = `percept-${++count}`;
  const parts = Object.keys(choices).map((value) => {
    const input = element("input", { type: "radio", name: group, value, "data-control": `${name} ${value}` });
    input.addEventListener("change", () => set(value));
    return input;
  });
  const labelled = parts.map((input) => element("label", { class: "choice" }, input, element("span", {}, choices[input.value])));
  const row = element("div", { class: "choices", role: "radiogroup", "aria-label": label }, ...labelled);
  const show = () => {
    for (const input of parts) {
      input.disabled = !possible(input.value);
      input.checked = input.value === get();
    }
  };
  return { row, show, parts, name };
}

export function checkbox({ name, label, swatch = /** @type {Node | string} */ (""), get, set }) {
  const input = element("input", { type: "checkbox", "data-control": name });
  input.addEventListener("change", () => set(input.checked));
  const row = element("label", { class: "choice" }, input, swatch, element("span", {}, label));
  return { row, show: () => (input.checked = get()), parts: [input], name };
}

export function grid({ name, label, rows, columns, step, names, get, set, rest, ...limits }) {
  const refused = warning(limits);
  const fields = names.map((entry, k) => {
    const field = element("input", { type: "number", step, "aria-label": `${label}: ${entry}` });
    field.dataset.control = `${name} ${entry}`;
    field.dataset.entry = entry;
    field.addEventListener("input", () => {
      const value = Number(field.value);
      const good = field.value !== "" && fits(value, limits);
      field.setAttribute("aria-invalid", String(!good));
      refused.tell(good);
      if (good) set(k, value);
    });
    field.addEventListener("change", () => {
      field.setAttribute("aria-invalid", "false");
      show();
      rest?.();
    });
    return field;
  });
  const block = element("div", { class: "grid", style: `--columns: ${columns}`, "data-rows": rows }, ...fields);
  const row = element("div", { class: "control block", role: "group", "aria-label": label }, element("span", {}, label), block, refused.node);
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
      fields[k].setAttribute("aria-invalid", "false");
    });
  };
  return { row, show, parts: fields, name };
}

export function button(text, act, attributes = {}) {
  return element("button", { type: "button", onclick: act, ...attributes }, text);
}
