// The scene from above, in metres: the camera at the bottom, the object's path, and where the estimates put it.

import { linearScale, spread, tickLabel } from "../../common/model/scales.js";
import { sampleAt } from "../../common/model/tables.js";
import { describe, fit, picture, underlay } from "../../common/page/canvas.js";
import { DASHES, KEPT, SOLID } from "../../common/page/lines.js";
import { rangeOf } from "../model/quantities.js";
import { sceneInWords } from "../model/text.js";

const [LEFT, RIGHT, TOP, BOTTOM] = [40, 14, 22, 34];

/** The picture: X to the right, Z upwards. */
export class Scene {
  constructor() {
    Object.assign(this, picture("scene", "View from above"));
  }

  describe(shown) {
    describe(this, sceneInWords(shown));
  }

  draw(shown, ghost, cursor, theme) {
    const { width, height } = fit(this);
    const { image, scale, time } = shown;
    if (!time.length) return;
    const places = placesOf(image, 3, () => scale);
    const { x, y, frame } = this.placed(places, width, height);
    const pen = this.context;
    underlay(this, [frame, theme, width, height], (below) => drawFrame(below, frame, x, y, width, height, theme));
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, TOP, width - LEFT - RIGHT, height - TOP - BOTTOM);
    pen.clip();
    drawCamera(pen, x(0), y(0), theme);
    const estimated = (result, { estimate }) => {
      const range = rangeOf(result, estimate);
      return placesOf(estimate, result.width, (k) => 1 / (range[k] * estimate[k * result.width + 2]));
    };
    const trace = (values, colour, dash) => drawPath(pen, values, x, y, colour, dash);
    ghost?.runs.forEach((run) => trace(estimated(ghost, run), theme.kept, KEPT));
    trace(places, theme.ink, SOLID);
    shown.runs.forEach((run) => trace(estimated(shown, run), theme.lines[run.order], DASHES[run.order]));
    drawEnds(pen, places, x, y, cursor === null ? null : sampleAt(time, cursor), theme);
    pen.restore();
  }

  /** A frame that holds camera and path in one scale; it widens in steps, so that it stands still while dragging. */
  placed(places, width, height) {
    const across = spread(places, { lowPart: 0, highPart: 1, first: 0, width: 2 }) ?? [-1, 1];
    const ahead = spread(places, { lowPart: 0, highPart: 1, first: 1, width: 2 }) ?? [0, 1];
    const [w, h] = [width - LEFT - RIGHT, height - TOP - BOTTOM];
    const high = linearScale(0, 1.08 * ahead[1], 4).high;
    const reach = linearScale(0, 1.1 * Math.max(across[1], 0.1) - 1.1 * Math.min(across[0], -0.1), 4).high;
    const perMetre = Math.min(w / reach, h / (1.06 * high));
    const middle = (Math.max(across[1], 0.1) + Math.min(across[0], -0.1)) / 2;
    const half = w / perMetre / 2;
    const centre = Math.round(middle / (0.1 * half)) * 0.1 * half;
    const bottom = TOP + h - 0.05 * high * perMetre;
    const x = (metres) => LEFT + w / 2 + (metres - centre) * perMetre;
    const y = (metres) => bottom - metres * perMetre;
    const ticks = [linearScale(centre - half, centre + half, 4).ticks, linearScale(0, h / perMetre, 4).ticks];
    return { x, y, frame: { perMetre, centre, ticks } };
  }
}

/** X and Z in metres of rows of ybar with a scale. */
function placesOf(rows, width, scaleOf) {
  const found = new Float64Array((2 * rows.length) / width);
  for (let k = 0; k < rows.length / width; k++) {
    const depth = 1 / (scaleOf(k) * rows[k * width + 2]);
    found[2 * k] = rows[k * width] * depth;
    found[2 * k + 1] = depth;
  }
  return found;
}

function drawFrame(pen, { ticks }, x, y, width, height, theme) {
  pen.font = theme.font;
  pen.setLineDash([]);
  pen.strokeStyle = theme.grid;
  pen.fillStyle = theme.muted;
  const [right, bottom] = [width - RIGHT, height - BOTTOM];
  const stroke = (x0, y0, x1, y1) => {
    pen.beginPath();
    pen.moveTo(x0, y0);
    pen.lineTo(x1, y1);
    pen.stroke();
  };
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const tick of ticks[0]) {
    const at = Math.round(x(tick)) + 0.5;
    if (at < LEFT || at > right) continue;
    stroke(at, TOP, at, bottom);
    pen.fillText(tickLabel(tick, false), at, bottom + 6);
  }
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const tick of ticks[1]) {
    const at = Math.round(y(tick)) + 0.5;
    if (at < TOP || at > bottom) continue;
    stroke(LEFT, at, right, at);
    pen.fillText(tickLabel(tick, false), LEFT - 6, at);
  }
  pen.strokeStyle = theme.line;
  pen.strokeRect(LEFT + 0.5, TOP + 0.5, right - LEFT, bottom - TOP);
  pen.fillStyle = theme.ink;
  pen.textBaseline = "alphabetic";
  pen.textAlign = "left";
  pen.fillText("From above: Z in m", LEFT - 2, TOP - 8);
  pen.textAlign = "right";
  pen.fillText("X in m", right, bottom + 30);
}

/** The camera: a triangle that opens forwards. */
function drawCamera(pen, x, y, theme) {
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x - 9, y - 16);
  pen.lineTo(x + 9, y - 16);
  pen.closePath();
  pen.setLineDash([]);
  pen.strokeStyle = theme.muted;
  pen.lineWidth = 1.5;
  pen.stroke();
  pen.lineWidth = 1;
}

function drawPath(pen, places, x, y, colour, dash) {
  pen.beginPath();
  let begun = false;
  let [lastX, lastY] = [0, 0];
  for (let k = 0; k < places.length; k += 2) {
    const [left, top] = [x(places[k]), y(places[k + 1])];
    // Far outside is far enough: a canvas rounds what is further.
    if (!(Math.abs(left) < 1e4 && Math.abs(top) < 1e4)) {
      begun = false;
      continue;
    }
    if (begun && Math.abs(left - lastX) + Math.abs(top - lastY) < 1.2) continue;
    if (begun) pen.lineTo(left, top);
    else pen.moveTo(left, top);
    [begun, lastX, lastY] = [true, left, top];
  }
  pen.strokeStyle = colour;
  pen.setLineDash(dash);
  pen.stroke();
}

/** The start is an open circle, the end a full square, and at the cursor a full circle. */
function drawEnds(pen, places, x, y, at, theme) {
  const end = places.length - 2;
  pen.setLineDash([]);
  pen.strokeStyle = pen.fillStyle = theme.ink;
  pen.beginPath();
  pen.arc(x(places[0]), y(places[1]), 4, 0, 2 * Math.PI);
  pen.stroke();
  pen.fillRect(x(places[end]) - 3.5, y(places[end + 1]) - 3.5, 7, 7);
  if (at === null) return;
  pen.beginPath();
  pen.arc(x(places[2 * at]), y(places[2 * at + 1]), 3.5, 0, 2 * Math.PI);
  pen.fill();
}
