// The scene from above, in metres: the camera at the bottom, the object's path, and where the estimates put it.

import { linearScale, spread } from "../../common/model/scales.js";
import { sampleAt } from "../../common/model/tables.js";
import { Picture } from "../../common/page/canvas.js";
import { clipTo, dot, drawAxes, drawEnds, drawPath, frameOf } from "../../common/page/image_frame.js";
import { DASHES, KEPT, SOLID } from "../../common/page/lines.js";
import { rangeOf } from "../model/quantities.js";
import { sceneInWords } from "../model/text.js";

const [LEFT, RIGHT, TOP, BOTTOM] = [40, 14, 22, 34];

/** The picture: X to the right, Z upwards. */
export class Scene extends Picture {
  constructor() {
    super("scene", "View from above");
  }

  describe(shown) {
    this.tell(sceneInWords(shown));
  }

  draw(shown, ghost, cursor, theme) {
    const { width, height } = this.fit();
    const { image, scale, time } = shown;
    if (!time.length) return;
    const places = placesOf(image, 3, () => scale);
    const { frame, ticks } = placed(places, width, height);
    const { x, y } = frame;
    const pen = this.context;
    const names = ["X in m", "From above: Z in m"];
    this.underlay([frame, ticks, theme], (below) => drawAxes(below, frame, ticks, theme, names));
    pen.save();
    clipTo(pen, frame.box);
    drawCamera(pen, x(0), y(0), theme);
    const trace = (result, { estimate }, colour, dash) => {
      const range = rangeOf(result, estimate);
      const values = placesOf(estimate, result.width, (k) => 1 / (range[k] * estimate[k * result.width + 2]));
      drawPath(pen, values, { width: 2 }, frame, colour, dash);
    };
    ghost?.runs.forEach((run) => trace(ghost, run, theme.kept, KEPT));
    drawPath(pen, places, { width: 2 }, frame, theme.ink, SOLID);
    shown.runs.forEach((run) => trace(shown, run, theme.lines[run.order], DASHES[run.order]));
    drawEnds(pen, places, 2, frame, theme);
    const at = cursor === null ? -1 : 2 * sampleAt(time, cursor);
    if (at >= 0) dot(pen, x(places[at]), y(places[at + 1]), 3.5, theme.ink);
    pen.restore();
  }
}

/** A frame that holds camera and path in one scale; it widens in steps, so that it stands still while dragging. */
function placed(places, width, height) {
  const across = spread(places, { lowPart: 0, highPart: 1, first: 0, width: 2 }) ?? [-1, 1];
  const ahead = spread(places, { lowPart: 0, highPart: 1, first: 1, width: 2 }) ?? [0, 1];
  const box = { left: LEFT, top: TOP, width: width - LEFT - RIGHT, height: height - TOP - BOTTOM };
  const [least, most] = [Math.min(across[0], -0.1), Math.max(across[1], 0.1)];
  const high = linearScale(0, 1.08 * ahead[1], 4).high;
  const reach = linearScale(0, 1.1 * (most - least), 4).high;
  const perMetre = Math.min(box.width / reach, box.height / (1.06 * high));
  const half = box.width / perMetre / 2;
  const centre = Math.round((most + least) / 2 / (0.1 * half)) * 0.1 * half;
  const bottom = TOP + box.height - 0.05 * high * perMetre;
  const ticks = [linearScale(centre - half, centre + half, 4).ticks, linearScale(0, box.height / perMetre, 4).ticks];
  return { frame: frameOf(box, perMetre, [centre, 0], [LEFT + box.width / 2, bottom], 1e4), ticks };
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
