// @ts-check
// A map over two settings in words.

import { valueIn } from "./axes.js";
import { DIVERGED, EACH_CELL, IMPOSSIBLE } from "./cells.js";
import { readable } from "../draw/scales.js";
import { countsOf } from "./sweep.js";
import { percent } from "../state/words.js";

/** The values of both settings at a place. */
export function placeInWords({ across, up }, place) {
  return [across, up].map(({ label }, c) => `${label} ${readable(place[c], 4)}`).join(", ");
}

/** Outcome of a cell's run in words. */
export function cellInWords({ kind, settling, error }) {
  if (kind === IMPOSSIBLE) return "no run";
  if (kind === DIVERGED) return "diverges";
  const off = Number.isNaN(error)
    ? "no estimate at the end"
    : error === Infinity
      ? "behind the camera at the end"
      : `${percent(error, 2)} off at the end`;
  return settling < Infinity ? `settles after ${readable(settling)} s, ${off}` : `does not settle, ${off}`;
}

/** The whole of a map, as far as it is filled. */
export function mapInWords({ found, present }, shows, title) {
  const level = found.levels.findLast(({ cells, done }) => done === cells * cells) ?? found.levels[0];
  const { plan } = found;
  const what = shows === "settling" ? 1 : 2;
  const { settled, never, diverged, none, least, greatest } = countsOf(level, what);
  const span = ({ label, low, high }) => `${label} from ${readable(low)} to ${readable(high)}`;
  const value = (at) => (what === 1 ? `${readable(level.values[at + 1])} s` : percent(level.values[at + 2], 2));
  const place = (at) => {
    const cell = at / EACH_CELL;
    const [i, j] = [cell % level.cells, Math.floor(cell / level.cells)];
    return placeInWords(plan, [valueIn(plan.across, i, level.cells), valueIn(plan.up, j, level.cells)]);
  };
  const parts = [`${title} over ${span(plan.across)} and ${span(plan.up)}, ${level.cells} by ${level.cells} ` +
    `places${present ? "" : ", of settings a moment ago"}`];
  parts.push(`${settled} settle, ${never} do not, ${diverged} diverge${none ? `, ${none} have no run` : ""}`);
  if (least >= 0)
    parts.push(`least ${value(least)} at ${place(least)}; greatest ${value(greatest)} at ${place(greatest)}`);
  parts.push("Noise has the same seed everywhere");
  return parts.map((part) => `${part}.`).join(" ");
}

/** Progress of a map in words. */
export function stateInWords({ found, present, whole, finest }) {
  if (!found) return "being computed";
  const cells = whole ? finest : found.levels.at(-1).cells;
  const size = `${cells} × ${cells} places`;
  return present
    ? `${size}${whole ? "" : ", getting finer"}; noise has the same seed everywhere`
    : `${size}, of settings a moment ago`;
}
