// The scene in metres, seen from anywhere: camera, frustum, ray, the true points, and their estimates as ghosts.

import { between, valueBetween, within } from "../engine/between.js";
import { linearScale, readable, tickLabel } from "../draw/scales.js";
import { ballAround, boxAround, claimedDistances, frameOf, keptBall, OPENING_LOOK } from "./space.js";
import { partIn, positionAt, positionsOf, rimOf, turned } from "./space.js";
import { indicesIn } from "./timeline.js";
import { element, listen } from "../ui/dom.js";
import { STEPS } from "../draw/handle.js";
import { opacityOf } from "./line_styles.js";
import { LabelledPicture } from "../draw/labels.js";
import { KEPT, SOLID } from "../draw/looks.js";
import { disc, ghostMark, pointMark, rimMark, stroke } from "../draw/marks.js";
import { drawSwung, Swing } from "./swing.js";

const CAPTION = "Scene in metres; y1, y2 as in the image";
/** The button of what is not seen, from the right and lower rim on. */
const BUTTON = [176, 36];
const EDGE = 14;
const NEAR = 1;
const KEY_TURN = 0.1;
const PIXEL_TURN = 0.01;
const [CLOSEST, FARTHEST] = [32, 0.25];
const ZOOMS = { "+": 1.25, "=": 1.25, "-": 0.8 };
const HOW =
  "Scene in metres: turn it with the arrow keys or by dragging, plus and minus come nearer and go back, " +
  "Home turns it back";
const CAMERA = [0, 0, 0];

/**
 * The scene, of which a lab gives `tracksOf`, `wordsOf`, `unseenOf` and perhaps `copiesOf`; `image` is the image plane
 * beside it.
 */
export class Scene extends LabelledPicture {
  constructor(lab, { image, ...parts }) {
    super("scene", "Scene, seen from the side");
    this.lab = lab;
    this.image = image;
    /** @type {any} */
    this.parts = { copiesOf: () => [], ...parts };
    this.swing = new Swing(lab);
    image.scene = this;
    this.look = OPENING_LOOK;
    this.zoom = 1;
    /** @type {ReturnType<typeof ballAround> | null} */
    this.ball = null;
    this.eye = element("div", {
      ...{ class: "eye", "data-control": "scene", tabindex: 0, role: "slider", "aria-label": HOW },
      title: "Drag to turn; wheel to zoom",
    });
    this.figure.append(this.eye, this.swing.press);
    this.listen();
    this.say();
  }

