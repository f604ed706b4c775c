// The scene in metres, seen from anywhere: camera, frustum, ray, the true points, and their estimates as ghosts.

import { between, valueBetween } from "../model/playback.js";
import { linearScale, readable, tickLabel } from "../model/scales.js";
import { ballAround, boxAround, claimedDistances, frameOf, keptBall, OPENING_LOOK } from "../model/space.js";
import { partIn, positionAt, positionsOf, rimOf, turned } from "../model/space.js";
import { indicesIn } from "../model/timeline.js";
import { Picture } from "./canvas.js";
import { drawSwung, Swing } from "./swing.js";
import { element } from "./controls.js";
import { stroke } from "./image_frame.js";
import { fading, KEPT, SOLID } from "./lines.js";
import { ghostMark, label, pointMark, rimMark } from "./marks.js";

const CAPTION = "Scene in metres; y1, y2 as in the image";
const EDGE = 14;
const NEAR = 1;
const KEY_TURN = 0.1;
const PIXEL_TURN = 0.01;
const [CLOSEST, FARTHEST] = [32, 0.25];
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const ZOOMS = { "+": 1.25, "=": 1.25, "-": 0.8 };
const HOW = "Scene in metres: turn it with the arrow keys or by dragging, plus and minus come nearer and go back, Home turns it back";

/** What a lab shows in it: `tracksOf(shown, ghost, theme)` and `wordsOf(shown)`; `image` is the image plane beside it. */
export class Scene extends Picture {
  constructor(lab, { image, tracksOf, wordsOf, unseenOf, copiesOf = /** @type {(...of: any[]) => any[]} */ (() => []) }) {
    super("scene", "Scene, seen from the side");
    this.lab = lab;
    this.image = image;
    this.tracksOf = tracksOf;
    this.wordsOf = wordsOf;
    this.unseenOf = unseenOf;
    this.copiesOf = copiesOf;
    this.swing = new Swing(lab);
    image.scene = this;
    this.look = OPENING_LOOK;
    this.zoom = 1;
    /** @type {ReturnType<typeof ballAround> | null} */
    this.ball = null;
    this.eye = element("div", { class: "eye", tabindex: 0, role: "slider", "aria-label": HOW, title: "Drag to turn; wheel to zoom" });
    this.eye.dataset.control = "scene";
    this.figure.append(this.eye, this.swing.press);
    this.listen();
    this.say();
  }

  listen() {
    const { eye } = this;
    /** @type {{id: number, x: number, y: number, look: typeof OPENING_LOOK} | null} */
    let grip = null;
    eye.addEventListener("pointerdown", (event) => {
      grip = { id: event.pointerId, x: event.clientX, y: event.clientY, look: this.look };
      if (event.isTrusted) eye.setPointerCapture(event.pointerId);
    });
    eye.addEventListener("pointermove", (event) => {
      if (!grip || grip.id !== event.pointerId) return;
      this.see(turned(grip.look, -PIXEL_TURN * (event.clientX - grip.x), PIXEL_TURN * (event.clientY - grip.y)));
    });
    for (const type of ["pointerup", "pointercancel", "lostpointercapture"]) eye.addEventListener(type, () => (grip = null));
    eye.addEventListener("keydown", (event) => {
      const [across, upwards] = KEYS[event.key] ?? [];
      if (across !== undefined) this.see(turned(this.look, KEY_TURN * across, KEY_TURN * upwards));
      else if (ZOOMS[event.key]) this.see(this.look, this.zoom * ZOOMS[event.key]);
      else if (event.key === "Home") this.see(OPENING_LOOK, 1);
      else return;
      event.preventDefault();
    });
    eye.addEventListener("wheel", (event) => {
      // Without the focus the wheel belongs to the page that is read.
      if (document.activeElement !== eye && !event.ctrlKey) return;
      event.preventDefault();
      this.see(this.look, this.zoom * Math.exp(-0.002 * event.deltaY));
    }, { passive: false });
  }

  see(look, zoom = this.zoom) {
    this.look = look;
    this.zoom = Math.min(Math.max(zoom, FARTHEST), CLOSEST);
    this.say();
    this.lab.redraw();
  }

