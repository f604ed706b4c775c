// Axes of a map of the observer lab besides gains: settings, and combinations of several.

import { axesAt } from "../../old/axes.js";
import { shapeOf, varies } from "./camera.js";
import { focusOf, translationTowards } from "./engine.js";

/** The largest length and speed that settings hold. */
const FARTHEST = 1000;

const inReach = (values) => values.every((value) => Math.abs(value) <= FARTHEST);

export function axesOf(settings, model) {
  const recorded = settings.scenario in model.recordings;
  const { at, each } = axesAt(model);
  const chosen = each(
    "start.values",
    ["start of ŷ1", "start of ŷ2", "start of ŷ3"],
    ({ start }) => start.mode === "chosen",
  );
  if (recorded) return chosen;
  const moved = model.scenarios[settings.scenario]?.track
    ? []
    : [...each("b", ["b1", "b2", "b3"]), ...(varies(settings, model) ? [] : [0, 1].map((c) => focusAxis(model, c)))];
  return [
    at("noise.size", "noise, bound or σ"),
    at("dropout", "share of lost samples"),
    ...moved,
    ...[0, 1, 2].map(seenAxis),
    ...each("X0", ["start X", "start Y", "start Z"]),
    ...each("believed.b", ["believed b1", "believed b2", "believed b3"], ({ believed }) => believed !== null),
    ...chosen,
    at("xi", "ξ of the mirror", ({ surface }) => surface === "unified"),
  ];
}

/** The focus of expansion, moved with the distance of b kept. */
function focusAxis(model, c) {
  return {
    ...{ place: `foe.${c}`, label: `focus of expansion, y${c + 1}`, low: -3, high: 3, log: false, records: true },
    get: (settings, functions) => focusOf(settings, functions, model)?.[c],
    put(settings, value, functions) {
      const foe = focusOf(settings, functions, model);
      const b = foe && translationTowards(foe.with(c, value), settings, functions);
      return b && inReach(b) ? { ...settings, b } : null;
    },
  };
}

/** Where the point is seen at time 0, and how far it is then, as the surface measures distance. */
function seenAxis(_, c) {
  const range = c < 2 ? { low: -1.5, high: 1.5, log: false } : { low: 1, high: 50, log: true };
  const seen = (settings, { project }) => Array.from(project([...settings.X0, ...shapeOf(settings)], [0, 0, 0]));
  return {
    ...{ place: `seen.${c}`, label: ["start y1", "start y2", "start distance in m"][c], ...range, records: true },
    get: (settings, functions) => seen(settings, functions)[c],
    put(settings, value, functions) {
      const [y1, y2, distance] = seen(settings, functions).with(c, value);
      const X0 = Array.from(functions.ray([y1, y2, ...shapeOf(settings)], [0, 0, 0]), (part) => part * distance);
      return inReach(X0) ? { ...settings, X0 } : null;
    },
  };
}
