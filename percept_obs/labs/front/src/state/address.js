// @ts-check
// Settings as a part of a page's address, and back: what differs from the standard ones, each value as a short text.
//
// #observer=1;outputs=y1;b=0.4,0.3,0.3;noise.size=0.01&points=1;spin=0.5 has a part for each lab of the page, by its
// name: the version of these rules, then places with values.  Nothing is taken that the lab's schema does not allow.

import { changeAt, same } from "./settings.js";

const VERSION = "1";
/** Letters of an address that are read. */
export const MOST = 20_000;
const NOTHING = "-";
const UNCHANGED = "same";
const NUMBER = /^-?(\d+\.?\d*|\.\d+)(e-?\d+)?$/;
const GROUPS = ["group", "gainsof"];

/** @typedef {Record<string, any>} Kind  a kind of setting, as Python's schema tells it */

/** Why an address cannot be read, in words. */
export class BadAddress extends Error {}

/** The parts of a page's fragment by their names; one without "=" is a place in the page, and one too long is none. */
export function partsOf(fragment) {
  const text = fragment.replace(/^#/, "");
  if (!text.includes("=") || isTooLong(fragment)) return new Map();
  return new Map(text.split("&").map((part) => [part.split("=", 1)[0], part.slice(part.indexOf("=") + 1)]));
}

/** True if a fragment is longer than any link of a lab. */
export function isTooLong(fragment) {
  return fragment.length > MOST;
}

/** A fragment of parts. */
export function fragmentOf(parts) {
  return `#${[...parts].map(([name, text]) => `${name}=${text}`).join("&")}`;
}

/** A lab's part of the address: what of the settings is not as in the standard ones. */
export function textOf(settings, { schema, standard }) {
  const { kept, ...present } = settings;
  const changes = changesOf(groupOf(schema), present, standard);
  if (kept) {
    const { kept: _none, ...other } = kept;
    const differs = changesOf(groupOf(schema), other, present).map(([place, text]) => [`kept.${place}`, text]);
    changes.push(...(differs.length ? differs : [["kept", UNCHANGED]]));
  }
  return [VERSION, ...changes.map((change) => change.join("="))].join(";");
}

/** The settings that a lab's part of the address tells; a BadAddress if it tells none. */
export function settingsIn(text, { schema, standard }) {
  const [version, ...assigned] = text.split(";");
  if (version !== VERSION) {
    throw new BadAddress(`it is of version ${quoted(version)} of links, and this page reads version ${VERSION}`);
  }
  const given = new Map();
  for (const each of assigned) {
    const at = each.indexOf("=");
    const place = each.slice(0, Math.max(at, 0));
    if (!place) throw new BadAddress(`${quoted(each)} is no setting with a value; it must be such as seed=3`);
    if (given.has(place)) throw new BadAddress(`${quoted(place)} is given twice`);
    given.set(place, each.slice(at + 1));
  }
  const root = groupOf(schema);
  const unchanged = given.get("kept") === UNCHANGED && given.delete("kept");
  const ofKept = [...given].filter(([place]) => place.startsWith("kept."));
  const settings = changed(root, standard, [...given].filter(([place]) => !place.startsWith("kept.")));
  if (!unchanged && !ofKept.length) return { ...settings, kept: null };
  return { ...settings, kept: changed(root, settings, ofKept.map(([place, value]) => [place.slice(5), value])) };
}

/** A schema as a kind; what is kept to compare with has its own rule. */
function groupOf({ kept: _whole, ...of }) {
  return { kind: "group", of };
}

/** Places with texts of the values that are other than in a base. */
function changesOf(kind, value, base, place = "") {
  if (kind.kind === "optional" && value !== null) return changesOf(kind.of, value, base, place);
  if (!GROUPS.includes(kind.kind)) return same(value, base) ? [] : [[place, written(kind, value)]];
  return Object.entries(kind.of).flatMap(([key, part]) =>
    changesOf(part, value[key], base?.[key], place ? `${place}.${key}` : key),
  );
}

/** A base with the values that are told of places. */
function changed(root, base, given) {
  let settings = structuredClone(base);
  for (const [place, text] of given) {
    const value = read(kindAt(root, place), text, place);
    settings = { ...settings, ...changeAt(settings, place, value) };
  }
  complain(root, settings, "");
  return settings;
}

/** The kind of the value at a place; only names of the schema's own lead anywhere. */
function kindAt(root, place) {
  let kind = root;
  for (const key of place.split(".")) {
    if (kind.kind === "optional") kind = kind.of;
    if (!GROUPS.includes(kind.kind) || !Object.hasOwn(kind.of, key)) {
      throw new BadAddress(`this lab has no setting ${quoted(place)}`);
    }
    kind = kind.of[key];
  }
  return kind;
}

/** Refuse a group that lacks one of its parts. */
function complain(kind, value, place) {
  if (kind.kind === "optional" && value !== null) complain(kind.of, value, place);
  if (!GROUPS.includes(kind.kind)) return;
  for (const [key, part] of Object.entries(kind.of)) {
    if (!Object.hasOwn(value, key)) throw new BadAddress(`${place} needs ${Object.keys(kind.of).join(", ")}`);
    complain(part, value[key], place ? `${place}.${key}` : key);
  }
}

const letters = (text) =>
  encodeURIComponent(text).replace(/[!'()*~]/g, (sign) => `%${sign.charCodeAt(0).toString(16)}`);

/** Rows of rows stand between strokes, values between commas. */
function strokeOf({ entries, of }) {
  const [first] = entries ?? [of];
  return (first.of ?? first).entries ? "/" : ",";
}

/** A value as a text. */
function written(kind, value) {
  if (value === null) return NOTHING;
  switch (kind.kind) {
    case "optional":
      return written(kind.of, value);
    case "number":
      return String(value).replace("e+", "e");
    case "names":
      return value.map(letters).join(",");
    case "row":
    case "several":
      return value.map((entry, k) => written(kind.entries?.[k] ?? kind.of, entry)).join(strokeOf(kind));
    default:
      return letters(String(value));
  }
}

/** The value that a text stands for, if it is of its kind. */
function read(kind, text, name) {
  const refuse = (expected) => {
    throw new BadAddress(`${quoted(name)} is ${quoted(text)}; it must be ${expected}`);
  };
  const inside = (each, k, part) => read(each, part, `${name} ${each.label || k + 1}`);
  switch (kind.kind) {
    case "optional":
      return text === NOTHING ? null : read(kind.of, text, name);
    case "number": {
      const value = NUMBER.test(text) ? Number(text) + 0 : NaN;
      const { low, high, whole, nonzero } = kind;
      const good = value >= low && value <= high && !(whole && !Number.isInteger(value)) && !(nonzero && value === 0);
      return good
        ? value
        : refuse(`a ${whole ? "whole " : ""}number from ${low} to ${high}${nonzero ? ", not 0" : ""}`);
    }
    case "choice":
      return kind.names.includes(decoded(text)) ? decoded(text) : refuse(`one of ${kind.names.join(", ")}`);
    case "names": {
      const names = text ? text.split(",").map(decoded) : [];
      const good = names.every((each) => kind.names.includes(each)) && new Set(names).size === names.length;
      return good && names.length >= kind.least
        ? names
        : refuse(`${kind.least ? "at least one" : "some"} of ${kind.names.join(", ")}, each once`);
    }
    case "flag":
      return ["true", "false"].includes(text) ? text === "true" : refuse("true or false");
    case "text": {
      const value = decoded(text);
      return value !== null && value.length <= kind.most ? value : refuse(`a text of at most ${kind.most} letters`);
    }
    case "row": {
      const parts = text.split(strokeOf(kind));
      if (parts.length !== kind.entries.length) return refuse(`${kind.entries.length} values`);
      return parts.map((part, k) => inside(kind.entries[k], k, part));
    }
    case "several": {
      const parts = text.split(strokeOf(kind));
      return parts.length <= kind.most
        ? parts.map((part, k) => inside(kind.of, k, part))
        : refuse(`at most ${kind.most} entries`);
    }
    default:
      return refuse("told by its parts");
  }
}

/** A text as it was before it was written for an address; nothing if it was written in another way. */
function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch (error) {
    if (error instanceof URIError) return null;
    throw error;
  }
}

/** A part of an address, short enough for a sentence. */
function quoted(text) {
  return `"${text.length > 40 ? `${text.slice(0, 40)}…` : text}"`;
}
