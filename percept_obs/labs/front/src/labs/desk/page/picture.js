// The image: how it moves as the typed lines have it and as it does, over all of it and at one point.

import { within } from "../../../engine/between.js";
import { readable } from "../../../draw/scales.js";
import { View } from "../../../draw/view.js";
import { Handle } from "../../../draw/handle.js";
import { arrowMark, foeMark } from "../../../draw/marks.js";

/** Half the side of what is seen, in units of the image; greatest length there of an arrow at the point. */
const [HALF, LENGTH] = [1.12, 1.1];
/** Part of the distance between two places that a long arrow of the field takes, and how pale it is. */
const [FULL, PALE] = [0.9, 0.45];
/** Part of the true motion below which a difference cannot be seen. */
const AGREE = 0.02;

/**
 * @typedef {(number | null)[]} Motion
 * @typedef {{names: string[], true: number[], mine: Motion, whole: Motion, field: any, foe: any}} Motions
 */

export class MotionPicture extends View {
  constructor(lab) {
    super("motion", "The image and how it moves", "The image");
    this.handle = new Handle({
      ...{ name: "point", label: "Point of the image: drag it, or use the arrow keys", className: "grip" },
      onMove: ([y1, y2]) => lab.movePoint([y1, y2].map((value) => Number(within(value, -1, 1).toFixed(3)))),
      onRest: () => lab.rest(),
    });
    this.figure.append(this.handle.node);
  }

  /** Draw motions at a point; `held` lets the handle be ahead of them. Return true while an arrow is on its way. */
  draw(/** @type {Motions} */ motions, at, point, theme, motion) {
    const { true: known, foe } = motions;
    const mine = filled(motions.mine, known);
    const moving = this.glide(mine ?? known, motion);
    this.begin(theme);
    const { width, height } = this;
    const scale = (Math.min(width, height) / 2) / HALF;
    const frame = {
      ...{ scale, box: { left: 0, top: 0, width, height } },
      x: (y1) => width / 2 + y1 * scale,
      y: (y2) => Math.min(height, width) / 2 - y2 * scale, // what is left of a high place is below
    };
    const [blue] = theme.lines;
    this.axes(frame);
    this.fieldOf(motions, frame, blue);
    const from = [frame.x(at[0]), frame.y(at[1])];
    const size = Math.min(...[known, mine, filled(motions.whole, known)].map((way) => roomFor(way ?? known, at)));
    const wayOf = (/** @type {any} */ [d1, d2]) => [scale * size * d1, -scale * size * d2];
    const [seen, own] = [wayOf(known), mine && wayOf(/** @type {number[]} */ (this.at))];
    const tips = [seen, own ?? seen].map((way) => way.map((value, c) => from[c] + value));
    if (own && !agrees(motions)) this.line(tips, theme.warning, { width: 1.5, dash: [4, 3] });
    this.arrow(from, seen, theme.ink, 3.5);
    if (own) this.arrow(from, own, blue, agrees(motions) ? 1.5 : 3.5);
    this.dot(from[0], from[1], 6, theme.ink);
    const far = (way) => ({ gap: 6, towards: way });
    const alike = own && agrees(motions);
    const named = { id: "true", text: alike ? "yours and true" : "true", at: tips[0], colour: theme.ink, rank: 0 };
    this.tag({ ...named, ...far(seen) });
    if (own && !alike) this.tag({ id: "yours", text: "yours", at: tips[1], colour: blue, rank: 0, ...far(own) });
    if (foe) this.foe(foe, frame, blue);
    this.handle.stand(point, frame);
    this.end();
    this.tell(inWords(motions, at));
    this.handle.describe();
    return moving;
  }

  axes({ x, y }) {
    const { theme, width, height } = this;
    this.line([[0, y(0)], [width, y(0)]], theme.grid, { width: 1 });
    this.line([[x(0), 0], [x(0), height]], theme.grid, { width: 1 });
    this.write("y1", width - 8, y(0) - 10, theme.muted, "right");
    this.write("y2", x(0) + 8, 12, theme.muted, "left");
  }

  /** A pair of arrows at each place, so long as fits between two of them. */
  fieldOf({ field, true: known, mine }, { x, y, scale }, blue) {
    const pen = this.context;
    const sizeAt = (k) => Math.hypot(...field.true.map((row) => row[k])) || 0;
    const sizes = field.places.map((_, k) => sizeAt(k)).sort((a, b) => a - b);
    const apart = Math.abs(field.places[1][0] - field.places[0][0]);
    const size = (scale * FULL * apart) / Math.max(sizes[Math.floor(0.9 * sizes.length)], 1e-9);
    const typed = filled(mine, known) !== null;
    pen.globalAlpha = PALE;
    field.places.forEach(([y1, y2], k) => {
      const whole = field.true.map((row) => row[k]);
      const own = typed ? filled(field.mine.map((row) => row[k]), whole) : null;
      this.small([x(y1), y(y2)], whole, size, this.theme.ink, 1.5);
      if (own) this.small([x(y1), y(y2)], own, size, blue, 2);
    });
    pen.globalAlpha = 1;
  }

  small([x, y], [d1, d2], size, colour, width) {
    const reach = Math.min(1, 60 / (size * Math.hypot(d1, d2) || 1));
    const to = [x + size * reach * d1, y - size * reach * d2];
    if (Math.hypot(to[0] - x, to[1] - y) > 3) arrowMark(this.context, [x, y], to, { colour, dash: [], width, head: 6 });
  }

  /** Where distance drops out of the motion: the true place, and the typed one. */
  foe({ true: [y1, y2], mine }, { x, y }, blue) {
    const { theme } = this;
    foeMark(this.context, within(x(y1), 10, this.width - 10), within(y(y2), 10, this.height - 10), theme);
    this.tag({ id: "foe", text: "true place", at: [x(y1), y(y2)], colour: theme.warning, rank: 1 });
    if (mine.includes(null)) return;
    this.ring(x(mine[0]), y(mine[1]), 9, blue);
    this.tag({ id: "own", text: "yours", at: [x(mine[0]), y(mine[1])], colour: blue, rank: 1 });
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
  const place = `At y1 = ${readable(y1)}, y2 = ${readable(y2)}, inverse distance ${readable(inverse)}/m: `;
  const each = names.map((name, k) => {
    const yours = mine[k] === null ? "" : `yours ${readable(mine[k])}, `;
    return `${name}: ${yours}true ${readable(known[k])}`;
  });
  return `${place}${each.join("; ")}.`;
}
