// The image plane of many points: their paths, those of their estimates, and each point at time 0 as a handle.

import { readable, spread } from "../../draw/scales.js";
import { between, valueBetween } from "../../engine/between.js";
import { meanSpeed } from "../../engine/velocities.js";
import { sampleAt } from "../../engine/tables.js";
import { hull } from "../../draw/lines.js";
import { drawPath, squareAround } from "../../old/image_frame.js";
import { FramedImage } from "../../old/image_plane.js";
import { DASHES, KEPT, SOLID } from "../../draw/looks.js";
import { ghostMark, pointMark } from "../../draw/marks.js";
import { drawVelocities } from "../../old/velocities.js";
import { imagePlaneInWords } from "./text.js";

const NEARER = ["-", "PageDown"];
const FARTHER = ["+", "=", "PageUp"];
const DEPTH_STEP = 0.05;
const HOW = "at time 0: drag it, or use the arrow keys; plus and minus change its depth, Delete removes it";
const TRAIL = 5;
const FAINT = 0.35;
const HIDDEN = [1, 4];

export class ImagePlane extends FramedImage {
  constructor(lab, most, arrowsOf) {
    super(lab, Array.from({ length: most }, (_, k) => handleOf(lab, k)));
    this.parts = { arrowsOf };
  }

  draw(shown, ghost, cursor, theme) {
    const inside = (pen, frame) => this.trace(pen, frame, shown, ghost, cursor, theme);
    this.paint(() => squareOf(shown), theme, { inside }, () => this.handles.map((_, k) => startOf(shown, k)));
  }

  trace(pen, frame, shown, ghost, cursor, theme) {
    const [first, last] = trail(shown.time, cursor);
    for (let k = 0; k < shown.points; k++) {
      pen.globalAlpha = FAINT;
      if (shown.absences[k].length) drawPath(pen, shown.images, pathOf(shown, k), frame, theme.muted, HIDDEN);
      drawPath(pen, shown.seenImages, pathOf(shown, k), frame, theme.lines[k], SOLID);
      pen.globalAlpha = 1;
    }
    const recent = (run, rows) => rows.subarray(2 * run.points * first, 2 * run.points * (last + 1));
    for (let k = 0; ghost && k < ghost.points; k++) {
      drawPath(pen, recent(ghost, ghost.estimated.images), pathOf(ghost, k), frame, theme.kept, KEPT);
    }
    for (let k = 0; k < shown.points; k++) {
      drawPath(pen, recent(shown, shown.seenImages), pathOf(shown, k), frame, theme.lines[k], SOLID);
      this.busyAlong(recent(shown, shown.seenImages).subarray(2 * k), 2 * shown.points, frame);
      drawPath(pen, recent(shown, shown.estimated.images), pathOf(shown, k), frame, theme.lines[k], DASHES[k]);
    }
    if (cursor !== null) {
      const { time, images, points } = shown;
      const speed = meanSpeed(time, images, 2 * points, 0, [0, time.length - 1]);
      drawVelocities(frame, this.parts.arrowsOf(shown, between(time, cursor), theme), speed, theme);
    }
    drawAt(pen, shown, between(shown.time, cursor ?? shown.time[last]), frame, theme);
    this.swing(pen, frame, shown, cursor, theme);
  }

  describe(shown) {
    this.tell(imagePlaneInWords(shown));
    this.handles.forEach((handle, k) => {
      if (k < shown.points) handle.describe(`, depth ${readable(shown.depths[k])} m`);
    });
  }
}

function handleOf(lab, k) {
  return {
    name: `point ${k + 1}`,
    className: `numbered point-${k}`,
    text: String(k + 1),
    label: `Point ${k + 1} ${HOW}`,
    onMove: (place) => lab.movePoint(k, place),
    onRest: () => lab.rest(),
    onKey: ({ key }) => {
      // A point that was removed has its handle until the next picture.
      if (k >= lab.settings.points.length) return false;
      const step = FARTHER.includes(key) ? DEPTH_STEP : NEARER.includes(key) ? -DEPTH_STEP : 0;
      if (key === "Delete") lab.removePoint(k);
      else if (step) lab.moveDepth(k, Number((lab.depthOf(k) + step).toFixed(6)));
      return step !== 0 || key === "Delete";
    },
  };
}

function startOf({ points, images }, k) {
  const at = [images[2 * k], images[2 * k + 1]];
  return k < points && at.every(Number.isFinite) ? at : null;
}

function pathOf({ points }, k) {
  return { width: 2 * points, first: 2 * k };
}

/** The samples that are drawn in full: the seconds before the cursor, and the first ones without it. */
export function trail(time, cursor) {
  const last = sampleAt(time, cursor ?? TRAIL);
  return [sampleAt(time, Math.max(0, time[last] - TRAIL)), last];
}

function squareOf({ points, images }) {
  const bounds = [0, 1].map((c) => {
    const boundsOf = (_, k) => spread(images, { lowPart: 0, highPart: 1, first: 2 * k + c, width: 2 * points });
    const found = Array.from({ length: points }, boundsOf).filter((range) => range !== null);
    const [low, high] = found.length ? hull(found) : [-1, 1];
    return [Math.max(low, -3), Math.min(high, 3)];
  });
  return squareAround(bounds);
}

/** Where points are at a time, full, and where they are estimated to be, open. */
function drawAt(pen, { points, images, estimated }, at, { x, y }, theme) {
  for (let p = 0; p < points; p++) {
    /** @type {(rows: Float64Array) => [number, number]} */
    const place = (rows) => {
      const [y1, y2] = [0, 1].map((c) => valueBetween(rows, 2 * points, 2 * p + c, at));
      return [x(y1), y(y2)];
    };
    pointMark(pen, ...place(images), theme.lines[p], theme);
    ghostMark(pen, ...place(estimated.images), theme.lines[p]);
  }
}
