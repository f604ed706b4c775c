// The image plane: the point's path, the estimates, and a handle.

import { between, valueBetween } from "../engine/between.js";
import { spread } from "../draw/scales.js";
import { rimOf } from "./space.js";
import { indicesIn } from "./timeline.js";
import { meanSpeed } from "../engine/velocities.js";
import { imagePlaneInWords } from "../state/words.js";
import { hull } from "../draw/lines.js";
import { button } from "../ui/dom.js";
import { Handle } from "../draw/handle.js";
import { clipTo, drawAxes, drawEnds, drawPath, holds, placed, showsToo, squareAround } from "./image_frame.js";
import { opacityOf } from "./line_styles.js";
import { DASHES, KEPT, SOLID } from "../draw/looks.js";
import { LabelledPicture, meet } from "../draw/labels.js";
import { foeMark, ghostMark, pointMark, rimMark } from "../draw/marks.js";
import { drawSwung } from "./swing.js";
import { drawAlike, drawVelocities } from "./velocities.js";

/** Opacity of the path at times that are not in sight. */
const OTHER_TIMES = 0.2;
/** The button on the picture, and its size from the right and upper rim on. */
const [FIT, FITTING] = ["Fit", [84, 30]];
/** Points of a path from which labels keep away. */
const MOST = 40;
/** Radius of a handle that has a number, and half the size of the number. */
const [NUMBERED, NUMBER] = [12, [5, 7]];
/** From the middle of a mark to its name. */
const BESIDE = 12;
const NONE = /** @type {(...of: any[]) => any} */ (() => null);

/** A picture of a square of the image, with handles to drag. */
export class FramedImage extends LabelledPicture {
  constructor(lab, handles) {
    super("image-plane", "Image plane");
    this.lab = lab;
    /** @type {ReturnType<typeof squareAround> | null} */
    this.square = null;
    this.handles = handles.map((handle) => new Handle(handle));
    this.choices = 0;
    /** @type {any} the scene beside it */
    this.scene = null;
    const fit = () => {
      this.square = null;
      this.fitting.hidden = true;
      lab.redraw();
    };
    const attributes = { class: "fitting", hidden: true, "data-control": "fit image", title: "Show all of the path" };
    this.fitting = button(FIT, fit, attributes);
    this.figure.append(this.fitting, ...this.handles.map(({ node }) => node));
  }

  /** Return the square that stays while a hand moves something and after: a choice, or a press on "Fit", changes it. */
  squareFor(squareOf) {
    const { square, lab } = this;
    if (square && lab.held) return square;
    const wanted = squareOf();
    if (!square) return wanted;
    const there = showsToo(square, wanted);
    const chosen = this.choices !== lab.choices;
    this.choices = lab.choices;
    this.fitting.hidden = there || chosen;
    return there || !chosen ? square : wanted;
  }

  /** Paint inside a square, and put handles in their places. */
  paint(squareOf, theme, { inside, outside = (_pen, _frame) => {}, room = 0 }, placesIn) {
    this.begin(theme);
    const square = (this.square = this.squareFor(squareOf));
    const frame = { ...placed(this, square, room), picture: this, lineWidth: theme.width };
    const pen = this.context;
    this.underlay([square, theme, room], () => drawAxes(this, frame, square.ticks, theme));
    if (!this.fitting.hidden) this.report(FIT, [this.width - FITTING[0], 0, this.width, FITTING[1]]);
    const places = placesIn(square);
    this.handles.forEach((handle, k) => handle.stand(places[k], frame, this.lab.late));
    this.number();
    pen.save();
    clipTo(pen, frame.box);
    inside(pen, frame);
    pen.restore();
    outside(pen, frame);
    this.end();
  }

  /** Keep labels away from handles, of which the lower ones hide their numbers where others lie on them. */
  number() {
    for (const { node, text, there } of this.handles.toReversed()) {
      if (!there) continue;
      const [[x, y], [across, down]] = [there, NUMBER];
      const box = [x - across, y - down, x + across, y + down];
      const covered = Boolean(text) && this.taken.some((other) => meet(box, other));
      node.classList.toggle("covered", covered);
      if (text && !covered) this.report(text, box);
      this.avoid(x, y, NUMBERED);
    }
  }

