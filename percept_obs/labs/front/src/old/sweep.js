// @ts-check
// The map over two settings that is shown: asked for when settings change that it depends on, and taken part by part.

import { cellAt, planOf, shareOf, valueIn } from "./axes.js";
import { baseOf, DIVERGED, EACH_CELL, FIRST, FOLLOWED, NOT_YET, orderOf, THEN } from "./cells.js";

/** Milliseconds in which a map's first picture is to be there, and what a cell takes as long as that is not known. */
const SOON = 40;
const SLOW = 4;
const LAST = THEN[THEN.length - 1];

/**
 * @typedef {ReturnType<typeof planOf>} Plan
 * @typedef {{cells: number, values: Float64Array, done: number}} Level  rows of cells, with how many are filled
 * @typedef {{key: string, axes: string, plan: Plan, base: any, tolerance: number, duration: number,
 *   levels: Level[]}} Found
 */

export class Sweep {
  /**
   * @param {any} model
   * @param {(settings: any, model: any) => import("./axes.js").Axis[]} axesOf
   * @param {() => void} onFound
   */
  constructor(model, axesOf, onFound) {
    this.model = model;
    this.axesOf = axesOf;
    this.onFound = onFound;
    /** @type {{ask: (task: any) => void} | null} what fills maps */
    this.filler = null;
    /** @type {Plan | null} */
    this.plan = null;
    /** @type {Found | null} what is shown */
    this.found = null;
    /** @type {Map<number, Found>} maps that were asked for, by their numbers */
    this.sent = new Map();
    /** @type {any} the settings whose map was asked for last */
    this.settings = null;
    this.key = "";
    this.id = 0;
    this.cost = SLOW;
    this.version = 0;
  }

  /** Let something else fill maps from now on. */
  fill(filler) {
    this.filler = filler;
    this.settings = null;
    this.key = "";
  }

  /** Ask for the map of settings, unless it is there or on its way. */
  want(settings, functions, tolerance) {
    if (settings === this.settings) return;
    this.settings = settings;
    const plan = planOf(settings, this.model, this.axesOf, functions);
    const { observer, across, up } = plan;
    const base = across && up ? baseOf(settings, plan, functions) : null;
    const axes = JSON.stringify([observer, across?.place, up?.place]);
    const key = JSON.stringify([base, axes]);
    this.plan = plan;
    if (key === this.key || !this.filler) return;
    const { found } = this;
    if (found && (!base || found.axes !== axes)) {
      this.found = null;
      this.sent.clear();
    }
    this.key = key;
    this.id += 1;
    if (!base) return;
    // Another worker may fill the same map.
    const levels = found?.key === key ? found.levels : [];
    this.sent.set(this.id, { key, axes, plan, base, tolerance, duration: settings.duration, levels });
    const first = FIRST.findLast((cells) => cells * cells * this.cost < SOON) ?? FIRST[0];
    this.filler.ask({ id: this.id, settings, base, first });
  }

  /** True if the shown map is of the present settings. */
  get present() {
    return this.found?.key === this.key;
  }

  /** Cells along a side of the finest complete level; 0 as long as there is none. */
  get finest() {
    return this.found?.levels.findLast(({ cells, done }) => done === cells ** 2)?.cells ?? 0;
  }

  /** True if the map is complete. */
  get whole() {
    return this.present && this.finest >= LAST;
  }

  /**
   * Take a part of a map; while a hand moves that is one of settings a moment ago.
   *
   * @param {import("./filling.js").Part} part
   */
  take({ id, cells, from, values, cost }) {
    const found = this.sent.get(id);
    if (!found) return;
    for (const earlier of this.sent.keys()) if (earlier < id) this.sent.delete(earlier);
    this.cost = cost;
    this.found = found;
    let level = found.levels.find((each) => each.cells === cells);
    if (!level) {
      level = { cells, values: new Float64Array(EACH_CELL * cells * cells), done: 0 };
      found.levels.push(level);
      found.levels.sort((one, other) => one.cells - other.cells);
    }
    const order = orderOf(found.plan, cells);
    for (let k = 0; EACH_CELL * k < values.length; k++) {
      const [i, j] = order(from + k);
      level.values.set(values.subarray(EACH_CELL * k, EACH_CELL * (k + 1)), EACH_CELL * (j * cells + i));
    }
    level.done = from + values.length / EACH_CELL;
    this.version += 1;
    this.onFound();
  }

  close() {
    this.fill(null);
    this.found = null;
    this.sent.clear();
  }
}

/**
 * The finest cell that is filled at shares of the way along both axes: what became of it, and the values that it is of.
 *
 * @param {Found} found
 * @param {number[]} shares
 */
export function cellAtShares({ plan, levels }, [x, y]) {
  for (const { cells, values } of [...levels].reverse()) {
    const [i, j] = [x, y].map((share) => cellAt(share, cells));
    const at = EACH_CELL * (j * cells + i);
    if (values[at] === NOT_YET) continue;
    const place = [valueIn(plan.across, i, cells), valueIn(plan.up, j, cells)];
    return { cells, i, j, place, kind: values[at], settling: values[at + 1], error: values[at + 2] };
  }
  return null;
}

/** Where settings lie on a map, in shares of the way along both axes. */
export function sharesOf({ across, up }, settings, functions) {
  return [across, up].map((axis) => shareOf(axis, axis.get(settings, functions)));
}

/** Summary of a level: numbers of runs that settle, diverge, or are none, and the cells of least and greatest value. */
export function countsOf({ values }, what) {
  const counts = { settled: 0, never: 0, diverged: 0, none: 0, least: -1, greatest: -1 };
  for (let at = 0; at < values.length; at += EACH_CELL) {
    const kind = values[at];
    if (kind === NOT_YET) continue;
    const settled = kind === FOLLOWED && values[at + 1] < Infinity;
    if (settled) counts.settled += 1;
    else if (kind === FOLLOWED) counts.never += 1;
    else if (kind === DIVERGED) counts.diverged += 1;
    else counts.none += 1;
    const value = kind === FOLLOWED ? values[at + what] : NaN;
    if (!Number.isFinite(value)) continue;
    if (counts.least < 0 || value < values[counts.least + what]) counts.least = at;
    if (counts.greatest < 0 || value > values[counts.greatest + what]) counts.greatest = at;
  }
  return counts;
}