  say() {
    const degrees = (angle) => Math.round((angle * 180) / Math.PI);
    const { turn, tilt } = this.look;
    this.eye.setAttribute("aria-valuenow", String(degrees(turn)));
    this.eye.setAttribute("aria-valuetext", `turned ${degrees(turn)} degrees, tilted ${degrees(tilt)} degrees, ${readable(this.zoom, 2)} times as large`);
  }

  describe(shown) {
    this.tell(this.wordsOf(shown));
  }

  /** The copies that swing along what is not seen, and words of what stands still; null while none does. */
  swung(shown, cursor, theme) {
    const { amount } = this.swing;
    if (amount === null || cursor === null) return null;
    const unseen = this.unseenOf(shown, between(shown.time, cursor), theme);
    return unseen && { copies: unseen.moved(amount), words: unseen.words };
  }

  draw(shown, ghost, cursor, theme) {
    const size = this.fit(theme.font);
    const there = shown.time.length > 0 && !shown.problem;
    this.swing.offer(there && cursor !== null && this.unseenOf(shown, between(shown.time, cursor), theme));
    if (!there) return;
    const scene = this.tracksOf(shown, ghost, theme, cursor);
    const range = indicesIn(shown.time, this.lab.span);
    const inSight = (track) => (track.range ?? range).map((k) => Math.min(k, track.distances.length - 1));
    const paths = scene.tracks.map((track) => ({ track, positions: positionsOf(track, scene.ray, inSight(track)) }));
    const sure = paths.filter(({ track }) => !track.of);
    const wanted = () => ballAround(boxAround((sure.length ? sure : paths).map(({ positions }) => positions)));
    const ball = this.lab.held && this.ball ? this.ball : keptBall(this.ball, wanted());
    this.ball = ball;
    const frame = frameOf(this.look, ball, { ...size, edge: EDGE, zoom: this.zoom });
    const corners = [[8, 8], [size.width - 8, size.height - 8]];
    const pen = this.context;
    const drawing = { pen, frame, theme, corners, scene, ball };
    const far = this.corners(scene, ball);
    this.underlay([this.look, this.zoom, ball, far, theme], (below) => {
      this.axes({ ...drawing, pen: below }, frustum({ ...drawing, pen: below }, far));
      below.textAlign = "left";
      below.textBaseline = "alphabetic";
      label(below, CAPTION, 4, 12, theme.ink, theme);
    });
    if (scene.foe) this.foe(drawing);
    for (const { track, positions } of paths) path(drawing, positions, track);
    if (cursor === null) return;
    const at = between(shown.time, cursor);
    copies(drawing, this.copiesOf(shown, at, this.image.square));
    for (const track of scene.tracks) if (!track.of && !track.kept) this.point(drawing, track, at);
    for (const track of scene.tracks) if (track.of && !track.kept) estimate(drawing, track, at);
    const swung = this.swung(shown, cursor, theme);
    if (swung) drawSwung(pen, swung.copies, ({ place }) => on(frame, place), "", [0, 0], theme);
  }

  /** X, Y and Z from the camera on, as far as the scene goes, with round numbers of metres where nothing else is said. */
  axes({ pen, frame, theme, ball }, taken) {
    const step = linearScale(0, ball.radius / this.zoom, 3).ticks[1];
    ["X", "Y", "Z"].forEach((name, i) => {
      const end = Math.max(ball.centre[i] + 0.75 * ball.radius, 0.3 * ball.radius);
      const place = (value) => [0, 1, 2].map((axis) => (axis === i ? value : 0));
      pen.setLineDash([]);
      pen.strokeStyle = theme.line;
      line(pen, frame, [0, 0, 0], place(end));
      pen.textAlign = "center";
      pen.textBaseline = "middle";
      label(pen, `${name}${i === 2 ? " in m" : ""}`, ...beyond(frame, place(end), 10), theme.ink, theme);
      const [x0, y0] = on(frame, [0, 0, 0]);
      const [x1, y1] = on(frame, place(step));
      if (Math.hypot(x1 - x0, y1 - y0) < 24) return;
      for (let value = step; value < end - 0.2 * step && value < 40 * step; value += step) {
        const [x, y] = on(frame, place(value));
        pen.fillStyle = theme.line;
        pen.fillRect(x - 1.5, y - 1.5, 3, 3);
        const free = taken.every(([left, top]) => Math.hypot(x - left, y + 10 - top) > 24);
        if (i === 2 && free) label(pen, tickLabel(Number(value.toPrecision(6)), false), x, y + 10, theme.muted, theme);
      }
    });
  }