  /** Keep labels away from a path, where they find another place. */
  busyAlong(rows, width, { x, y }) {
    const every = width * Math.max(1, Math.floor(rows.length / width / MOST));
    let before = /** @type {number[] | null} */ (null);
    for (let k = 0; k + 1 < rows.length; k += every) {
      const at = [x(rows[k]), y(rows[k + 1])];
      this.busy.push([at[0] - 3, at[1] - 3, at[0] + 3, at[1] + 3]);
      if (before) this.avoidLine(before, at, this.busy);
      before = at;
    }
  }

  /** Draw the images of the copies that swing along what is not seen. */
  swing(pen, { box, x, y }, shown, cursor, theme) {
    const swung = this.scene?.swung(shown, cursor, theme);
    if (!swung) return;
    drawSwung(pen, swung, ({ image: [y1, y2] }) => [x(y1), y(y2)], theme);
    this.caption("swung", swung.words, box, theme.ink, 1);
  }

  /** Write words in a corner of the square, as far as they have room. */
  caption(id, words, { left, top, side }, colour, rank) {
    const text = this.shortened(words, side - 12);
    this.tag({ id, text, at: [left, top], within: [left, top, left + side, top + side], colour, rank });
  }
}

/**
 * The image of one point.  `placeOf` says of a result where the handle stands, and `onMove` takes where it is moved to;
 * `arrowsOf`, `alikeOf` and `focusAt` are the scene's.
 */
export class ImagePlane extends FramedImage {
  /** The map under the track, if there is one. */
  map = /** @type {any} */ (null);

  constructor(lab, { name, label, tag, onMove, ...parts }) {
    const said = { label: `${label}: drag it, or use the arrow keys`, className: "diamond" };
    super(lab, [{ name, ...said, onMove, onRest: () => lab.rest() }]);
    this.said = tag;
    /** @type {any} */
    this.parts = { towardsOf: NONE, alikeOf: NONE, focusAt: NONE, ...parts };
  }

  draw(shown, ghost, cursor, theme) {
    const { map, parts } = this;
    const place = parts.placeOf(shown);
    const inside = (pen, frame) => {
      map?.draw(pen, frame, this.square, shown, theme);
      this.trace(pen, frame, shown, ghost, cursor, theme);
    };
    const towards = parts.towardsOf(shown);
    const atInfinity = ({ centre, half }) => towards && centre.map((value, c) => value + 1.5 * half * towards[c]);
    const outside = (_pen, frame) => {
      map?.drawKey(this, frame, theme);
      const { there } = this.handles[0];
      const text = place || !towards ? this.said : `${this.said} at infinity`;
      if (there) this.tag({ id: "handle", text, at: there, gap: BESIDE, colour: theme.warning, rank: 0 });
    };
    const drawing = { inside, outside, room: map?.roomFor(shown) };
    const squareNow = () => squareOf(shown, ghost, place, this.lab.span);
    this.paint(squareNow, theme, drawing, (square) => [place ?? atInfinity(square)]);
  }

  trace(pen, frame, shown, ghost, cursor, theme) {
    if (shown.circle) drawCircle(pen, shown.circle, frame, theme);
    const { parts } = this;
    const { width, truth, time } = shown;
    const [from, to] = time.length ? indicesIn(time, this.lab.span) : [0, -1];
    const inSight = (rows) => rows.subarray(from * width, (to + 1) * width);
    const some = from > 0 || to + 1 < time.length;
    const trace = (rows, colour, dash) => {
      pen.globalAlpha = (some ? OTHER_TIMES : 1) * opacityOf(theme, colour);
      drawPath(pen, rows, { width }, frame, colour, dash);
      pen.globalAlpha = opacityOf(theme, colour);
      if (some && rows.length === width * time.length) drawPath(pen, inSight(rows), { width }, frame, colour, dash);
      pen.globalAlpha = 1;
    };
    ghost?.runs.forEach((run) => trace(run.estimate, theme.kept, KEPT));
    if (truth?.length) trace(truth, theme.ink, SOLID);
    shown.runs.forEach((run) => trace(run.estimate, theme.lines[run.order], DASHES[run.order]));
    if (truth?.length) drawEnds(pen, inSight(truth), width, frame, theme);
    if (truth?.length) this.busyAlong(inSight(truth), width, frame);
    if (cursor === null) return;
    const at = between(time, cursor);
    if (truth?.length) {
      const speed = meanSpeed(time, truth, width, 0, [from, to]);
      const alike = parts.alikeOf(shown, at, this.square);
      if (alike) drawAlike(frame, alike, speed, theme);
      else drawVelocities(frame, parts.arrowsOf(shown, at, theme), speed, theme);
    }
    const focus = parts.focusAt(shown, at);
    if (focus?.circle) drawCircle(pen, focus.circle, frame, theme);
    if (focus) this.nameFocus(frame, focus.foe, theme);
    drawPoints(pen, shown, at, frame, theme);
    this.swing(pen, frame, shown, cursor, theme);
  }

