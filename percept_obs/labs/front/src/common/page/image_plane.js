// The image plane: the point's path, the estimates, and a handle.

import { spread } from "../model/scales.js";
import { between, valueBetween } from "../model/playback.js";
import { imagePlaneInWords } from "../model/words.js";
import { Picture } from "./canvas.js";
import { rimOf } from "../model/space.js";
import { button } from "./controls.js";
import { indicesIn } from "../model/timeline.js";
import { hull } from "./chart_parts.js";
import { Handle } from "./handle.js";
import { clipTo, drawAxes, drawEnds, drawPath, placed, showsToo, squareAround } from "./image_frame.js";
import { DASHES, fading, KEPT, SOLID } from "./lines.js";
import { meanSpeed } from "../model/velocities.js";
import { drawSwung } from "./swing.js";
import { drawAlike, drawVelocities } from "./velocities.js";
import { foeMark, ghostMark, pointMark, rimMark } from "./marks.js";

/** How much is seen of the path at times that are not in sight. */
const OTHER_TIMES = 0.2;

/** A picture of a square of the image, with handles to drag. */
export class FramedImage extends Picture {
  constructor(lab, handles) {
    super("image-plane", "Image plane");
    this.lab = lab;
    /** @type {ReturnType<typeof squareAround> | null} */
    this.square = null;
    this.handles = handles.map((handle) => new Handle(handle));
    this.choices = 0;
    /** @type {any} the scene beside it */
    this.scene = null;
    const said = { class: "fitting", hidden: true, "data-control": "fit image", title: "Show all of the path" };
    this.fitting = button("Fit", () => {
      this.square = null;
      this.fitting.hidden = true;
      lab.redraw();
    }, said);
    this.figure.append(this.fitting, ...this.handles.map(({ node }) => node));
  }

  /** The square that stays while a hand moves something and after: a choice, or a press on "Fit", takes another one. */
  squareFor(squareOf) {
    const { square, lab } = this;
    if (square && lab.held) return square;
    const wanted = squareOf();
    if (!square) return wanted;
    const there = showsToo(square, wanted);
    const chosen = this.choices !== lab.choices;
    if (chosen) this.choices = lab.choices;
    this.fitting.hidden = there || chosen;
    return there || !chosen ? square : wanted;
  }

  /** Paint inside a square, and put handles in their places. */
  paint(squareOf, theme, { inside, outside = (_pen, _frame) => {}, room = 0 }, placesIn) {
    const square = this.squareFor(squareOf);
    this.square = square;
    const frame = { ...placed(this, square, theme.font, room), lineWidth: theme.width };
    const pen = this.context;
    this.underlay([square, theme, room], (below) => drawAxes(below, frame, square.ticks, theme));
    pen.save();
    clipTo(pen, frame.box);
    inside(pen, frame);
    pen.restore();
    outside(pen, frame);
    const places = placesIn(square);
    this.handles.forEach((handle, k) => handle.stand(places[k], frame, this.lab.late));
  }

  /** The images of the copies that swing along what is not seen. */
  swing(pen, { box, x, y }, shown, cursor, theme) {
    const swung = this.scene?.swung(shown, cursor, theme);
    if (swung) drawSwung(pen, swung.copies, ({ image }) => [x(image[0]), y(image[1])], swung.words, [box.left + 4, box.top + 14], theme);
  }
}

/** The image of one point; `placeOf` says of a result where the handle stands. */
export class ImagePlane extends FramedImage {
  constructor(lab, { name, label, tag, placeOf, towardsOf = (_shown) => null, arrowsOf, alikeOf = /** @type {(...of: any[]) => any} */ (() => null), focusAt = /** @type {(...of: any[]) => any} */ (() => null), onMove }) {
    const said = { label: `${label}: drag it, or use the arrow keys`, className: "diamond" };
    super(lab, [{ name, ...said, onMove, onRest: () => lab.rest() }]);
    this.placeOf = placeOf;
    this.arrowsOf = arrowsOf;
    this.alikeOf = alikeOf;
    this.focusAt = focusAt;
    this.tag = tag;
    this.towardsOf = towardsOf;
    /** @type {any} the film behind the track, if there is one */
    this.frames = null;
    /** @type {any} the map under the track, if there is one */
    this.map = null;
  }

  draw(shown, ghost, cursor, theme) {
    const place = this.placeOf(shown);
    const inside = (pen, frame) => {
      this.frames?.draw(pen, frame, shown.settings, cursor);
      this.map?.draw(pen, frame, this.square, shown, theme);
      this.trace(pen, frame, shown, ghost, cursor, theme);
    };
    const towards = this.towardsOf(shown);
    const placesIn = ({ centre, half }) => [place ?? (towards && centre.map((value, c) => value + 1.5 * half * towards[c]))];
    const outside = (pen, frame) => this.map?.drawKey(pen, frame, theme);
    this.paint(() => squareOf(shown, ghost, place, this.lab.span), theme, { inside, outside, room: this.map?.roomFor(shown) }, placesIn);
    const tag = place || !towards ? this.tag : `${this.tag} at infinity`;
    if (this.handles[0].node.dataset.tag !== tag) this.handles[0].node.dataset.tag = tag;
  }

