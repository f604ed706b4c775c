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

/** The smallest of 1, 2 and 5 times a power of ten that is not below a value. */
export function roundStep(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * ([1, 2, 5].find((factor) => factor * power >= value * (1 - 1e-9)) ?? 10);
}

/** A linear range around two values, with some room. */
export function linearScale(low, high) {
  const room = high > low ? 0.08 * (high - low) : Math.max(Math.abs(low) * 0.1, 1e-3);
  return { low: low - room, high: high + room };
}

/** A logarithmic range of whole decades. */
export function logScale(low, high) {
  const bottom = Math.floor(Math.log10(low) + 1e-9);
  const top = Math.max(bottom + 1, Math.ceil(Math.log10(high) - 1e-9));
  return { low: 10 ** bottom, high: 10 ** top, log: true };
}

const SOME = 400;
const some = new Float64Array(2 * SOME);

/** Bounds between which the given parts of the finite values above a least lie, from about 400 of them. */
export function spread(values, { lowPart = 0.01, highPart = 0.99, above = -Infinity } = {}) {
  const every = Math.max(1, Math.floor(values.length / SOME));
  let count = 0;
  for (let k = 0; k < values.length; k += every) {
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
  if (Math.abs(power) <= 3) return readable(10 ** power, 4);
  return `10${String(power).replace(/[-\d]/g, (c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)]))}`;
}
