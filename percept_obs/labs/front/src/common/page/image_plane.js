// The image plane: the point's path, the estimates, and a handle.

import { spread } from "../model/scales.js";
import { sampleAt } from "../model/tables.js";
import { Picture } from "./canvas.js";
import { Handle } from "./handle.js";
import { clipTo, dot, drawAxes, drawEnds, drawPath, placed, squareAround, widen } from "./image_frame.js";
import { DASHES, KEPT, SOLID } from "./lines.js";

/** The picture, and the handle that is dragged with mouse, touch or arrow keys. */
export class ImagePlane extends Picture {
  constructor({ name, label, tag, placeOf, inWords, onMove, onRest }) {
    super("image-plane", "Image plane");
    this.placeOf = placeOf;
    this.inWords = inWords;
    /** @type {ReturnType<typeof squareAround> | null} */
    this.square = null;
    const whole = `${label}: drag it, or use the arrow keys`;
    this.handle = new Handle({ name, className: "diamond", label: whole, onMove, onRest });
    this.handle.node.dataset.tag = tag;
    this.figure.append(this.handle.node);
  }

  /** Draw what is shown; while the hand holds the handle the frame stays where it is. */
  draw(shown, ghost, cursor, theme) {
    const place = this.placeOf(shown);
    const square = (this.handle.grip && this.square) || squareOf(shown, ghost, place);
    this.square = square;
    const frame = placed(this, square);
    const pen = this.context;
    this.underlay([square, theme], (below) => drawAxes(below, frame, square.ticks, theme));
    pen.save();
    clipTo(pen, frame.box);
    if (shown.circle) drawCircle(pen, shown.circle, frame, theme);
    const trace = (rows, colour, dash) => drawPath(pen, rows, { width: shown.width }, frame, colour, dash);
    ghost?.runs.forEach((run) => trace(run.estimate, theme.kept, KEPT));
    if (shown.truth?.length) trace(shown.truth, theme.ink, SOLID);
    shown.runs.forEach((run) => trace(run.estimate, theme.lines[run.order], DASHES[run.order]));
    if (shown.truth?.length) drawEnds(pen, shown.truth, shown.width, frame, theme);
    if (cursor !== null) drawAt(pen, shown, cursor, frame, theme);
    pen.restore();
    this.handle.stand(place, frame);
  }

  /** Say what the picture shows, and where the handle is. */
  describe(shown) {
    this.tell(this.inWords(shown));
    this.handle.describe();
  }
}

/** A square with round numbers that holds the path and the handle, unless that is far away. */
function squareOf(shown, ghost, place) {
  const seen = (c) => (shown.truth?.length ? bound(shown.truth, shown.width, c) : bound(shown.outputs, shown.sampled, c));
  const bounds = [0, 1].map((c) => seen(c) ?? [-1, 1]);
  for (const run of ghost?.runs ?? []) {
    bounds.forEach((b, c) => {
      const other = bound(run.estimate, shown.width, c);
      if (other && other[1] - other[0] < 3 * (b[1] - b[0])) widen(b, other);
    });
  }
  const size = Math.max(...bounds.map(([low, high]) => high - low), 0.2);
  const reachable = place?.every((v, c) => v > bounds[c][0] - 1.5 * size && v < bounds[c][1] + 1.5 * size);
  if (reachable) bounds.forEach((b, c) => widen(b, [place[c], place[c]]));
  return squareAround(bounds);
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

function drawAt(pen, shown, cursor, { x, y }, theme) {
  const at = shown.width * sampleAt(shown.time, cursor);
  for (const { estimate, order } of shown.runs) dot(pen, x(estimate[at]), y(estimate[at + 1]), 3.5, theme.lines[order]);
  if (shown.truth) dot(pen, x(shown.truth[at]), y(shown.truth[at + 1]), 3.5, theme.ink);
}
