// What the scene of many points shows: each point in its colour, and its estimate as a ring in the same one.

import { columnOf, derived } from "../../common/model/derived.js";
import { readable } from "../../common/model/scales.js";
import { imageVelocities, scaled } from "../../common/model/velocities.js";
import { isTyped } from "../../common/model/typed.js";
import { OWN } from "../model/kernels.js";
import { motionAt } from "../model/motion.js";
import { DASHES } from "../../common/page/lines.js";
import { trail } from "./image_plane.js";

export function sceneOf(lab) {
  return {
    tracksOf(shown, ghost, theme, cursor) {
      const { locate } = lab.kernels.of(shown.settings);
      const seen = [0, 0, 1];
      const track = ({ points }, rows, depths, k) => ({ rows, width: 2 * points, first: 2 * k, distances: columnOf(depths, points, k) });
      const each = ({ points }, make) => Array.from({ length: points }, (_, k) => make(k));
      const truths = each(shown, (k) => ({ ...track(shown, shown.images, shown.depths, k), colour: theme.lines[k] }));
      const found = ({ estimated }) => [estimated.images, estimated.depths];
      const kept = ghost ? each(ghost, (k) => ({ ...track(ghost, ...found(ghost), k), of: {}, kept: true })) : [];
      const look = (k) => ({ colour: theme.lines[k], dash: DASHES[k], of: truths[k] });
      const inverse = (k) => derived(shown.estimated.depths, `inverse ${k}`, () => columnOf(shown.estimated.depths, shown.points, k).map((depth) => 1 / depth));
      const range = trail(shown.time, cursor);
      const estimates = each(shown, (k) => ({ ...track(shown, ...found(shown), k), inverse: inverse(k), range, ...look(k) }));
      return {
        tracks: [...truths, ...kept, ...estimates],
        ray(y1, y2, out) {
          seen[0] = y1;
          seen[1] = y2;
          return locate(seen, out);
        },
      };
    },
    /** How fast the images of the points move, and how fast they would if all of the state were nearer or farther. */
    arrowsOf(shown, at, theme) {
      const velocitiesOf = motionAt(lab, shown, at);
      return Array.from({ length: shown.points }, (_, k) => {
        const { place, velocityAt } = velocitiesOf(k);
        const velocities = imageVelocities(place, velocityAt, ([x, y, z]) => [x / z, y / z]);
        return { place: [place[0] / place[2], place[1] / place[2]], depth: place[2], velocities, colour: theme.lines[k] };
      }).filter(({ depth }) => depth > 0);
    },
    /** Without input the scale is not seen: all of the state may be larger, and moves as before. */
    unseenOf(shown, at, theme) {
      const { input, velocity } = shown.settings;
      if (shown.settings.state === OWN || isTyped(shown.settings) || input !== 0 || velocity.some((value) => value !== 0)) return null;
      const placeOf = motionAt(lab, shown, at);
      const points = Array.from({ length: shown.points }, (_, k) => ({ place: placeOf(k).place, colour: theme.lines[k] }));
      const seen = points.filter(({ place }) => place[2] > 0);
      const copies = seen.map((point) => ({ ...point, image: [point.place[0] / point.place[2], point.place[1] / point.place[2]] }));
      return { words: "no image moves, whatever the scale", moved: (amount) => scaled(copies, amount) };
    },
    wordsOf({ points, depths, estimated, time }) {
      const last = points * (time.length - 1);
      const way = (k) => [0, last].map((at) => readable(depths[at + k])).join(" to ");
      const one = (k) => `point ${k + 1} goes from depth ${way(k)} m, and its estimate ends at ${readable(estimated.depths[last + k])} m`;
      return `${Array.from({ length: points }, (_, k) => one(k)).join("; ")}.`;
    },
  };
}
