// Plain arithmetic becomes a tree: digits, letters, + - * / ^ ( ), products by juxtaposition, a few functions.
// Whatever else somebody types is Python's to read.

/**
 * @typedef {{kind: string, parts: Tree[], name?: string, n?: number}} Tree  a number, name, sum, product, minus, over
 *   (one divided by its part), power or call; n is the value of a number, or the exponent of a power
 * @typedef {{part: Tree, at: number}} Term  a term of the outermost sum, and the place behind it
 */

const FUNCTIONS = ["sqrt", "sin", "cos", "tan", "exp"];
const WORD = /\s*(?:(\d+\.?\d*|\.\d+)|([A-Za-z]\w*)|(\*\*|[-+*/^()]))/y;
const ACCENT = /(hat|tilde|bar)(\d+)$/; // it may stand before an index
const [LONGEST, DEEPEST, LONGEST_NAME, LARGEST_POWER] = [5000, 40, 12, 20];

/** What is no plain arithmetic, with its place. */
class Unread extends Error {}
const unread = (position) => Object.assign(new Unread(), { position });

/**
 * The tree of a text in which these letters may stand, and its terms; of a text that is not plain arithmetic the terms
 * before the position where that was met.
 * @returns {{tree?: Tree, terms: Term[], position?: number}}
 */
export function read(text, /** @type {Set<string>} */ letters) {
  /** @type {Term[]} */
  const terms = [];
  try {
    return { tree: treeOf(wordsOf(text, letters), terms), terms };
  } catch (error) {
    if (error instanceof Unread) return { terms, ...error };
    throw error;
  }
}

/** Numbers, names and signs with their places; letters side by side are a word each. */
function wordsOf(text, letters) {
  if (text.length > LONGEST) throw unread(LONGEST);
  const words = [];
  const end = text.trimEnd().length;
  for (WORD.lastIndex = 0; WORD.lastIndex < end; ) {
    const from = WORD.lastIndex;
    const [all, digits, name, sign] = WORD.exec(text) ?? [];
    if (all === undefined) throw unread(from + text.slice(from).search(/\S/));
    const at = from + all.search(/\S/);
    if (digits) words.push({ sign: "number", n: Number(digits), at });
    else if (FUNCTIONS.includes(name)) words.push({ sign: "call", name, at });
    else if (name) words.push(...namesIn(name.replaceAll("_", "").replace(ACCENT, "$2$1"), letters, at));
    else words.push({ sign: sign === "**" ? "^" : sign, at });
  }
  return [...words, { sign: "end", at: text.length }];
}

/** Letters of a word such as a31y1, each as long as it can be. */
function namesIn(word, letters, at) {
  const names = [];
  for (let from = 0, to; from < word.length; from = to) {
    to = Math.min(word.length, from + LONGEST_NAME);
    while (to > from && !letters.has(word.slice(from, to))) to--;
    if (to === from) throw unread(at);
    names.push({ sign: "name", name: word.slice(from, to), at });
  }
  return names;
}

function treeOf(words, terms) {
  let [next, depth] = [0, 0];
  const is = (...signs) => signs.includes(words[next].sign);
  /** The next word, which must be of this kind. */
  const take = (...signs) => {
    if (!is(...signs)) throw unread(words[next].at);
    return words[next++];
  };

  /** @returns {Tree} */
  function sum() {
    if (++depth > DEEPEST) throw unread(words[next].at);
    /** @type {Tree[]} */
    const parts = [];
    do {
      const minus = is("+", "-") && take("+", "-").sign === "-";
      const inner = product();
      parts.push(minus ? { kind: "minus", parts: [inner] } : inner);
      if (depth === 1) terms.push({ part: parts[parts.length - 1], at: words[next].at });
    } while (is("+", "-"));
    depth--;
    return parts.length > 1 ? { kind: "sum", parts } : parts[0];
  }

  function product() {
    const parts = [power()];
    // After a/b it is not clear whether what stands beside it is below, and two numbers may be one.
    for (let divided = false; is("*", "/") || (is("name", "call", "(") && !divided); ) {
      const sign = is("*", "/") ? take("*", "/").sign : "";
      divided = sign === "/";
      parts.push(divided ? { kind: "over", parts: [power()] } : power());
    }
    return parts.length > 1 ? { kind: "product", parts } : parts[0];
  }

  function power() {
    const base = atom();
    if (!is("^")) return base;
    take("^");
    const open = is("(") && take("(");
    const sign = is("-") && take("-") ? -1 : 1;
    const { n: above, at } = take("number");
    const n = open && is("/") && take("/") ? above / take("number").n : above;
    if (open) take(")");
    if (!Number.isInteger(2 * n) || n > LARGEST_POWER || is("^")) throw unread(at);
    return { kind: "power", parts: [base], n: sign * n };
  }

  function atom() {
    if (is("number", "name")) {
      const { sign: kind, n, name } = take("number", "name");
      return { kind, n, name, parts: [] };
    }
    const { name } = is("call") ? take("call") : { name: "" };
    take("(");
    const inner = sum();
    take(")");
    return name ? { kind: "call", name, parts: [inner] } : inner;
  }

  const tree = sum();
  take("end");
  return tree;
}
