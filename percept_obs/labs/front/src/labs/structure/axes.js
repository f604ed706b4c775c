// Axes of a map of the structure lab besides gains.

import { axesAt } from "../../old/axes.js";
import { isSampled } from "./camera.js";

export function axesOf(_settings, model) {
  const { at, each } = axesAt(model);
  const moved = (which) => each(which, parts(which), (settings) => !isSampled(settings));
  const parts = (letter) => [1, 2, 3].map((k) => `${letter}${k}`);
  return [
    at("noise.size", "noise in y1, y2"),
    at("noise.depth", "noise in ȳ3"),
    at("bias", "bias of ȳ3"),
    at("drift", "drift of ȳ3"),
    ...each("ybar", ["start y1", "start y2", "start ȳ3"]),
    at("scale", "true d_s"),
    ...["v_c", "v_p", "w_c"].flatMap(moved),
  ];
}
