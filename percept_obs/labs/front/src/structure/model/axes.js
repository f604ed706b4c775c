// What a map of the structure lab may be over, besides gains.

import { axisAt } from "../../common/model/axes.js";

export function axesOf(_settings, model) {
  const at = (place, label) => axisAt(model, place, label);
  const each = (place, labels) => labels.map((label, k) => at(`${place}.${k}`, label));
  const parts = (letter) => [1, 2, 3].map((k) => `${letter}${k}`);
  return [
    at("noise.size", "noise in y1, y2"), at("noise.depth", "noise in ȳ3"), at("bias", "bias of ȳ3"), at("drift", "drift of ȳ3"),
    ...each("ybar", ["start y1", "start y2", "start ȳ3"]), at("scale", "true d_s"),
    ...each("v_c", parts("v_c")), ...each("v_p", parts("v_p")), ...each("w", parts("w")),
  ];
}
