// @ts-check
// Settings as axes of a map: their range and how they are named, read and changed; and the places between their ends.

import { derived } from "../engine/derived.js";
import { schemaAt, schemaOf } from "../state/schema.js";
import { changeAt, switchOf, valueAt } from "../state/settings.js";

/**
 * @typedef {object} Axis
 * @property {string} place   the setting's, or a name of what several settings together say
 * @property {string} label   with its unit
 * @property {number} low
 * @property {number} high
 * @property {boolean} log
 * @property {boolean} records  whether another value makes another recording
 * @property {(settings: any, functions: any) => number | undefined} get  the present value, undefined where it has
 *   no meaning
 * @property {(settings: any, value: number, functions: any) => any} put  the settings with another value; null where
 *   there are none
 */

/** From this ratio of its ends on, a gain has a logarithmic axis. */
const DECADE = 10;
const DIGITS = 4;

const withUnit = (label, unit) => (unit && unit !== "1" ? `${label} in ${unit.replaceAll("^2", "²")}` : label);

/** Functions that make the axis of a number, and those of the numbers in a row; `meant` says where it has a meaning. */
export function axesAt(model) {
  const at = (place, label, meant) => axisAt(model, place, label, meant);
  const each = (place, labels, meant) => labels.map((label, k) => at(`${place}.${k}`, label, meant));
  return { at, each };
}

function axisAt(model, place, label, meant = (_settings) => true) {
  const schema = derived(model, "schema", () => schemaOf(model.schema, {}));
  const { low, high, log, unit } = /** @type {any} */ (schemaAt(schema, place));
  return {
    ...{ place, label: withUnit(label, unit), low, high, log, records: !/^(start|believed)/.test(place) },
    get: (settings) => (meant(settings) ? valueAt(settings, place) : undefined),
    // A map may still be that of settings in which it had a meaning.
    put: (settings, value) => (meant(settings) ? { ...settings, ...changeAt(settings, place, value) } : null),
  };
}

/** The axes of an observer's gains. */
export function gainAxes({ observers }, name) {
  const { gains, ways } = observers[name];
  return gains.map(({ name: gain, low, high, unit }) => {
    const place = `gains.${name}.${gain}`;
    return {
      ...{ place, label: withUnit(gain.replaceAll("_", " "), unit), low, high, records: false },
      log: low > 0 && high / low >= DECADE,
      get: (settings) => (ways[switchOf(settings, name)].includes(gain) ? settings.gains[name][gain] : undefined),
      put: (settings, value) => ({ ...settings, ...changeAt(settings, place, value) }),
    };
  });
}

/** The value at a share of the way from one end of an axis to the other, with few digits. */
export function valueOn({ low, high, log }, share) {
  const value = log ? low * (high / low) ** share : low + (high - low) * share;
  return Number(value.toPrecision(DIGITS));
}

/** The share of the way at which a value lies; what is not positive is infinitely far below a logarithmic axis. */
export function shareOf({ low, high, log }, value) {
  return log ? Math.log(Math.max(value, 0) / low) / Math.log(high / low) : (value - low) / (high - low);
}

/** The value in the middle of one of so many cells. */
export function valueIn(axis, cell, cells) {
  return valueOn(axis, (cell + 0.5) / cells);
}

/** The cell that a share of the way lies in. */
export function cellAt(share, cells) {
  return Math.min(Math.max(Math.floor(share * cells), 0), cells - 1);
}

/** Round values on an axis, few enough to be written beside each other. */
export function ticksOn({ low, high, log }, linear) {
  if (!log) return linear(low, high).filter((tick) => tick >= low && tick <= high);
  const decades = Math.log10(high / low);
  const steps = decades > 3 ? [1] : decades > 1.5 ? [1, 3] : [1, 2, 5];
  const found = /** @type {number[]} */ ([]);
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high) + 1e-9; power++) {
    for (const step of steps) found.push(Number(`${step}e${power}`));
  }
  const every = decades > 6 ? 2 : 1;
  return found.filter((tick, k) => tick >= low * (1 - 1e-9) && tick <= high * (1 + 1e-9) && k % every === 0);
}

/**
 * Observer and two axes of the map of settings.
 *
 * @param {any} settings
 * @param {any} model
 * @param {(settings: any, model: any) => Axis[]} axesOf  all axes of a lab besides gains
 * @param {any} functions
 * @returns {{observer: string, axes: Axis[], across: Axis, up: Axis}}
 */
export function planOf(settings, model, axesOf, functions) {
  const { over, observers } = settings;
  const observer = observers.includes(over.observer) ? over.observer : observers[0];
  const axes = [...gainAxes(model, observer), ...axesOf(settings, model)].filter((axis) =>
    Number.isFinite(axis.get(settings, functions)),
  );
  const across = axes.find(({ place }) => place === over.across) ?? axes[0];
  const others = axes.filter((axis) => axis !== across);
  const up = others.find(({ place }) => place === over.up) ?? others[0];
  return { observer, axes, across, up };
}