  /** The rays through the corners of the image that is drawn beside the scene, as far as that image is drawn before the camera. */
  corners(scene, ball) {
    const { square } = this.image;
    if (!square) return [];
    const { centre: [c1, c2], half } = square;
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) => Array.from(scene.ray(c1 + a * half, c2 + b * half, new Float64Array(3))));
    const longest = Math.max(...corners.map((corner) => Math.hypot(...corner)));
    return corners.map((corner) => corner.map((value) => (0.5 * ball.radius * value) / longest));
  }

  /** The direction of the focus of expansion, along which the point moves straight towards the camera or away. */
  foe({ pen, frame, theme, scene, ball }) {
    const direction = Array.from(scene.ray(...scene.foe, new Float64Array(3)));
    const length = Math.hypot(...direction);
    if (!(length < Infinity)) return;
    const end = direction.map((value) => (0.6 * ball.radius * value) / length);
    pen.setLineDash([6, 3]);
    pen.strokeStyle = theme.warning;
    line(pen, frame, [0, 0, 0], end);
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    label(pen, "FOE", ...beyond(frame, end, 12), theme.warning, theme);
  }

  /** The true point at a time, on the ray on which the camera sees it. */
  point({ pen, frame, theme, scene, ball }, track, at) {
    const place = positionAt(track, scene.ray, at);
    const length = Math.hypot(...place);
    if (!(length > 0 && length < Infinity)) return;
    pen.globalAlpha = 0.5;
    pen.strokeStyle = track.colour;
    pen.setLineDash([]);
    line(pen, frame, [0, 0, 0], place.map((value) => (value * Math.max(3 * ball.radius, length)) / length));
    pen.globalAlpha = 1;
    // A plumb line to the height of the camera tells where the point is in depth.
    pen.setLineDash([1, 3]);
    pen.strokeStyle = theme.muted;
    line(pen, frame, place, [place[0], 0, place[2]]);
    line(pen, frame, [place[0], 0, place[2]], [0, 0, place[2]]);
    pointMark(pen, ...on(frame, place), track.colour, theme);
  }
}

/** The frustum with the image before the camera; where that image's axes are named. */
function frustum({ pen, frame, theme }, far) {
  if (!far.length) return [];
  pen.setLineDash([]);
  pen.strokeStyle = theme.muted;
  pen.fillStyle = theme.muted;
  for (const corner of far) line(pen, frame, [0, 0, 0], corner);
  pen.beginPath();
  for (const corner of far) pen.lineTo(...on(frame, corner));
  pen.closePath();
  pen.globalAlpha = 0.08;
  pen.fill();
  pen.globalAlpha = 1;
  pen.stroke();
  const [lowLeft, lowRight, , highLeft] = far.map((corner) => on(frame, corner));
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  const middle = [0, 1].map((c) => (lowRight[c] + highLeft[c]) / 2);
  return [lowRight, highLeft].map((corner, i) => {
    const at = [0, 1].map((c) => lowLeft[c] + 0.7 * (corner[c] - lowLeft[c]));
    const out = Math.hypot(at[0] - middle[0], at[1] - middle[1]) || 1;
    const [x, y] = at.map((value, c) => value + (12 * (value - middle[c])) / out);
    label(pen, ["y1 →", "y2 ↑"][i], x, y, theme.muted, theme);
    return [x, y];
  });
}

/** @returns {[number, number]} */
function on(frame, place) {
  return [frame.x(...place), frame.y(...place)];
}

/**
 * A place some pixels further away from the camera than another.
 * @returns {[number, number]}
 */
function beyond(frame, place, pixels) {
  const [x0, y0] = on(frame, [0, 0, 0]);
  const [x, y] = on(frame, place);
  const length = Math.hypot(x - x0, y - y0) || 1;
  return [x + (pixels * (x - x0)) / length, y + (pixels * (y - y0)) / length];
}

/** A line as far as it is on the picture: what is beyond would be cut into dashes too, thousands of them. */
function line(pen, frame, from, to) {
  const part = partIn(on(frame, from), on(frame, to), frame.corners);
  if (part) stroke(pen, part.slice(0, 2), part.slice(2));
}

