// Words and trees of a formula, by the tables of `formula.lark` that Python prints: an LALR parser as lark has it.

import { Token, UnexpectedCharacters } from "./python.js";

const END = "$END";

/**
 * @typedef {{start_pos: number, end_pos: number}} Place
 * @typedef {{data: string, children: any[], meta: Place}} Tree
 */

/** The words of a text, with their places. */
export function wordsOf(tables, text) {
  tables.patterns ??= tables.terminals.map(([type, pattern]) => [type, new RegExp(pattern, "y")]);
  /** @type {Token[]} */
  const words = [];
  for (let at = 0; at < text.length; ) {
    const word = wordAt(tables.patterns, text, at);
    if (!word) throw new UnexpectedCharacters(at);
    if (!tables.ignored.includes(word.type)) words.push(word);
    at = word.end_pos;
  }
  return words;
}

function wordAt(patterns, text, at) {
  for (const [type, pattern] of patterns) {
    pattern.lastIndex = at;
    const found = pattern.exec(text)?.[0];
    if (found) return new Token(type, found, at, { end_pos: at + found.length });
  }
  return null;
}

/** A word that cannot stand where it does, with the kinds that could. */
export class UnexpectedToken extends Error {
  constructor(token, accepted) {
    super("unexpected token");
    this.token = token;
    this.accepted = accepted;
  }
}

/** The tree of words, the last of which says where the text ends. */
export function treeOf(tables, words) {
  const states = [tables.start];
  /** @type {any[]} */
  const values = [];
  for (const each of words) {
    const word = each.type === "END" ? each.update({ type: END }) : each;
    for (;;) {
      const action = tables.states[states[states.length - 1]][word.type];
      if (action === undefined) throw new UnexpectedToken(word, accepts(tables, states));
      if (action >= 0) {
        states.push(action);
        values.push(word);
        break;
      }
      const rule = tables.rules[-1 - action];
      const parts = rule.size ? values.splice(-rule.size) : [];
      if (rule.size) states.splice(-rule.size);
      values.push(made(rule, parts, word));
      states.push(tables.states[states[states.length - 1]][rule.makes]);
      if (word.type === END && states[states.length - 1] === tables.end) return values[0];
    }
  }
  throw new Error("the last word must be END");
}

/** What a rule makes of its parts: some are dropped, those of a repetition are spread out, one alone stays itself. */
function made({ name, kept, spread = [], alone }, parts, next) {
  const inside = kept.flatMap((k) => (spread.includes(k) ? parts[k].children : [parts[k]]));
  if (alone && inside.length === 1) return inside[0];
  const placed = parts.map(placeOf).filter(Boolean);
  const meta = { start_pos: placed[0]?.start_pos ?? next.start_pos, end_pos: placed.at(-1)?.end_pos ?? next.start_pos };
  return { data: name, children: inside, meta };
}

/** Where a word or a tree stands. */
export const placeOf = (node) => (node instanceof Token ? node : node.meta);

/** Kinds of words that could come next, found by trying each. */
function accepts(tables, states) {
  const kinds = Object.keys(tables.states[states[states.length - 1]]).filter((type) => type === type.toUpperCase());
  return new Set(kinds.filter((type) => takes(tables, [...states], type)));
}

function takes(tables, states, type) {
  for (;;) {
    const action = tables.states[states[states.length - 1]][type];
    if (action === undefined) return false;
    if (action >= 0) return true;
    const { size, makes } = tables.rules[-1 - action];
    if (size) states.splice(-size);
    states.push(tables.states[states[states.length - 1]][makes]);
    if (type === END && states[states.length - 1] === tables.end) return true;
  }
}
