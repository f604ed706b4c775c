// Ranges, ticks and number words of axes.

/** From this power of ten on, numbers are told by it. */
const PLAIN = 6;

/** A number for people, as number() in Python's verdict.py: plain up to a million, and no zero with a sign. */
export function short(value, digits = 3) {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "nan" : value > 0 ? "inf" : "-inf";
  if (value === 0) return "0";
  const [mantissa, exponent] = rounded(value, digits).split("e");
  const power = Number(exponent);
  if (power >= digits && power < PLAIN) return String(Number(`${mantissa}e${power}`));
  if (power < -4 || power >= digits) {
    const bare = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
    return `${bare}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
  }
  const plain = Number(`${mantissa}e${power}`).toFixed(Math.max(0, digits - 1 - power));
  return plain.includes(".") ? plain.replace(/\.?0+$/, "") : plain;
}

/** As toExponential, but for a number halfway between two, which goes to the even digit as in Python. */
function rounded(value, digits) {
  const [mantissa, power] = value.toExponential(60).split("e");
  const sign = value < 0 ? "-" : "";
  const all = mantissa.replace(/[-.]/g, "");
  const head = all.slice(0, digits);
  if (!/^50*$/.test(all.slice(digits)) || Number(head.at(-1)) % 2) return value.toExponential(digits - 1);
  return `${sign}${head[0]}${digits > 1 ? `.${head.slice(1)}` : ""}e${power}`;
}

/** A number for people: a true minus sign, no padded exponent; what is not there is none. */
export function readable(value, digits = 3) {
  if (Number.isNaN(value)) return "none";
  return short(value, digits)
    .replace(/e\+?(-?)0*(\d+)/, "e$1$2")
    .replace(/-/g, "−");
}

/** Distance between ticks that divides a span into about so many round parts. */
function roundStep(span, parts) {
  const rough = span / Math.max(1, parts);
  const power = 10 ** Math.floor(Math.log10(rough));
  const factor = [1, 2, 5].find((f) => f * power >= rough * 0.999) ?? 10;
  return factor * power;
}

/** A linear range, widened to round numbers. */
export function linearScale(low, high, parts = 4) {
  if (!(high > low)) {
    const margin = Math.max(Math.abs(low) * 0.1, 1e-3);
    [low, high] = [low - margin, high + margin];
  }
  const step = roundStep(high - low, parts);
  const [bottom, top] = [Math.floor(low / step + 1e-9) * step, Math.ceil(high / step - 1e-9) * step];
  const count = Math.round((top - bottom) / step);
  const ticks = Array.from({ length: count + 1 }, (_, k) => Number((bottom + k * step).toPrecision(12)));
  return { low: bottom, high: top, ticks, log: false };
}

/** A logarithmic range of whole decades. */
export function logScale(low, high) {
  const bottom = Math.floor(Math.log10(low) + 1e-9);
  const top = Math.max(bottom + 1, Math.ceil(Math.log10(high) - 1e-9));
  const every = Math.ceil((top - bottom) / 4);
  const ticks = Array.from({ length: Math.floor((top - bottom) / every) + 1 }, (_, k) => 10 ** (bottom + k * every));
  return { low: 10 ** bottom, high: 10 ** top, ticks, log: true };
}

/** The scale that was drawn before, if the one that is wanted lies in it and is not lost there. */
export function keptScale(before, wanted) {
  if (!before || Boolean(before.log) !== Boolean(wanted.log)) return wanted;
  const [[low, high], [least, most]] = [before, wanted].map((scale) =>
    [scale.low, scale.high].map(scale.log ? Math.log10 : Number),
  );
  const slack = 1e-9 * (high - low);
  return least >= low - slack && most <= high + slack && most - least > 0.4 * (high - low) ? before : wanted;
}

const SOME = 400;
const some = new Float64Array(2 * SOME);

/** Bounds between which the given parts of the finite values above a least lie, from about 400 of them. */
export function spread(values, { lowPart = 0.01, highPart = 0.99, above = -Infinity, first = 0, width = 1 } = {}) {
  const every = width * Math.max(1, Math.floor(values.length / width / SOME));
  let count = 0;
  for (let k = first; k < values.length; k += every) {
    const value = values[k];
    if (value > above && value < Infinity) some[count++] = value;
  }
  if (!count) return null;
  const sorted = some.subarray(0, count).sort();
  const at = (part) => sorted[Math.round(part * (count - 1))];
  return [at(lowPart), at(highPart)];
}

export function tickLabel(value, log) {
  if (!log) return readable(value, 4);
  const power = Math.round(Math.log10(value));
  const raised = String(power).replace(/[-\d]/g, (c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)]));
  return power === 0 ? "1" : power === 1 ? "10" : `10${raised}`;
}
