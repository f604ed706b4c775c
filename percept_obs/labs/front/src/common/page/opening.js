// The page of a lab, with its charts.

import { TimeChart } from "./charts.js";
import { build } from "./layout.js";

/** Put a lab's page inside an element and let it follow the hand; labels are those of its charts by their names. */
export function open(lab, place, labels, presets) {
  lab.charts = Object.fromEntries(Object.entries(labels).map(([name, label]) => [name, new TimeChart(name, label)]));
  lab.follow(build(lab, place, presets));
}
