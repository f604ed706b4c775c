// What the scene of the observer lab shows: the point and its estimates along the rays of the imaging surface.

import { columnOf, distancesOf } from "../../common/model/derived.js";
import { sceneInWords } from "../../common/model/words.js";
import { tracksOfPoint } from "../../common/model/tracks.js";
import { lookOf } from "../../common/page/lines.js";
import { shapeOf } from "../model/camera.js";

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
    wordsOf: (shown) => sceneInWords(shown, (rows) => distancesOf(rows, shown.width)),
  };
}
