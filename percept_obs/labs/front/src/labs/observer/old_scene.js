// What the scene of the observer lab shows: the point and its estimates along the rays of the imaging surface.

import { columnOf, distancesOf } from "../../engine/derived.js";
import { between, valueBetween } from "../../engine/between.js";
import { readable } from "../../draw/scales.js";
import { knownAt } from "../../engine/tables.js";
import { affine, COPIES, imageVelocities, unseenDirection } from "../../engine/velocities.js";
import { sceneInWords } from "../../state/words.js";
import { tracksOfPoint } from "../../old/tracks.js";
import { styleOf } from "../../old/line_styles.js";
import { NAMES } from "../../old/velocities.js";
import { shapeOf, varies } from "./camera.js";
import { inImage } from "./engine.js";
import { keyOf } from "./kernels.js";

/** Parts of the line that is not seen at which its points are drawn; the true one is at 0. */
const PARTS = [-1.5, 0, 1.5];
/** Largest distance between them in the image, as a part of half the picture. */
const REACH = 0.5;

/** The motion's A and b at a time that is shown. */
export function coefficientsAt(lab, { settings, time }, functions, at) {
  const { motion } = lab.results.engines[0].camera.motion(settings, functions);
  const { rows } = knownAt(motion, [], [valueBetween(time, 1, 0, at)]);
  return { A: [0, 3, 6].map((row) => Array.from(rows.subarray(row, row + 3))), b: Array.from(rows.subarray(9, 12)) };
}

/** Where a point of image coordinates and inverse distance is, in metres. */
export function placesOf(lab, { settings }) {
  const { ray } = lab.kernels.of(settings);
  const shape = shapeOf(settings);
  const placeOf = (/** @type {number[]} */ [y1, y2, inverse]) =>
    Array.from(ray([y1, y2, ...shape], new Float64Array(3)), (value) => value / inverse);
  return placeOf;
}

/** Where points are at a time of a run, and the velocities of the images of their copies. */
function velocitiesOf(lab, shown, at) {
  const functions = lab.kernels.of(shown.settings);
  const shape = shapeOf(shown.settings);
  const { A, b } = coefficientsAt(lab, shown, functions, at);
  const place = placesOf(lab, shown);
  const image = (copy) => functions.project([...copy, ...shape], new Float64Array(3));
  return (state) => {
    const there = place(state);
    return { there, velocities: imageVelocities(there, (copy) => affine(A, b, copy), image) };
  };
}

/** The states through the true one that the only output does not tell at an instant; null where there are none. */
function unseenLine(lab, shown, at, reach = Infinity) {
  const { settings, truth, width, measured } = shown;
  if (!truth?.length || measured.length > 1 || settings.scenario in lab.model.recordings) return null;
  const functions = lab.kernels.of(settings);
  if (!functions.w) return null;
  const known = coefficientsAt(lab, shown, functions, at);
  const state = [0, 1, 2].map((c) => valueBetween(truth, width, c, at));
  const w = functions.w([state[measured[0]], ...known.A.flat(), ...known.b, ...shapeOf(settings)], [0, 0]);
  const [other, inverse] = unseenDirection(w, state[2], reach);
  const stateAt = (amount) => {
    const moved = [state[0], state[1], state[2] + amount * inverse];
    moved[1 - measured[0]] += amount * other;
    return moved;
  };
  return { stateAt };
}

/** The focus of expansion of a motion that varies, at a time, with the circle about it; null where there is none. */
function focusAt(lab, shown, at) {
  const { settings } = shown;
  if (!shown.time.length || !varies(settings, lab.model)) return null;
  const functions = lab.kernels.of(settings);
  const { A, b } = coefficientsAt(lab, shown, functions, at);
  const numbers = [...A.flat(), ...b, ...shapeOf(settings)];
  const foe = inImage(functions, numbers);
  const { circle } = lab.model.forms[keyOf(settings)];
  const circleNow = () => Array.from(functions.circle([...numbers, settings.threshold], [0, 0, 0]));
  return foe && { foe, circle: circle ? circleNow() : null };
}

export function sceneOf(lab) {
  const along = ({ width }, rows, run) => ({
    distances: distancesOf(rows, width),
    inverse: columnOf(rows, width, width - 1),
    deviation: run?.deviation && columnOf(run.deviation, width, width - 1),
  });
  /** Points on the line that one output does not tell at an instant, near enough to be seen in a square. */
  const alikeOf = (shown, at, square) => {
    const line = unseenLine(lab, shown, at, REACH * (square?.half ?? 1));
    if (!line) return null;
    const velocitiesAt = velocitiesOf(lab, shown, at);
    const copies = PARTS.map((part) => {
      const state = line.stateAt(part);
      const { there, velocities } = velocitiesAt(state);
      return { place: state.slice(0, 2), at: there, velocity: velocities[1], distance: 1 / state[2], own: part === 0 };
    });
    return { copies, measured: shown.measured[0], name: shown.names[shown.measured[0]] };
  };
  /** Image velocities of the point and of its copies, where the motion is known. */
  const arrowsOf = (shown, at, theme) => {
    const { settings, truth, width } = shown;
    if (!truth?.length || settings.scenario in lab.model.recordings) return [];
    const [y1, y2, inverse] = [0, 1, 2].map((c) => valueBetween(truth, width, c, at));
    return [{ place: [y1, y2], ...velocitiesOf(lab, shown, at)([y1, y2, inverse]), colour: theme?.ink }];
  };
  return {
    tracksOf(shown, ghost, theme, cursor) {
      const { ray } = lab.kernels.of(shown.settings);
      const seen = [0, 0, ...shapeOf(shown.settings)];
      return {
        tracks: tracksOfPoint(shown, ghost, along, styleOf(theme)),
        foe: shown.foe ?? (cursor === null ? null : focusAt(lab, shown, between(shown.time, cursor))?.foe),
        ray(y1, y2, out) {
          seen[0] = y1;
          seen[1] = y2;
          return ray(seen, out);
        },
      };
    },
    arrowsOf,
    alikeOf,
    focusAt: (shown, at) => focusAt(lab, shown, at),
    /** The copies whose arrows are in the image, where they are in the scene. */
    copiesOf(shown, at, square) {
      const alike = alikeOf(shown, at, square);
      const others = alike?.copies.filter(({ own }) => !own);
      const textOf = (distance) => `${readable(distance, 2)} m`;
      if (others) return others.map(({ at: place, distance }) => ({ place, text: textOf(distance), alike: true }));
      const [arrow] = arrowsOf(shown, at, null);
      if (!arrow) return [];
      const placeOf = (k) => arrow.there.map((value) => COPIES[k] * value);
      return [0, 2].map((k) => ({ place: placeOf(k), text: NAMES[k], alike: false }));
    },
    /** Direction of both hidden coordinates that one output does not tell at an instant: w^T times it is 0. */
    unseenOf(shown, at, theme) {
      const line = unseenLine(lab, shown, at);
      if (!line) return null;
      const place = placesOf(lab, shown);
      const moved = (amount) => {
        const state = line.stateAt(amount);
        return [{ image: state.slice(0, 2), place: place(state), colour: theme.ink }];
      };
      return { words: `${shown.names[shown.measured[0]]} and its rate stay the same`, moved };
    },
    wordsOf: (shown) => sceneInWords(shown, (rows) => distancesOf(rows, shown.width)),
  };
}