  /** The focus of expansion of a motion that varies, where it is in sight. */
  nameFocus({ x, y, box }, foe, theme) {
    const at = [x(foe[0]), y(foe[1])];
    foeMark(this.context, at[0], at[1], theme);
    if (holds(box, at)) this.tag({ id: "focus", text: "FOE now", at, gap: BESIDE, colour: theme.warning, rank: 0 });
  }

  describe(shown) {
    this.tell([imagePlaneInWords(shown), this.map?.inWords(shown)].filter(Boolean).join(" "));
    this.handles[0].describe(this.parts.towardsOf(shown) ? ", at infinity" : "");
  }
}

/** A square with round numbers that holds the path and the handle, unless that is far away. */
function squareOf(shown, ghost, place, span) {
  const [from, to] = shown.time.length ? indicesIn(shown.time, span) : [0, -1];
  const [rows, width] = shown.truth?.length ? [shown.truth, shown.width] : [shown.outputs, shown.sampled];
  const most = { lowPart: 0.005, highPart: 0.995 };
  const boundOf = (values, columns, first) => spread(values, { ...most, first, width: columns });
  const bounds = [0, 1].map((c) => {
    let found = boundOf(rows.subarray(from * width, (to + 1) * width), width, c) ?? [-1, 1];
    for (const run of ghost?.runs ?? []) {
      const other = boundOf(run.estimate, shown.width, c);
      if (other && other[1] - other[0] < 3 * (found[1] - found[0])) found = hull([found, other]);
    }
    return found;
  });
  const size = Math.max(...bounds.map(([low, high]) => high - low), 0.2);
  const reachable = place?.every((v, c) => v > bounds[c][0] - 1.5 * size && v < bounds[c][1] + 1.5 * size);
  return squareAround(reachable ? bounds.map((b, c) => hull([b, [place[c], place[c]]])) : bounds);
}

/** The region where |w| is below the threshold: dotted outline, light hatching. */
function drawCircle(pen, [y1, y2, radius], { x, y, scale }, theme) {
  const size = Math.abs(radius) * scale;
  if (!(size > 0 && size < 1e4)) return;
  pen.globalAlpha = 0.1;
  pen.fillStyle = theme.warning;
  pen.beginPath();
  pen.arc(x(y1), y(y2), size, 0, 2 * Math.PI);
  pen.fill();
  pen.globalAlpha = 1;
  pen.strokeStyle = theme.warning;
  pen.setLineDash([3, 3]);
  pen.stroke();
}

/** The point and its estimates at a time, between samples too. */
function drawPoints(pen, shown, at, { x, y, box }, theme) {
  /** @type {(rows: Float64Array) => [number, number]} */
  const place = (rows) => [x(valueBetween(rows, shown.width, 0, at)), y(valueBetween(rows, shown.width, 1, at))];
  const corners = [[box.left + 1, box.top + 1], [box.left + box.side - 1, box.top + box.side - 1]];
  const middle = [box.left + box.side / 2, box.top + box.side / 2];
  for (const { estimate, order } of shown.runs) {
    const there = place(estimate);
    const rim = rimOf(middle, there, corners);
    if (rim) rimMark(pen, rim, theme.lines[order]);
    else ghostMark(pen, ...there, theme.lines[order]);
  }
  if (shown.truth) pointMark(pen, ...place(shown.truth), theme.ink, theme);
}
