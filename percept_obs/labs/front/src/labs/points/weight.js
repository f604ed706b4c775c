// @ts-check
// P of the observer: a diagonal that is given over time, or the start of one that is computed.

import { diagonal } from "./symmetric.js";

/** Kinds of a P that is computed along with the estimate. */
const COMPUTED = ["lyapunov", "riccati"];

export function isComputed({ weight }) {
  return COMPUTED.includes(weight);
}

/** The typed text of P, over time or at the start of a computed one; empty where nothing is typed. */
export function textOfP({ weight, P, P0 }) {
  return weight === "typed" ? P : COMPUTED.includes(weight) ? P0.trim() : "";
}

/** Python's answer to the typed P: its number of entries, 1 or 3, whether they vary, their Python text. */
export function readP({ written = {} }, settings) {
  const { entries = 1, varies = true, python } = written[textOfP(settings)] ?? {};
  return { entries, varies, python };
}

/**
 * The inverse of a given P, as entries of its diagonal: a row for each of the times, or a single one where it is
 * constant.
 */
export function inversesOf(model, settings, times, { typed }) {
  const { weight, size, final, duration } = settings;
  const scheduled = (t) => 1 / (size * (final / size) ** (t / duration));
  if (weight === "scheduled") return { entries: 1, constant: false, rows: Float64Array.from(times, scheduled) };
  if (weight !== "typed") return { entries: 1, constant: true, rows: Float64Array.of(1 / size) };
  const { entries, varies } = readP(model, settings);
  const used = varies ? times : times.subarray(0, 1);
  const rows = new Float64Array(entries * used.length);
  used.forEach((t, k) => {
    const row = typed([t, size], rows.subarray(entries * k, entries * k + entries));
    const bad = row.find((value) => !(value > 0 && value < Infinity));
    if (bad !== undefined) {
      const at = `${bad.toPrecision(3)} at ${t.toPrecision(3)} s`;
      throw new Error(`P is ${at}. It must be positive at all times: type another one.`);
    }
    row.forEach((value, i) => (row[i] = 1 / value));
  });
  return { entries, constant: !varies, rows };
}

/** A computed P of n states at its start, row by row. */
export function startOfP(model, settings, n, { typed }) {
  const { entries } = readP(model, settings);
  const given = textOfP(settings) ? typed([0, settings.size], new Float64Array(entries)) : [settings.size];
  return diagonal(n, (i) => given[i % entries]);
}
