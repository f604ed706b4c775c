// What the scene of the structure lab shows: the object and its estimates, in the range that each d_s stands for.

import { tracksOfPoint } from "../../old/tracks.js";
import { valueBetween } from "../../engine/between.js";
import { affine, imageVelocities, scaled } from "../../engine/velocities.js";
import { sceneInWords } from "../../state/words.js";
import { straight } from "../../old/space.js";
import { styleOf } from "../../old/line_styles.js";
import { keyOf } from "./kernels.js";
import { inverseRange, rangeOf } from "./quantities.js";

export const sceneOf = (lab) => ({
  /** Image velocities of the point and of its copies. */
  arrowsOf(shown, at, theme) {
    const { settings, image, scale, time } = shown;
    const [y1, y2, ybar3] = [0, 1, 2].map((c) => valueBetween(image, 3, c, at));
    const when = valueBetween(time, 1, 0, at);
    const { rows } = lab.results.engines[0].camera.velocities(settings, lab.kernels.of(settings), [when]);
    const [w1, w2, w3, ...v] = rows;
    // The point as the camera sees it move: -w_c x X + v_p - v_c, as rigid() has it.
    const A = [[0, w3, -w2], [-w3, 0, w1], [w2, -w1, 0]];
    const motion = [0, 1, 2].map((i) => v[3 + i] - v[i]);
    const there = [y1, y2, 1].map((value) => value / (scale * ybar3));
    const velocities = imageVelocities(there, (copy) => affine(A, motion, copy), ([x, y, z]) => [x / z, y / z]);
    return [{ place: [y1, y2], velocities, colour: theme.ink }];
  },
  /** Where no velocity is known the scale is not seen: all lengths and velocities may be larger. */
  unseenOf(shown, at, theme) {
    const { settings, image, scale } = shown;
    if (!shown.refusal || shown.refusal !== lab.model.unknowns[keyOf(settings)]?.withoutThem) return null;
    const [y1, y2, ybar3] = [0, 1, 2].map((c) => valueBetween(image, 3, c, at));
    const point = { image: [y1, y2], place: [y1, y2, 1].map((value) => value / (scale * ybar3)), colour: theme.ink };
    return { words: "the image stands still, whatever the scale", moved: (amount) => scaled([point], amount) };
  },
  tracksOf(shown, ghost, theme) {
    const along = (result, rows, run) => ({ distances: rangeOf(result, rows), ...inverseRange(result, rows, run) });
    const seen = shown.refusal ? { ...shown, truth: shown.image } : shown;
    return { tracks: tracksOfPoint(seen, ghost, along, styleOf(theme)), ray: straight };
  },
  wordsOf(shown) {
    const seen = shown.refusal ? { ...shown, truth: shown.image } : shown;
    return sceneInWords(seen, (rows) => rangeOf(shown, rows));
  },
});
