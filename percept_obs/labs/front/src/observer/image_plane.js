// The image plane: the point's path, the estimates, and the focus of expansion as a handle.

import { describe, fit, picture, underlay } from "../common/canvas.js";
import { DASHES, KEPT, SOLID } from "../common/lines.js";
import { linearScale, readable, spread, tickLabel } from "../common/scales.js";

const EDGE = 34;
const NUDGE = 0.01;
const LEAP = 10;

/** The picture, and the handle that is dragged with mouse, touch or arrow keys. */
export class ImagePlane {
  constructor(onMove, onRest) {
    Object.assign(this, picture("image-plane", "Image plane"));
    this.onMove = onMove;
    this.onRest = onRest;
    this.foe = null;
    this.grip = null;
    this.handle = document.createElement("div");
    this.handle.className = "foe";
    this.handle.tabIndex = 0;
    this.handle.setAttribute("role", "slider");
    this.handle.setAttribute("aria-label", "Focus of expansion: drag it, or use the arrow keys");
    this.handle.dataset.control = "foe";
    this.figure.append(this.handle);
    this.listen();
  }

  listen() {
    const { handle } = this;
    handle.addEventListener("pointerdown", (event) => {
      if (!this.foe || event.button > 0) return;
      event.preventDefault();
      handle.focus({ preventScroll: true });
      try {
        handle.setPointerCapture(event.pointerId);
      } catch {
        // A pointer that a script made cannot be captured; its moves arrive all the same.
      }
      this.grip = { id: event.pointerId, x: event.clientX, y: event.clientY, from: [...this.foe] };
    });
    const follow = (event) => {
      if (!this.grip || event.pointerId !== this.grip.id) return;
      const perUnit = this.scale;
      const [y1, y2] = this.grip.from;
      this.onMove([y1 + (event.clientX - this.grip.x) / perUnit, y2 - (event.clientY - this.grip.y) / perUnit]);
    };
    const release = (event) => {
      if (!this.grip || event.pointerId !== this.grip.id) return;
      // A quick drag loses its last move in half of the cases, so the place is read once more.
      if (event.type === "pointerup") follow(event);
      this.grip = null;
      this.onRest();
    };
    handle.addEventListener("pointermove", follow);
    for (const type of ["pointerup", "pointercancel", "lostpointercapture"]) handle.addEventListener(type, release);
    handle.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!step || !this.foe) return;
      event.preventDefault();
      const size = NUDGE * (event.shiftKey ? LEAP : 1);
      this.onMove([this.foe[0] + step[0] * size, this.foe[1] + step[1] * size]);
    });
  }

  /** Draw what is shown; while the hand holds the focus of expansion the frame stays where it is. */
  draw(shown, ghost, cursor, theme) {
    const { width, height } = fit(this);
    this.foe = shown.foe;
    if (!this.grip || !this.frame) this.frame = frameOf(shown, ghost);
    const side = Math.min(width, height) - 2 * EDGE;
    const { centre, half, ticks } = this.frame;
    this.scale = side / (2 * half);
    const far = 4 * Math.max(width, height);
    const x = (y1) => width / 2 + clamp((y1 - centre[0]) * this.scale, far);
    const y = (y2) => height / 2 - clamp((y2 - centre[1]) * this.scale, far);
    const frame = { scale: this.scale, centre, left: width / 2, top: height / 2, far };
    const box = { left: width / 2 - side / 2, top: height / 2 - side / 2, side };
    const pen = this.context;
    underlay(this, [this.frame, theme], (below) => drawAxes(below, box, ticks, x, y, theme));
    pen.lineWidth = 1;
    pen.save();
    pen.beginPath();
    pen.rect(box.left, box.top, box.side, box.side);
    pen.clip();
    if (shown.circle) drawCircle(pen, shown.circle, x, y, this.scale, theme);
    const trace = (rows, colour, dash) => drawPath(pen, rows, shown.width, frame, colour, dash);
    ghost?.runs.forEach((run) => trace(run.estimate, theme.kept, KEPT));
    if (shown.truth?.length) trace(shown.truth, theme.ink, SOLID);
    shown.runs.forEach((run) => trace(run.estimate, theme.lines[run.order], DASHES[run.order]));
    drawEnds(pen, shown, x, y, theme);
    if (cursor !== null) drawAt(pen, shown, cursor, x, y, theme);
    pen.restore();
    this.placeHandle(box, x, y);
  }

  placeHandle(box, x, y) {
    const { handle, foe } = this;
    handle.hidden = !foe;
    if (!foe) return;
    const inside = (value, low) => Math.min(Math.max(value, low), low + box.side);
    const [left, top] = [inside(x(foe[0]), box.left), inside(y(foe[1]), box.top)];
    const outside = Math.abs(left - x(foe[0])) + Math.abs(top - y(foe[1])) > 1;
    if (outside !== handle.classList.contains("outside")) handle.classList.toggle("outside");
    handle.style.transform = `translate(${left}px, ${top}px)`;
  }

  /** Say what the picture shows, and where the handle is. */
  describe(text) {
    describe(this, text);
    if (!this.foe) return;
    this.handle.setAttribute("aria-valuenow", this.foe[0].toFixed(3));
    this.handle.setAttribute("aria-valuetext", `y1 ${readable(this.foe[0])}, y2 ${readable(this.foe[1])}`);
  }
}

