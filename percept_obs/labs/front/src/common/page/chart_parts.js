// @ts-check
// What time charts are put together from: lines, ranges, and the same in words.

import { linearScale, logScale, readable, spread } from "../model/scales.js";

export function line(name, time, values, colour, dash) {
  return { name, time, values, colour, dash };
}

/** A range around the lines that are sure, which lets others leave it by as much as it is high, and no further. */
export function rangeAround(lines, certain) {
  const bounds = lines.map((l) => [l, spread(l.values)]).filter(([, b]) => b);
  const sure = bounds.filter(([l]) => certain.includes(l)).map(([, b]) => b);
  const all = bounds.map(([, b]) => b);
  if (!all.length) return linearScale(0, 1);
  let [low, high] = hull(sure.length ? sure : all);
  if (sure.length) {
    const room = Math.max(high - low, 0.1 * Math.abs(high), 1e-6);
    const [least, most] = hull(all);
    [low, high] = [Math.max(least, low - room), Math.min(most, high + room)];
  }
  return linearScale(low, high, 3);
}

/** A logarithmic range that holds the lines' positive values, as far as they lie between a least and a most. */
export function decades(lines, least, most) {
  const positive = lines.map((l) => spread(l.values, { above: 0 })).filter(Boolean);
  if (!positive.length) return logScale(1e-3, 1);
  const [low, high] = hull(positive);
  const top = Math.min(Math.max(high, least * 10), most);
  return logScale(Math.min(Math.max(low, least), top / 10), top);
}

function hull(bounds) {
  return [Math.min(...bounds.map(([low]) => low)), Math.max(...bounds.map(([, high]) => high))];
}

/** The text equivalent of a chart: where each line begins and ends, and between what it stays. */
export function chartInWords({ title, lines }) {
  const parts = lines.map(({ name, values }) => {
    const finite = values.filter(Number.isFinite);
    if (!finite.length) return `${name}: nothing to show`;
    const least = finite.reduce((a, b) => Math.min(a, b));
    const most = finite.reduce((a, b) => Math.max(a, b));
    const [first, last] = [finite[0], finite.at(-1)];
    return `${name}: from ${readable(first)} to ${readable(last)}, between ${readable(least)} and ${readable(most)}`;
  });
  return `${title}. ${parts.join("; ")}.`;
}
