// MathML of what was read, in the order in which it was typed; terms that are wrong are marked.

/** How strongly a formula holds together, where brackets may be needed. */
const STRENGTH = { sum: 0, minus: 1, product: 1, over: 1, power: 2 };
const [OPEN, CLOSE] = ['<mo stretchy="false">(</mo>', '<mo stretchy="false">)</mo>'];

/** A formula as pieces, one for each term, so that it goes on in the next line where its place is narrow. */
export function piecesOf(tree, letters, wrong = []) {
  /** A term of a sum with its sign. */
  const term = (one, place) => {
    const minus = one.kind === "minus";
    const sign = minus || place ? `<mo form="${place ? "infix" : "prefix"}">${minus ? "−" : "+"}</mo>` : "";
    const text = sign + within(minus ? one.parts[0] : one, 1);
    return wrong.includes(one) ? `<mrow class="slip">${text}</mrow>` : text;
  };
  /** A formula, in brackets if it holds together less than it must. */
  const within = (one, strength) => {
    const text = textOf(one);
    return (STRENGTH[one.kind] ?? 3) < strength ? `<mrow>${OPEN}${text}${CLOSE}</mrow>` : text;
  };
  const textOf = (one) => {
    const { kind, parts, name, n } = one;
    const [inner] = parts;
    if (kind === "number") return `<mn>${n}</mn>`;
    if (kind === "name") return letters[name];
    if (kind === "sum") return parts.map(term).join("");
    if (kind === "minus") return term(one, 0);
    if (kind === "product") return product(parts);
    if (kind === "call" && name === "sqrt") return `<msqrt>${textOf(inner)}</msqrt>`;
    if (kind === "call") return `<mi>${name}</mi><mo>&#x2061;</mo>${OPEN}${textOf(inner)}${CLOSE}`;
    return raised(within(inner, 3), `<mrow>${n < 0 ? "<mo>−</mo>" : ""}<mn>${Math.abs(n)}</mn></mrow>`);
  };
  const product = (parts) => {
    const above = parts.reduce((made, part, k) => {
      if (part.kind !== "over") return [...made, within(part, 1)];
      const whole = k === 1 ? textOf(parts[0]) : made.join("");
      return [`<mfrac><mrow>${whole}</mrow><mrow>${textOf(part.parts[0])}</mrow></mfrac>`];
    }, []);
    return above.join("<mo>&#x2062;</mo>");
  };
  return tree.kind === "sum" ? tree.parts.map(term) : [term(tree, 0)];
}

/** A power; over an index, not beside it. */
function raised(base, exponent) {
  const [, indexed] = /^<msub>(.*)<\/msub>$/s.exec(base) ?? [];
  return indexed ? `<msubsup>${indexed}${exponent}</msubsup>` : `<msup><mrow>${base}</mrow>${exponent}</msup>`;
}
