// The image plane: the point's path, the estimates, and the focus of expansion as a handle.

import { describe, picture, underlay } from "../common/canvas.js";
import { Handle } from "../common/handle.js";
import { clipTo, drawAxes, drawPath, placed, sampleAt, squareAround, widen } from "../common/image_frame.js";
import { DASHES, KEPT, SOLID } from "../common/lines.js";
import { spread } from "../common/scales.js";

/** The picture, and the handle that is dragged with mouse, touch or arrow keys. */
export class ImagePlane {
  constructor(onMove, onRest) {
    Object.assign(this, picture("image-plane", "Image plane"));
    const label = "Focus of expansion: drag it, or use the arrow keys";
    this.handle = new Handle({ name: "foe", className: "foe", label, onMove, onRest });
    this.figure.append(this.handle.node);
  }

  /** Draw what is shown; while the hand holds the focus of expansion the frame stays where it is. */
  draw(shown, ghost, cursor, theme) {
    if (!this.handle.grip || !this.square) this.square = squareOf(shown, ghost);
    const frame = placed(this, this.square);
    const pen = this.context;
    underlay(this, [this.square, theme], (below) => drawAxes(below, frame, this.square.ticks, theme));
    pen.lineWidth = 1;
    pen.save();
    clipTo(pen, frame.box);
    if (shown.circle) drawCircle(pen, shown.circle, frame, theme);
    const trace = (rows, colour, dash) => drawPath(pen, rows, { width: shown.width }, frame, colour, dash);
    ghost?.runs.forEach((run) => trace(run.estimate, theme.kept, KEPT));
    if (shown.truth?.length) trace(shown.truth, theme.ink, SOLID);
    shown.runs.forEach((run) => trace(run.estimate, theme.lines[run.order], DASHES[run.order]));
    drawEnds(pen, shown, frame, theme);
    if (cursor !== null) drawAt(pen, shown, cursor, frame, theme);
    pen.restore();
    this.handle.stand(shown.foe, frame);
  }

  /** Say what the picture shows, and where the handle is. */
  describe(text) {
    describe(this, text);
    this.handle.describe();
  }
}

/** A square with round numbers that holds the path and the focus of expansion, unless that is far away. */
function squareOf(shown, ghost) {
  const source = shown.truth?.length ? [shown.truth, shown.width] : [shown.outputs, 2];
  const bounds = [0, 1].map((c) => bound(source, c) ?? [-1, 1]);
  for (const run of ghost?.runs ?? []) {
    bounds.forEach((b, c) => {
      const other = bound([run.estimate, shown.width], c);
      if (other && other[1] - other[0] < 3 * (b[1] - b[0])) widen(b, other);
    });
  }
  const size = Math.max(...bounds.map(([low, high]) => high - low), 0.2);
  const reachable = shown.foe?.every((v, c) => v > bounds[c][0] - 1.5 * size && v < bounds[c][1] + 1.5 * size);
  if (reachable) bounds.forEach((b, c) => widen(b, [shown.foe[c], shown.foe[c]]));
  return squareAround(bounds);
}

function bound([rows, width], c) {
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

/** The start is an open circle, the end a full square. */
function drawEnds(pen, { truth, width }, { x, y }, theme) {
  if (!truth?.length) return;
  const end = truth.length - width;
  pen.setLineDash([]);
  pen.strokeStyle = pen.fillStyle = theme.ink;
  pen.beginPath();
  pen.arc(x(truth[0]), y(truth[1]), 4, 0, 2 * Math.PI);
  pen.stroke();
  pen.fillRect(x(truth[end]) - 3.5, y(truth[end + 1]) - 3.5, 7, 7);
}

function drawAt(pen, shown, cursor, { x, y }, theme) {
  const k = sampleAt(shown.time, cursor);
  const dot = (rows, colour) => {
    const [a, b] = [x(rows[k * shown.width]), y(rows[k * shown.width + 1])];
    if (Number.isNaN(a) || Number.isNaN(b)) return;
    pen.beginPath();
    pen.arc(a, b, 3.5, 0, 2 * Math.PI);
    pen.fillStyle = colour;
    pen.fill();
  };
  shown.runs.forEach((run) => dot(run.estimate, theme.lines[run.order]));
  if (shown.truth) dot(shown.truth, theme.ink);
}
