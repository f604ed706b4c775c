// The image: how it moves as the typed lines have it and as it does, over all of it and at one point.

import { within } from "../../../engine/between.js";
import { readable } from "../../../draw/scales.js";
import { View } from "../../../draw/view.js";
import { Handle } from "../../../draw/handle.js";
import { arrowMark, foeMark } from "../../../draw/marks.js";

/** Half the side of what is seen and the longest arrow, in units of the image; the least difference that is seen. */
const [HALF, LENGTH, AGREE] = [1.12, 1.1, 0.02];
/** Of the field: part of the way to the next place that a long arrow takes, how pale it is, its most pixels. */
const [FULL, PALE, MOST] = [0.9, 0.45, 60];

/** @typedef {{names: string[], true: number[], mine: any, whole: any, field: any, foe: any}} Motions */

export class MotionPicture extends View {
  constructor(lab) {
    super("motion", "The image and how it moves", "The image");
    const inside = (value) => Number(within(value, -1, 1).toFixed(3));
    this.handle = new Handle({
      ...{ name: "point", label: "Point of the image: drag it, or use the arrow keys", className: "grip" },
      onMove: ([y1, y2]) => lab.change({ point: [inside(y1), inside(y2), lab.settings.point[2]] }),
      onRest: () => lab.rest(),
    });
    this.figure.append(this.handle.node);
  }

  /** Draw motions at a point; the handle may be ahead of them.  Return true while an arrow is on its way. */
  draw(/** @type {Motions} */ motions, { settings: { point: at } }, point, theme, motion) {
    const { true: known, foe } = motions;
    const mine = filled(motions.mine, known);
    const moving = this.glide(mine ?? known, motion);
    this.begin(theme);
    const { width, height } = this;
    const scale = Math.min(width, height) / 2 / HALF;
    const [x, y] = [(y1) => width / 2 + y1 * scale, (y2) => height / 2 - y2 * scale];
    const [blue] = theme.lines;
    for (const axis of [[[0, y(0)], [width, y(0)]], [[x(0), 0], [x(0), height]]])
      this.line(axis, theme.grid, { width: 1 });
    this.write("y1", width - 8, y(0) - 10, theme.muted, "right");
    this.write("y2", x(0) + 8, 12, theme.muted, "left");
    this.fieldOf(motions, { x, y, scale });
    const from = [x(at[0]), y(at[1])];
    const size = Math.min(...[known, mine, filled(motions.whole, known)].map((way) => roomFor(way ?? known, at)));
    const wayOf = (/** @type {any} */ [d1, d2]) => [scale * size * d1, -scale * size * d2];
    const [seen, own, alike] = [wayOf(known), mine && wayOf(this.at), mine && agrees(motions)];
    const tips = [seen, own ?? seen].map((way) => way.map((value, c) => from[c] + value));
    if (own && !alike) this.line(tips, theme.warning, { width: 1.5, dash: [4, 3] });
    this.arrow(from, seen, theme.ink, 3.5);
    if (own) this.arrow(from, own, blue, alike ? 1.5 : 3.5);
    this.dot(from[0], from[1], 6, theme.ink);
    const label = (text, at, colour, towards) => this.tag({ id: text, text, at, colour, rank: 0, gap: 6, towards });
    label(alike ? "yours and true" : "true", tips[0], theme.ink, seen);
    if (own && !alike) label("yours", tips[1], blue, own);
    if (foe) this.foe(foe, x, y);
    this.handle.stand(point, { scale, box: { left: 0, top: 0, width, height }, x, y });
    this.end();
    this.tell(inWords(motions, at));
    this.handle.describe();
    return moving;
  }

  /** A pair of arrows at each place, so long as fits between two of them. */
  fieldOf({ field, true: known, mine }, { x, y, scale }) {
    const pen = this.context;
    const whole = field.places.map((_, k) => field.true.map((row) => row[k]));
    const sizes = whole.map((way) => Math.hypot(...way) || 0).sort((a, b) => a - b);
    const apart = Math.abs(field.places[1][0] - field.places[0][0]);
    const size = (scale * FULL * apart) / Math.max(sizes[Math.floor(0.9 * sizes.length)], 1e-9);
    const arrow = ([left, top], [d1, d2], colour, width) => {
      const reach = size * Math.min(1, MOST / (size * Math.hypot(d1, d2) || 1));
      const to = [left + reach * d1, top - reach * d2];
      if (Math.hypot(reach * d1, reach * d2) > 3) arrowMark(pen, [left, top], to, { colour, dash: [], width, head: 6 });
    };
    pen.globalAlpha = PALE;
    field.places.forEach(([y1, y2], k) => {
      arrow([x(y1), y(y2)], whole[k], this.theme.ink, 1.5);
      const own = filled(mine, known) && filled(field.mine.map((row) => row[k]), whole[k]);
      if (own) arrow([x(y1), y(y2)], own, this.theme.lines[0], 2);
    });
    pen.globalAlpha = 1;
  }

  /** Where distance drops out of the motion: the true place, and the typed one. */
  foe({ true: [y1, y2], mine }, x, y) {
    const { theme, width, height } = this;
    foeMark(this.context, within(x(y1), 10, width - 10), within(y(y2), 10, height - 10), theme);
    this.tag({ id: "foe", text: "true place", at: [x(y1), y(y2)], colour: theme.warning, rank: 1 });
    if (mine.includes(null)) return;
    this.ring(x(mine[0]), y(mine[1]), 9, theme.lines[0]);
    this.tag({ id: "own", text: "yours", at: [x(mine[0]), y(mine[1])], colour: theme.lines[0], rank: 1 });
  }
}

/** A motion, of which what is not typed is taken from the truth; null where nothing is. */
function filled(mine, known) {
  return mine.every((value) => value === null) ? null : mine.map((value, k) => value ?? known[k]);
}

/** The scale at which a motion is as long as an arrow may be, and its tip in the picture. */
function roomFor(motion, at) {
  const along = motion.map((value, c) => (HALF - 0.04 - Math.sign(value) * at[c]) / Math.max(Math.abs(value), 1e-9));
  return Math.min(...along, LENGTH / Math.max(Math.hypot(...motion), 1e-9));
}

/** Return true where both motions look the same at the point. */
export function agrees({ mine, true: known }) {
  const own = filled(mine, known);
  return own !== null && Math.hypot(own[0] - known[0], own[1] - known[1]) <= AGREE * Math.hypot(...known);
}

function inWords({ names, mine, true: known }, [y1, y2, inverse]) {
  const yours = (k) => (mine[k] === null ? "" : `yours ${readable(mine[k])}, `);
  const each = names.map((name, k) => `${name}: ${yours(k)}true ${readable(known[k])}`);
  return `At y1 = ${readable(y1)}, y2 = ${readable(y2)}, inverse distance ${readable(inverse)}/m: ${each.join("; ")}.`;
}
