// The course of an error in the size of a word: decades upwards, time to the right, the tolerance dotted.

import { within } from "../model/playback.js";

const SPACE = "http://www.w3.org/2000/svg";
const [WIDTH, HEIGHT] = [104, 26];
/** Decades of the error between which it is drawn. */
const [LOW, HIGH] = [-4, 2];

/**
 * A small picture of errors at the same times, each with the name of its style; the first lies below.
 *
 * @param {[style: string, error: ArrayLike<number> | null][]} errors
 */
export function spark(errors, tolerance) {
  const picture = document.createElementNS(SPACE, "svg");
  for (const [key, value] of Object.entries({ class: "spark", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, "aria-hidden": "true" })) picture.setAttribute(key, value);
  const add = (style, path) => {
    const node = document.createElementNS(SPACE, "path");
    node.setAttribute("class", style);
    node.setAttribute("d", path);
    picture.append(node);
  };
  const level = heightOf(tolerance);
  add("spark-level", `M0 ${level}H${WIDTH}`);
  for (const [style, error] of errors) if (error) add(style, pathOf(error));
  return picture;
}

function heightOf(value) {
  const share = (Math.log10(Math.max(value, 1e-30)) - LOW) / (HIGH - LOW);
  return Number((1 + (HEIGHT - 2) * (1 - within(share, 0, 1))).toFixed(1));
}

/** One path, with the largest error of each column, and gaps where there is none. */
function pathOf(error) {
  let path = "";
  let before = false;
  for (let x = 0; x < WIDTH; x++) {
    let most = NaN;
    const [from, to] = [x, x + 1].map((at) => Math.floor((at * error.length) / WIDTH));
    for (let k = from; k < Math.max(to, from + 1); k++) if (!(error[k] <= most)) most = error[k];
    const there = !Number.isNaN(most);
    if (there) path += `${before ? "L" : "M"}${x} ${heightOf(most)}`;
    before = there;
  }
  return path;
}
