// What the scene of many points shows: each point in its colour, and its estimate as a ring in the same one.

import { columnOf, derived } from "../../engine/derived.js";
import { readable } from "../../draw/scales.js";
import { imageVelocities, scaled } from "../../engine/velocities.js";
import { isTyped } from "../../engine/typed.js";
import { DASHES } from "../../draw/looks.js";
import { OWN } from "./kernels.js";
import { motionAt } from "./motion.js";
import { trail } from "./old_image_plane.js";

export function sceneOf(lab) {
  return {
    tracksOf(shown, ghost, theme, cursor) {
      const { locate } = lab.kernels.of(shown.settings);
      const seen = [0, 0, 1];
      const track = ({ points }, rows, depths, k) => {
        return { rows, width: 2 * points, first: 2 * k, distances: columnOf(depths, points, k) };
      };
      const each = ({ points }, make) => Array.from({ length: points }, (_, k) => make(k));
      const truths = each(shown, (k) => ({ ...track(shown, shown.images, shown.depths, k), colour: theme.lines[k] }));
      const found = ({ estimated }) => [estimated.images, estimated.depths];
      const kept = ghost ? each(ghost, (k) => ({ ...track(ghost, ...found(ghost), k), of: {}, kept: true })) : [];
      const look = (k) => ({ colour: theme.lines[k], dash: DASHES[k], of: truths[k] });
      const { depths } = shown.estimated;
      const inverse = (k) =>
        derived(depths, `inverse ${k}`, () => columnOf(depths, shown.points, k).map((depth) => 1 / depth));
      const range = trail(shown.time, cursor);
      const estimate = (k) => ({ ...track(shown, ...found(shown), k), inverse: inverse(k), range, ...look(k) });
      const estimates = each(shown, estimate);
      return {
        tracks: [...truths, ...kept, ...estimates],
        ray(y1, y2, out) {
          seen[0] = y1;
          seen[1] = y2;
          return locate(seen, out);
        },
      };
    },
    /** Image velocities of the points, and of the same points if all of the state were nearer or farther. */
    arrowsOf(shown, at, theme) {
      const velocitiesOf = motionAt(lab, shown, at);
      return Array.from({ length: shown.points }, (_, k) => {
        const { place, velocityAt } = velocitiesOf(k);
        const velocities = imageVelocities(place, velocityAt, ([x, y, z]) => [x / z, y / z]);
        const [x, y, depth] = place;
        return { place: [x / depth, y / depth], depth, velocities, colour: theme.lines[k] };
      }).filter(({ depth }) => depth > 0);
    },
    /** Without input the scale is not seen: all of the state may be larger, and moves as before. */
    unseenOf(shown, at, theme) {
      const { input, camera_velocity } = shown.settings;
      const moved = input !== 0 || camera_velocity.some((value) => value !== 0);
      if (shown.settings.state === OWN || isTyped(shown.settings) || moved) return null;
      const placeOf = motionAt(lab, shown, at);
      const pointOf = (k) => {
        const { place } = placeOf(k);
        return { place, colour: theme.lines[k], image: [place[0] / place[2], place[1] / place[2]] };
      };
      const copies = Array.from({ length: shown.points }, (_, k) => pointOf(k)).filter(({ place }) => place[2] > 0);
      return { words: "no image moves, whatever the scale", moved: (amount) => scaled(copies, amount) };
    },
    wordsOf({ points, depths, estimated, time }) {
      const last = points * (time.length - 1);
      const way = (k) => [0, last].map((at) => readable(depths[at + k])).join(" to ");
      const end = (k) => `its estimate ends at ${readable(estimated.depths[last + k])} m`;
      const one = (k) => `point ${k + 1} goes from depth ${way(k)} m, and ${end(k)}`;
      return `${Array.from({ length: points }, (_, k) => one(k)).join("; ")}.`;
    },
  };
}
