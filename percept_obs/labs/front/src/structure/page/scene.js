// What the scene of the structure lab shows: the object and its estimates, in the range that each d_s stands for.

import { tracksOfPoint } from "../../common/model/tracks.js";
import { sceneInWords } from "../../common/model/words.js";
import { straight } from "../../common/model/space.js";
import { lookOf } from "../../common/page/lines.js";
import { inverseRange, rangeOf } from "../model/quantities.js";

export const SCENE = {
  tracksOf(shown, ghost, theme) {
    const along = (result, rows, run) => ({ distances: rangeOf(result, rows), ...inverseRange(result, rows, run) });
    const seen = shown.refusal ? { ...shown, truth: shown.image } : shown;
    return { tracks: tracksOfPoint(seen, ghost, along, lookOf(theme)), ray: straight };
  },
  wordsOf: (shown) => sceneInWords(shown.refusal ? { ...shown, truth: shown.image } : shown, (rows) => rangeOf(shown, rows)),
};
