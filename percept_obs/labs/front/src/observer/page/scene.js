// What the scene of the observer lab shows: the point and its estimates along the rays of the imaging surface.

import { columnOf, distancesOf } from "../../common/model/derived.js";
import { valueBetween } from "../../common/model/playback.js";
import { knownAt } from "../../common/model/tables.js";
import { affine, imageVelocities, unseenDirection } from "../../common/model/velocities.js";
import { sceneInWords } from "../../common/model/words.js";
import { tracksOfPoint } from "../../common/model/tracks.js";
import { lookOf } from "../../common/page/lines.js";
import { shapeOf } from "../model/camera.js";

/** The motion's A and b at a time that is shown. */
function coefficientsAt(lab, { settings, time }, functions, at) {
  const { motion } = lab.results.engines[0].camera.motion(settings, functions);
  const { rows } = knownAt(motion, [], [valueBetween(time, 1, 0, at)]);
  return { A: [0, 3, 6].map((row) => Array.from(rows.subarray(row, row + 3))), b: Array.from(rows.subarray(9, 12)) };
}

export function sceneOf(lab) {
  const along = ({ width }, rows, run) => ({
    distances: distancesOf(rows, width),
    inverse: columnOf(rows, width, width - 1),
    deviation: run?.deviation && columnOf(run.deviation, width, width - 1),
  });
  return {
    tracksOf(shown, ghost, theme) {
      const { ray } = lab.kernels.of(shown.settings);
      const seen = [0, 0, ...shapeOf(shown.settings)];
      return {
        tracks: tracksOfPoint(shown, ghost, along, lookOf(theme)),
        foe: shown.foe,
        ray(y1, y2, out) {
          seen[0] = y1;
          seen[1] = y2;
          return ray(seen, out);
        },
      };
    },
    /** How fast the image of the point and of its copies moves, where the motion is known. */
    arrowsOf(shown, at, theme) {
      const { settings, truth, width } = shown;
      if (!truth?.length || settings.scenario in lab.model.recordings) return [];
      const functions = lab.kernels.of(settings);
      const { ray, project } = functions;
      const shape = shapeOf(settings);
      const out = new Float64Array(3);
      const place = [0, 1].map((c) => valueBetween(truth, width, c, at));
      const distance = 1 / valueBetween(truth, width, width - 1, at);
      const there = Array.from(ray([...place, ...shape], out), (value) => value * distance);
      const { A, b } = coefficientsAt(lab, shown, functions, at);
      const velocityAt = (copy) => affine(A, b, copy);
      return [{ place, velocities: imageVelocities(there, velocityAt, (copy) => project([...copy, ...shape], out)), colour: theme.ink }];
    },
    /** Of one output an instant does not tell a direction of both hidden coordinates: w^T times it is 0. */
    unseenOf(shown, at, theme) {
      const { settings, truth, width, measured } = shown;
      if (!truth?.length || measured.length > 1 || settings.scenario in lab.model.recordings) return null;
      const functions = lab.kernels.of(settings);
      const { w, ray } = functions;
      if (!w) return null;
      const known = coefficientsAt(lab, shown, functions, at);
      const shape = shapeOf(settings);
      const state = [0, 1, 2].map((c) => valueBetween(truth, width, c, at));
      const [other, inverse] = w([state[measured[0]], ...known.A.flat(), ...known.b, ...shape], [0, 0]);
      const direction = unseenDirection([other, inverse], state[2]);
      const moved = (amount) => {
        const image = [state[0], state[1]];
        image[1 - measured[0]] += amount * direction[0];
        const distance = 1 / (state[2] + amount * direction[1]);
        const place = Array.from(ray([...image, ...shape], [0, 0, 0]), (value) => value * distance);
        return [{ image, place, colour: theme.ink }];
      };
      return { words: `${shown.names[measured[0]]} and its rate stay the same`, moved };
    },
    wordsOf: (shown) => sceneInWords(shown, (rows) => distancesOf(rows, shown.width)),
  };
}