  trace(pen, frame, shown, ghost, cursor, theme) {
    if (shown.circle) drawCircle(pen, shown.circle, frame, theme);
    const { width } = shown;
    const [from, to] = shown.time.length ? indicesIn(shown.time, this.lab.span) : [0, -1];
    const some = from > 0 || to + 1 < shown.time.length;
    const trace = (rows, colour, dash, all = width * shown.time.length) => {
      pen.globalAlpha = (some ? OTHER_TIMES : 1) * fading(theme, colour);
      drawPath(pen, rows, { width }, frame, colour, dash);
      pen.globalAlpha = fading(theme, colour);
      if (some && rows.length === all) drawPath(pen, rows.subarray(from * width, (to + 1) * width), { width }, frame, colour, dash);
      pen.globalAlpha = 1;
    };
    ghost?.runs.forEach((run) => trace(run.estimate, theme.kept, KEPT));
    if (shown.truth?.length) trace(shown.truth, theme.ink, SOLID);
    shown.runs.forEach((run) => trace(run.estimate, theme.lines[run.order], DASHES[run.order]));
    if (shown.truth?.length) drawEnds(pen, shown.truth.subarray(from * width, (to + 1) * width), width, frame, theme);
    if (cursor === null) return;
    if (shown.truth?.length) {
      const speed = meanSpeed(shown.time, shown.truth, width, 0, [from, to]);
      const at = between(shown.time, cursor);
      const alike = this.alikeOf(shown, at, this.square);
      if (alike) drawAlike(pen, frame, alike, speed, theme);
      else drawVelocities(pen, frame, this.arrowsOf(shown, at, theme), speed, theme);
    }
    const focus = this.focusAt(shown, between(shown.time, cursor));
    if (focus?.circle) drawCircle(pen, focus.circle, frame, theme);
    if (focus) foeMark(pen, frame.x(focus.foe[0]), frame.y(focus.foe[1]), "FOE now", theme);
    drawAt(pen, shown, cursor, frame, theme);
    this.swing(pen, frame, shown, cursor, theme);
  }

  describe(shown) {
    this.tell([imagePlaneInWords(shown), this.map?.inWords(shown)].filter(Boolean).join(" "));
    this.handles[0].describe(this.towardsOf(shown) ? ", at infinity" : "");
  }
}

/** A square with round numbers that holds the path and the handle, unless that is far away. */
function squareOf(shown, ghost, place, span) {
  const [from, to] = shown.time.length ? indicesIn(shown.time, span) : [0, -1];
  const [rows, width] = shown.truth?.length ? [shown.truth, shown.width] : [shown.outputs, shown.sampled];
  const seen = (c) => bound(rows.subarray(from * width, (to + 1) * width), width, c);
  const bounds = [0, 1].map((c) => {
    let found = seen(c) ?? [-1, 1];
    for (const run of ghost?.runs ?? []) {
      const other = bound(run.estimate, shown.width, c);
      if (other && other[1] - other[0] < 3 * (found[1] - found[0])) found = hull([found, other]);
    }
    return found;
  });
  const size = Math.max(...bounds.map(([low, high]) => high - low), 0.2);
  const reachable = place?.every((v, c) => v > bounds[c][0] - 1.5 * size && v < bounds[c][1] + 1.5 * size);
  return squareAround(reachable ? bounds.map((b, c) => hull([b, [place[c], place[c]]])) : bounds);
}

function bound(rows, width, c) {
  return spread(rows, { lowPart: 0.005, highPart: 0.995, first: c, width });
}

/** The region where |w| is below the threshold: dotted outline, light hatching. */
function drawCircle(pen, [y1, y2, radius], { x, y, scale }, theme) {
  const size = Math.abs(radius) * scale;
  if (!(size > 0 && size < 1e4)) return;
  pen.beginPath();
  pen.arc(x(y1), y(y2), size, 0, 2 * Math.PI);
  pen.fillStyle = theme.warning;
  pen.globalAlpha = 0.1;
  pen.fill();
  pen.globalAlpha = 1;
  pen.strokeStyle = theme.warning;
  pen.setLineDash([3, 3]);
  pen.stroke();
}

/** The point and its estimates at a time, between samples too. */
function drawAt(pen, shown, cursor, frame, theme) {
  const { x, y } = frame;
  const at = between(shown.time, cursor);
  /** @type {(rows: Float64Array) => [number, number]} */
  const place = (rows) => [x(valueBetween(rows, shown.width, 0, at)), y(valueBetween(rows, shown.width, 1, at))];
  const { box } = frame;
  const corners = [[box.left + 1, box.top + 1], [box.left + box.side - 1, box.top + box.side - 1]];
  const middle = [box.left + box.side / 2, box.top + box.side / 2];
  for (const { estimate, order } of shown.runs) {
    const there = place(estimate);
    const rim = rimOf(middle, there, corners);
    if (rim) rimMark(pen, rim, "", theme.lines[order], theme);
    else ghostMark(pen, ...there, theme.lines[order]);
  }
  if (shown.truth) pointMark(pen, ...place(shown.truth), theme.ink, theme);
}