/** The way of a point, with gaps where it is nowhere. */
function path({ pen, frame, theme }, positions, { colour, dash, of, kept }) {
  pen.beginPath();
  const [[left, top], [right, bottom]] = frame.corners;
  let [x0, y0, inside, endX, endY] = [NaN, NaN, false, NaN, NaN];
  const piece = (fromX, fromY, toX, toY) => {
    if (fromX !== endX || fromY !== endY) pen.moveTo(fromX, fromY);
    pen.lineTo(toX, toY);
    endX = toX;
    endY = toY;
  };
  for (let k = 0; k < positions.length; k += 3) {
    const x = frame.x(positions[k], positions[k + 1], positions[k + 2]);
    const y = frame.y(positions[k], positions[k + 1], positions[k + 2]);
    // Points closer than a pixel do not show.
    if (Math.abs(x - x0) + Math.abs(y - y0) < NEAR && k + 3 < positions.length) continue;
    const before = inside;
    inside = x >= left && x <= right && y >= top && y <= bottom;
    if (inside && before) piece(x0, y0, x, y);
    else if (Number.isFinite(x0 + y0 + x + y)) {
      const part = partIn([x0, y0], [x, y], frame.corners);
      if (part) piece(...part);
    }
    x0 = x;
    y0 = y;
  }
  const own = kept ? theme.kept : colour;
  pen.strokeStyle = own;
  pen.setLineDash(kept ? KEPT : of ? dash : SOLID);
  pen.globalAlpha = (of ? 0.8 : 0.6) * fading(theme, own);
  pen.lineWidth = theme.width;
  pen.stroke();
  pen.lineWidth = 1;
  pen.globalAlpha = 1;
}

/** Other places where a point would look alike, or else: those whose arrows are in the image, in the same words. */
function copies({ pen, frame, theme }, found) {
  for (const { place, text, alike } of found) {
    const [x, y] = on(frame, place);
    const colour = alike ? theme.warning : theme.muted;
    pen.fillStyle = colour;
    pen.beginPath();
    pen.arc(x, y, 3, 0, 2 * Math.PI);
    pen.fill();
    pen.textAlign = "left";
    pen.textBaseline = "top";
    label(pen, text, x + 5, y + 3, colour, theme);
  }
}

/** An estimate as a ghost on its ray, with the distances that it claims, and how far it is from the truth. */
function estimate({ pen, frame, theme, corners, scene, ball }, track, at) {
  const { colour, of } = track;
  if (fading(theme, colour) < 1) return;
  const place = positionAt(track, scene.ray, at);
  const [y1, y2] = [0, 1].map((c) => valueBetween(track.rows, track.width, (track.first ?? 0) + c, at));
  const direction = Array.from(scene.ray(y1, y2, new Float64Array(3)));
  const from = [0, 0, 0];
  const inverse = track.inverse[at.sample];
  if (Number.isNaN(inverse)) return;
  const far = (distance) => direction.map((value) => value * Math.min(distance, 1e3 * ball.radius));
  const claimed = track.deviation && claimedDistances(inverse, track.deviation[at.sample]);
  if (claimed) {
    pen.setLineDash([]);
    pen.strokeStyle = colour;
    pen.globalAlpha = 0.3;
    pen.lineWidth = 7;
    line(pen, frame, far(claimed[0]), far(claimed[1]));
    pen.lineWidth = 1;
    pen.globalAlpha = 1;
  }
  const somewhere = place.every(Number.isFinite);
  const target = somewhere ? place : far(Infinity);
  if (target.some(Number.isNaN)) return;
  const truth = of.rows && positionAt(of, scene.ray, at);
  if (truth?.every(Number.isFinite)) {
    pen.strokeStyle = colour;
    pen.lineWidth = 2;
    pen.setLineDash([2, 3]);
    line(pen, frame, truth, target.map((value) => Math.min(Math.max(value, -1e3 * ball.radius), 1e3 * ball.radius)));
    pen.lineWidth = 1;
  }
  const rim = rimOf(on(frame, from), on(frame, target), corners);
  const text = somewhere ? `${readable(track.distances[at.sample])} m` : inverse < 0 ? "behind the camera" : "∞";
  if (rim) rimMark(pen, rim, text, colour, theme);
  else ghostMark(pen, ...on(frame, place), colour);
}
