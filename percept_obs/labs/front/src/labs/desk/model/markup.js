// MathML of what somebody types, in the order in which it stands there, also while it is not yet complete.

const DEEPEST = 40;
/** Stands where something is still missing. */
const GAP = "<mi>□</mi>";
const BRACKETS = {
  LPAR: ["RPAR", "(", ")"],
  LSQB: ["RSQB", "[", "]"],
  LBRACE: ["RBRACE", "", ""],
  _BAR_OPEN: ["_BAR_CLOSE", "|", "|"],
};
const SIGNS = {
  ...{ "-": "−", "<=": "≤", ">=": "≥", "!=": "≠", "\\le": "≤", "\\leq": "≤", "\\ge": "≥", "\\geq": "≥" },
  ...{ "\\ne": "≠", "\\neq": "≠", "\\lt": "<", "\\gt": ">" },
};
const BETWEEN = ["PLUS", "MINUS", "EQUAL", "RELATION", "COMMA"];
const ENDS = [...Object.values(BRACKETS).map(([closing]) => closing), "_LINE", "END"];
const GAPS = [...ENDS, "PLUS", "MINUS", "_TIMES", "SLASH", "_POWER", "EQUAL", "COMMA"];
const IN_BRACKETS = /^<mrow><mo[^>]*>\(<\/mo>(.*)<mo[^>]*>\)<\/mo><\/mrow>$/s;

/** MathML of a formula's words, the last of which is "END"; it never fails. */
export function markupOf(words, letters) {
  return new Writer(words, letters).line();
}

class Writer {
  at = 0;
  depth = 0;

  constructor(words, letters) {
    this.words = words;
    this.letters = letters;
  }

  get kind() {
    return this.words[this.at].type;
  }

  take() {
    const word = this.words[this.at];
    if (word.type !== "END") this.at++;
    return word;
  }

  line() {
    let found = this.sum();
    while (this.kind !== "END") found += signOf(this.take()) + this.sum();
    return `<mrow>${found}</mrow>`;
  }

  sum() {
    let found = "";
    while (!ENDS.includes(this.kind)) {
      if (BETWEEN.includes(this.kind)) found += signOf(this.take());
      found += this.product();
    }
    return found;
  }

  product() {
    let parts = [this.power()];
    while (![...ENDS, ...BETWEEN].includes(this.kind)) {
      if (this.kind === "SLASH") {
        this.take();
        const above = parts.length === 1 ? bare(parts[0]) : parts.join("");
        parts = [`<mfrac>${one(above)}${one(bare(this.power()))}</mfrac>`];
      } else if (this.kind === "_TIMES") {
        this.take();
        parts.push("<mo>·</mo>", this.power());
      } else parts.push("<mo>&#x2062;</mo>", this.power());
    }
    return parts.join("");
  }

  power() {
    const base = this.atom();
    if (this.kind === "RAISED") return raised(base, `<mn>${this.take().value}</mn>`);
    if (this.kind !== "_POWER") return base;
    this.take();
    const minus = this.kind === "MINUS" ? signOf(this.take()) : "";
    return raised(base, `<mrow>${minus}${bare(this.atom())}</mrow>`);
  }

  atom() {
    if (GAPS.includes(this.kind)) return GAP;
    const word = this.take();
    const { type, value: text } = word;
    if (BRACKETS[type]) return this.bracket(BRACKETS[type]);
    if (type === "NUMBER") return `<mn>${escaped(text)}</mn>`;
    if (type === "NAME") return this.letter(text);
    if (type === "_FRACTION") return `<mfrac>${one(bare(this.atom()))}${one(bare(this.atom()))}</mfrac>`;
    if (type === "_ROOT" || text === "sqrt") return `<msqrt>${bare(this.atom())}</msqrt>`;
    if (type === "D_DT") return "<mfrac><mi>d</mi><mrow><mi>d</mi><mi>t</mi></mrow></mfrac>";
    return `<mi>${escaped(text)}</mi>`;
  }

  /** A letter with its index and its accents, as Python prints it; another one as it stands there. */
  letter(name) {
    const stem = name.replace(/dot$/, "") || name;
    const [, letters = "", index = ""] = /^([A-Za-z]+)(\d+)$/.exec(stem) ?? [];
    const plain = index ? `<msub>${this.sign(letters)}<mi>${index}</mi></msub>` : this.sign(stem);
    const found = this.letters[stem] ?? plain;
    // not as an accent, which without a mathematical font would lie on the letter
    return stem === name ? found : `<mover>${one(found)}<mo>˙</mo></mover>`;
  }

  sign(name) {
    return this.letters[name] ?? `<mi>${escaped(name)}</mi>`;
  }

  bracket([closing, left, right]) {
    this.depth++;
    const inside = (this.depth < DEEPEST ? this.sum() : "") || GAP;
    this.depth--;
    const closed = this.kind === closing && Boolean(this.take());
    if (!left) return one(inside);
    // stretched by a browser without a mathematical font they would tower over letters
    const kind = inside.includes("<mfrac>") ? "<mo>" : '<mo stretchy="false">';
    return `<mrow>${kind}${left}</mo>${inside}${closed ? `${kind}${right}</mo>` : ""}</mrow>`;
  }
}

const escaped = (text) => text.replace(/[&<>"']/g, (sign) => `&#${sign.charCodeAt(0)};`);

function signOf({ type, value: text }) {
  return type === "_LINE" ? "<mo>;</mo>" : `<mo>${escaped(SIGNS[text] ?? text)}</mo>`;
}

/** A power; over an index, not beside it. */
function raised(base, exponent) {
  const indexed = base.startsWith("<msub>") && base.endsWith("</msub>");
  if (indexed) return `<msubsup>${base.slice(6, -7)}${exponent}</msubsup>`;
  return `<msup>${one(base)}${exponent}</msup>`;
}

/** Brackets are left out where a line or a place already keeps their content together. */
function bare(text) {
  const found = IN_BRACKETS.exec(text);
  return found ? `<mrow>${found[1]}</mrow>` : text;
}

/** One element, as fractions and powers take it. */
const one = (text) => `<mrow>${text}</mrow>`;