function clamp(value, bound) {
  return Math.min(Math.max(value, -bound), bound);
}

/** A square with round numbers that holds the path and the focus of expansion, unless that is far away. */
function frameOf(shown, ghost) {
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
  const half = 0.58 * Math.max(...bounds.map(([low, high]) => high - low), 0.2);
  const centre = bounds.map(([low, high]) => (low + high) / 2);
  const ticks = centre.map((c) => linearScale(c - half, c + half, 4).ticks.filter((t) => Math.abs(t - c) <= half));
  return { centre, half, ticks };
}

function bound([rows, width], c) {
  return spread(rows, { lowPart: 0.005, highPart: 0.995, first: c, width });
}

function widen(range, other) {
  range[0] = Math.min(range[0], other[0]);
  range[1] = Math.max(range[1], other[1]);
}

function drawAxes(pen, { left, top, side }, ticks, x, y, theme) {
  pen.font = theme.font;
  pen.setLineDash([]);
  pen.strokeStyle = theme.grid;
  pen.fillStyle = theme.muted;
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const tick of ticks[0]) {
    const at = Math.round(x(tick)) + 0.5;
    stroke(pen, [at, top], [at, top + side]);
    pen.fillText(tickLabel(tick, false), at, top + side + 6);
  }
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const tick of ticks[1]) {
    const at = Math.round(y(tick)) + 0.5;
    stroke(pen, [left, at], [left + side, at]);
    pen.fillText(tickLabel(tick, false), left - 6, at);
  }
  pen.strokeStyle = theme.line;
  pen.strokeRect(left + 0.5, top + 0.5, side, side);
  pen.fillStyle = theme.ink;
  pen.textBaseline = "alphabetic";
  pen.textAlign = "left";
  pen.fillText("y2", left - 2, top - 8);
  pen.textAlign = "right";
  pen.fillText("y1", left + side, top + side + 30);
}

function stroke(pen, from, to) {
  pen.beginPath();
  pen.moveTo(...from);
  pen.lineTo(...to);
  pen.stroke();
}

function drawPath(pen, rows, width, { scale, centre, left, top, far }, colour, dash) {
  const [middle1, middle2] = centre;
  // Points closer than a pixel do not show.
  const near = 1.2 / scale;
  pen.beginPath();
  let begun = false;
  let before1 = 0;
  let before2 = 0;
  for (let k = 0; k < rows.length; k += width) {
    const y1 = rows[k];
    const y2 = rows[k + 1];
    if (begun && Math.abs(y1 - before1) + Math.abs(y2 - before2) <= near) continue;
    const x = left + clamp((y1 - middle1) * scale, far);
    const y = top - clamp((y2 - middle2) * scale, far);
    if (Number.isNaN(x + y)) {
      begun = false;
      continue;
    }
    if (begun) pen.lineTo(x, y);
    else pen.moveTo(x, y);
    begun = true;
    before1 = y1;
    before2 = y2;
  }
  pen.strokeStyle = colour;
  pen.setLineDash(dash);
  pen.stroke();
}

/** The region where |w| is below the threshold: dotted outline, light hatching. */
function drawCircle(pen, [y1, y2, radius], x, y, scale, theme) {
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
function drawEnds(pen, { truth, width }, x, y, theme) {
  if (!truth?.length) return;
  const end = truth.length - width;
  pen.setLineDash([]);
  pen.strokeStyle = pen.fillStyle = theme.ink;
  pen.beginPath();
  pen.arc(x(truth[0]), y(truth[1]), 4, 0, 2 * Math.PI);
  pen.stroke();
  pen.fillRect(x(truth[end]) - 3.5, y(truth[end + 1]) - 3.5, 7, 7);
}

function drawAt(pen, shown, cursor, x, y, theme) {
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

/** The last sample that is not after a time. */
export function sampleAt(time, when) {
  let [low, high] = [0, time.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (time[middle] <= when + 1e-9) low = middle;
    else high = middle - 1;
  }
  return low;
}
