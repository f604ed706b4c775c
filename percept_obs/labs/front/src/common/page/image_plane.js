// The image plane: the point's path, the estimates, and a handle.

import { spread } from "../model/scales.js";
import { between, valueBetween } from "../model/playback.js";
import { imagePlaneInWords } from "../model/words.js";
import { Picture } from "./canvas.js";
import { hull } from "./chart_parts.js";
import { Handle } from "./handle.js";
import { clipTo, drawAxes, drawEnds, drawPath, placed, squareAround } from "./image_frame.js";
import { DASHES, KEPT, SOLID } from "./lines.js";
import { ghostMark, pointMark } from "./marks.js";

/** A picture of a square of the image, with handles to drag. */
export class FramedImage extends Picture {
  constructor(handles) {
    super("image-plane", "Image plane");
    /** @type {ReturnType<typeof squareAround> | null} */
    this.square = null;
    this.handles = handles.map((handle) => new Handle(handle));
    this.figure.append(...this.handles.map(({ node }) => node));
  }

  /** Paint inside a square, and put handles in their places; while the hand holds one, the square stays as it is. */
  paint(squareOf, theme, inside, places) {
    const square = (this.handles.some(({ grip }) => grip) && this.square) || squareOf();
    this.square = square;
    const frame = placed(this, square);
    const pen = this.context;
    this.underlay([square, theme], (below) => drawAxes(below, frame, square.ticks, theme));
    pen.save();
    clipTo(pen, frame.box);
    inside(pen, frame);
    pen.restore();
    this.handles.forEach((handle, k) => handle.stand(places[k], frame));
  }
}

/** The image of one point; `placeOf` says of a result where the handle stands. */
export class ImagePlane extends FramedImage {
  constructor(lab, { name, label, tag, placeOf, onMove }) {
    const said = { label: `${label}: drag it, or use the arrow keys`, className: "diamond" };
    super([{ name, ...said, onMove, onRest: () => lab.rest() }]);
    this.placeOf = placeOf;
    this.handles[0].node.dataset.tag = tag;
  }

  draw(shown, ghost, cursor, theme) {
    const place = this.placeOf(shown);
    const inside = (pen, frame) => this.trace(pen, frame, shown, ghost, cursor, theme);
    this.paint(() => squareOf(shown, ghost, place), theme, inside, [place]);
  }

  trace(pen, frame, shown, ghost, cursor, theme) {
    if (shown.circle) drawCircle(pen, shown.circle, frame, theme);
    const trace = (rows, colour, dash) => drawPath(pen, rows, { width: shown.width }, frame, colour, dash);
    ghost?.runs.forEach((run) => trace(run.estimate, theme.kept, KEPT));
    if (shown.truth?.length) trace(shown.truth, theme.ink, SOLID);
    shown.runs.forEach((run) => trace(run.estimate, theme.lines[run.order], DASHES[run.order]));
    if (shown.truth?.length) drawEnds(pen, shown.truth, shown.width, frame, theme);
    if (cursor !== null) drawAt(pen, shown, cursor, frame, theme);
  }

  describe(shown) {
    this.tell(imagePlaneInWords(shown));
    this.handles[0].describe();
  }
}

/** A square with round numbers that holds the path and the handle, unless that is far away. */
function squareOf(shown, ghost, place) {
  const seen = (c) => (shown.truth?.length ? bound(shown.truth, shown.width, c) : bound(shown.outputs, shown.sampled, c));
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
function drawAt(pen, shown, cursor, { x, y }, theme) {
  const at = between(shown.time, cursor);
  const place = (rows) => [x(valueBetween(rows, shown.width, 0, at)), y(valueBetween(rows, shown.width, 1, at))];
  if (shown.truth) pointMark(pen, ...place(shown.truth), theme.ink, theme);
  for (const { estimate, order } of shown.runs) ghostMark(pen, ...place(estimate), theme.lines[order]);
}