  listen() {
    const { eye } = this;
    /** @type {{id: number, x: number, y: number, look: typeof OPENING_LOOK} | null} */
    let grip = null;
    listen(eye, {
      pointerdown: (event) => {
        grip = { id: event.pointerId, x: event.clientX, y: event.clientY, look: this.look };
        if (event.isTrusted) eye.setPointerCapture(event.pointerId);
      },
      pointermove: (event) => {
        if (!grip || grip.id !== event.pointerId) return;
        this.see(turned(grip.look, -PIXEL_TURN * (event.clientX - grip.x), PIXEL_TURN * (event.clientY - grip.y)));
      },
      "pointerup pointercancel lostpointercapture": () => (grip = null),
      keydown: (event) => {
        const step = STEPS[event.key];
        if (step) this.see(turned(this.look, KEY_TURN * step[0], KEY_TURN * step[1]));
        else if (ZOOMS[event.key]) this.see(this.look, this.zoom * ZOOMS[event.key]);
        else if (event.key === "Home") this.see(OPENING_LOOK, 1);
        else return;
        event.preventDefault();
      },
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
    this.zoom = within(zoom, FARTHEST, CLOSEST);
    this.say();
    this.lab.redraw();
  }

  say() {
    const [turn, tilt] = [this.look.turn, this.look.tilt].map((angle) => Math.round((angle * 180) / Math.PI));
    const words = `turned ${turn} degrees, tilted ${tilt} degrees, ${readable(this.zoom, 2)} times as large`;
    this.eye.setAttribute("aria-valuenow", String(turn));
    this.eye.setAttribute("aria-valuetext", words);
  }

  describe(shown) {
    this.tell(this.parts.wordsOf(shown));
  }

  /** The copies that swing along what is not seen, and words of what stands still; null while none does. */
  swung(shown, cursor, theme) {
    const { amount } = this.swing;
    if (amount === null || cursor === null) return null;
    const unseen = this.parts.unseenOf(shown, between(shown.time, cursor), theme);
    return unseen && { copies: unseen.moved(amount), words: unseen.words };
  }

  draw(shown, ghost, cursor, theme) {
    const { image, lab, look, parts, zoom } = this;
    this.begin(theme);
    const there = shown.time.length > 0 && !shown.problem;
    this.swing.show(there && cursor !== null && parts.unseenOf(shown, between(shown.time, cursor), theme));
    if (!there) return;
    const scene = parts.tracksOf(shown, ghost, theme, cursor);
    const range = indicesIn(shown.time, lab.span);
    const inSight = (track) => (track.range ?? range).map((k) => Math.min(k, track.distances.length - 1));
    const paths = scene.tracks.map((track) => ({ track, positions: positionsOf(track, scene.ray, inSight(track)) }));
    const sure = paths.filter(({ track }) => !track.of);
    const wanted = () => ballAround(boxAround((sure.length ? sure : paths).map(({ positions }) => positions)));
    const ball = (this.ball = lab.held && this.ball ? this.ball : keptBall(this.ball, wanted()));
    const frame = frameOf(look, ball, { width: this.width, height: this.height, edge: EDGE, zoom });
    const drawing = { picture: this, pen: this.context, frame, theme, scene, ball };
    const corners = imageCorners(image.square, scene, ball);
    const pressed = !this.swing.press.hidden;
    this.underlay([look, zoom, ball, corners, theme, pressed], (pen) => {
      const { height, width, swing: { press } } = this;
      const corner = [width - BUTTON[0], height - BUTTON[1], width, height];
      if (pressed) this.report(press.textContent ?? "", corner);
      this.write(this.shortened(CAPTION, width - 10), 5, 9, theme.ink, "left");
      frustum({ ...drawing, pen }, corners);
      this.axes({ ...drawing, pen });
    });
    if (scene.foe) foe(drawing);
    for (const { track, positions } of paths) path(drawing, positions, track);
    if (cursor === null) return;
    const at = between(shown.time, cursor);
    copies(drawing, parts.copiesOf(shown, at, image.square));
    for (const track of scene.tracks) if (!track.of && !track.kept) point(drawing, track, at);
    for (const track of scene.tracks) if (track.of && !track.kept) estimate(drawing, track, at);
    const swung = this.swung(shown, cursor, theme);
    if (swung) drawSwung(this.context, swung, ({ place }) => on(frame, place), theme);
    this.end();
  }

  /** X, Y and Z from the camera on, as far as the scene goes, with round numbers of metres where there is room. */
  axes({ pen, frame, theme, ball }) {
    const step = linearScale(0, ball.radius / this.zoom, 3).ticks[1];
    const numbers = /** @type {[string, number, number][]} */ ([]);
    ["X", "Y", "Z"].forEach((name, i) => {
      const end = Math.max(ball.centre[i] + 0.75 * ball.radius, 0.3 * ball.radius);
      const place = (value) => [0, 1, 2].map((axis) => (axis === i ? value : 0));
      pen.setLineDash([]);
      pen.strokeStyle = theme.line;
      line(pen, frame, CAMERA, place(end));
      const text = `${name}${i === 2 ? " in m" : ""}`;
      this.tag({ ...outwards(frame, place(end)), id: name, text, colour: theme.ink, rank: 0 });
      if (distance(on(frame, CAMERA), on(frame, place(step))) < 24) return;
      for (let value = step; value < end - 0.2 * step && value < 40 * step; value += step) {
        const [left, top] = on(frame, place(value));
        pen.fillStyle = theme.line;
        pen.fillRect(left - 1.5, top - 1.5, 3, 3);
        if (i === 2) numbers.push([tickLabel(Number(value.toPrecision(6)), false), left, top + 11]);
      }
    });
    this.end();
    for (const [text, left, top] of numbers) this.write(text, left, top, theme.muted);
  }
}

/** @param {number[]} from @param {number[]} to */
function distance([x0, y0], [x1, y1]) {
  return Math.hypot(x1 - x0, y1 - y0);
}

/** The rays through the corners of the image that is drawn beside the scene, to where that image is drawn. */
function imageCorners(square, scene, ball) {
  if (!square) return [];
  const { centre: [c1, c2], half } = square;
  const rayOf = (/** @type {number[]} */ [a, b]) =>
    Array.from(scene.ray(c1 + a * half, c2 + b * half, new Float64Array(3)));
  const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(rayOf);
  const longest = Math.max(...corners.map((corner) => Math.hypot(...corner)));
  return corners.map((corner) => corner.map((value) => (0.5 * ball.radius * value) / longest));
}

/** The direction of the focus of expansion, along which the point moves straight towards the camera or away. */
function foe({ picture, pen, frame, theme, scene, ball }) {
  const direction = Array.from(scene.ray(...scene.foe, new Float64Array(3)));
  const length = Math.hypot(...direction);
  if (!(length < Infinity)) return;
  const end = direction.map((value) => (0.6 * ball.radius * value) / length);
  pen.setLineDash([6, 3]);
  pen.strokeStyle = theme.warning;
  line(pen, frame, CAMERA, end);
  picture.tag({ ...outwards(frame, end), id: "foe", text: "FOE", colour: theme.warning, rank: 1 });
}

/** The true point at a time, on the ray on which the camera sees it. */
function point({ picture, pen, frame, theme, scene, ball }, track, at) {
  const place = positionAt(track, scene.ray, at);
  const length = Math.hypot(...place);
  if (!(length > 0 && length < Infinity)) return;
  pen.globalAlpha = 0.5;
  pen.strokeStyle = track.colour;
  pen.setLineDash([]);
  line(pen, frame, CAMERA, place.map((value) => (value * Math.max(3 * ball.radius, length)) / length));
  pen.globalAlpha = 1;
  // A plumb line to the height of the camera tells where the point is in depth.
  const foot = [place[0], 0, place[2]];
  pen.setLineDash([1, 3]);
  pen.strokeStyle = theme.muted;
  line(pen, frame, place, foot);
  line(pen, frame, foot, [0, 0, place[2]]);
  pointMark(pen, ...on(frame, place), track.colour, theme);
  picture.avoid(...on(frame, place), 6);
}

/** The frustum with the image before the camera, whose axes are named. */
function frustum({ picture, pen, frame, theme }, corners) {
  if (!corners.length) return;
  pen.setLineDash([]);
  pen.strokeStyle = theme.muted;
  pen.fillStyle = theme.muted;
  for (const corner of corners) line(pen, frame, CAMERA, corner);
  pen.beginPath();
  for (const corner of corners) pen.lineTo(...on(frame, corner));
  pen.closePath();
  pen.globalAlpha = 0.08;
  pen.fill();
  pen.globalAlpha = 1;
  pen.stroke();
  const [lowLeft, lowRight, , highLeft] = corners.map((corner) => on(frame, corner));
  const middle = [0, 1].map((c) => (lowRight[c] + highLeft[c]) / 2);
  [lowRight, highLeft].forEach((corner, i) => {
    const at = [0, 1].map((c) => lowLeft[c] + 0.7 * (corner[c] - lowLeft[c]));
    const towards = [0, 1].map((c) => at[c] - middle[c]);
    picture.tag({ id: `y${i + 1}`, text: ["y1 →", "y2 ↑"][i], at, towards, gap: 2, colour: theme.muted, rank: 1 });
  });
}

/** @returns {[number, number]} */
function on(frame, place) {
  return [frame.x(...place), frame.y(...place)];
}

/** Where the end of a line from the camera on is named: first beyond it. */
function outwards(frame, end) {
  const [x0, y0] = on(frame, CAMERA);
  const [x, y] = on(frame, end);
  return { at: [x, y], towards: [x - x0, y - y0], gap: 2 };
}

/** A line as far as it is on the picture: what is beyond would be cut into dashes too, thousands of them. */
function line(pen, frame, from, to) {
  const part = partIn(on(frame, from), on(frame, to), frame.corners);
  if (part) stroke(pen, part.slice(0, 2), part.slice(2));
}

/** The path of a point, with gaps where it is nowhere. */
function path({ pen, frame, theme }, positions, { colour, dash, of, kept }) {
  pen.beginPath();
  let [before, end] = [[NaN, NaN], [NaN, NaN]];
  for (let k = 0; k < positions.length; k += 3) {
    const [X, Y, Z] = positions.subarray(k, k + 3);
    const at = on(frame, [X, Y, Z]);
    // Points closer than a pixel do not show.
    if (Math.abs(at[0] - before[0]) + Math.abs(at[1] - before[1]) < NEAR && k + 3 < positions.length) continue;
    const part = Number.isFinite(before[0] + before[1] + at[0] + at[1]) && partIn(before, at, frame.corners);
    if (part) {
      if (part[0] !== end[0] || part[1] !== end[1]) pen.moveTo(part[0], part[1]);
      pen.lineTo(part[2], part[3]);
      end = [part[2], part[3]];
    }
    before = at;
  }
  const own = kept ? theme.kept : colour;
  pen.strokeStyle = own;
  pen.setLineDash(kept ? KEPT : of ? dash : SOLID);
  pen.globalAlpha = (of ? 0.8 : 0.6) * opacityOf(theme, own);
  pen.lineWidth = theme.width;
  pen.stroke();
  pen.lineWidth = 1;
  pen.globalAlpha = 1;
}

/** Other places where a point would look alike, or else: those whose arrows are in the image, in the same words. */
function copies({ picture, pen, frame, theme }, found) {
  for (const [k, { place, text, alike }] of found.entries()) {
    const [x, y] = on(frame, place);
    const colour = alike ? theme.warning : theme.muted;
    disc(pen, x, y, 3, colour);
    picture.avoid(x, y, 4);
    picture.tag({ id: `copy ${k}`, text, at: [x, y], towards: [1, 1], gap: 5, colour, rank: 3 });
  }
}

/** An estimate as a ghost on its ray, with the distances that it claims, and how far it is from the truth. */
function estimate({ picture, pen, frame, theme, scene, ball }, track, at) {
  const { colour, of } = track;
  if (opacityOf(theme, colour) < 1) return;
  const place = positionAt(track, scene.ray, at);
  const [y1, y2] = [0, 1].map((c) => valueBetween(track.rows, track.width, (track.first ?? 0) + c, at));
  const direction = Array.from(scene.ray(y1, y2, new Float64Array(3)));
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
    line(pen, frame, truth, target.map((value) => within(value, -1e3 * ball.radius, 1e3 * ball.radius)));
    pen.lineWidth = 1;
  }
  const [width, height] = frame.corners[1];
  const rim = rimOf(on(frame, CAMERA), on(frame, target), [[8, 8], [width - 8, height - 8]]);
  const text = somewhere ? `${readable(track.distances[at.sample])} m` : inverse < 0 ? "behind the camera" : "∞";
  if (!rim) {
    ghostMark(pen, ...on(frame, place), colour);
    return;
  }
  rimMark(pen, rim, colour);
  const towards = [-Math.cos(rim.angle), -Math.sin(rim.angle)];
  const inner = rim.at.map((value, c) => value + 5 * towards[c]);
  picture.avoid(inner[0], inner[1], 6);
  picture.tag({ id: `rim ${colour}`, text, at: inner, towards, gap: 7, colour, rank: 2 });
}
