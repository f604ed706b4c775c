// Words and trees of a formula, by the tables of `formula.lark` that Python prints: an LALR parser as lark has it.

const END = "$END";

/** A text that is no formula: where, and by the kind of reason. */
export class CannotRead extends Error {
  constructor(reason, at, parts = {}) {
    super(reason);
    this.reason = reason;
    this.at = at;
    this.parts = parts;
  }
}

/**
 * @typedef {{type: string, text: string, at: number, end: number}} Word
 * @typedef {{rule: string, parts: any[], at: number}} Tree
 */

/** The words of a text, with their places. */
export function wordsOf(tables, text) {
  tables.patterns ??= tables.terminals.map(([type, pattern]) => [type, new RegExp(pattern, "y")]);
  /** @type {Word[]} */
  const words = [];
  for (let at = 0; at < text.length; ) {
    const word = wordAt(tables.patterns, text, at);
    if (!word) throw new CannotRead("character", at);
    if (!tables.ignored.includes(word.type)) words.push(word);
    at = word.end;
  }
  return words;
}

function wordAt(patterns, text, at) {
  for (const [type, pattern] of patterns) {
    pattern.lastIndex = at;
    const found = pattern.exec(text)?.[0];
    if (found) return { type, text: found, at, end: at + found.length };
  }
  return null;
}

/** The tree of words, the last of which says where the text ends. */
export function treeOf(tables, words) {
  const states = [tables.start];
  /** @type {any[]} */
  const values = [];
  for (const word of words.map((each) => (each.type === "END" ? { ...each, type: END } : each))) {
    for (;;) {
      const row = tables.states[states[states.length - 1]];
      const action = row[word.type];
      if (action === undefined) throw new CannotRead("word", word.at, { type: word.type });
      if (action >= 0) {
        states.push(action);
        values.push(word);
        break;
      }
      const rule = tables.rules[-1 - action];
      const parts = rule.size ? values.splice(-rule.size) : [];
      if (rule.size) states.splice(-rule.size);
      values.push(made(rule, parts, word.at));
      states.push(tables.states[states[states.length - 1]][rule.makes]);
      if (word.type === END && states[states.length - 1] === tables.end) return values[0];
    }
  }
  throw new Error("the last word must be END");
}

/** What a rule makes of its parts: some are dropped, those of a repetition are spread out, one alone stays itself. */
function made({ name, kept, spread = [], alone }, parts, at) {
  const inside = kept.flatMap((k) => (spread.includes(k) ? parts[k].parts : [parts[k]]));
  if (alone && inside.length === 1) return inside[0];
  return { rule: name, parts: inside, at: parts[0]?.at ?? at };
}
