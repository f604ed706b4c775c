// The one language of marks: what the start, the end, the present, an estimate, a reset look like in every picture.

/** Width of the rim of a dot, by which it stands out of what lies below it. */
const RIM = 1.5;
/** Radius of a ghost, which leaves room for the point inside of it. */
const GHOST = 9;

/** Length of a reset's tick, which hangs from the top of a chart. */
export const RESET = 6;

/** Where a path begins: an open circle. */
export function startMark(pen, x, y, theme) {
  ring(pen, x, y, 4, theme.ink, 1);
}

/** Where a path ends: a full square. */
export function endMark(pen, x, y, theme) {
  if (Number.isNaN(x + y)) return;
  pen.fillStyle = theme.ink;
  pen.fillRect(x - 3.5, y - 3.5, 7, 7);
}

/** Where the point is at the time shown: a full dot. */
export function pointMark(pen, x, y, colour, theme) {
  if (Number.isNaN(x + y)) return;
  disc(pen, x, y, 4 + RIM, theme.paper);
  disc(pen, x, y, 4, colour);
}

/** Where an observer thinks it is: a ring in the observer's colour, its ghost. */
export function ghostMark(pen, x, y, colour) {
  ring(pen, x, y, GHOST, colour, 1.5);
}

/** Where the translation points: an open diamond, as its handle is where the motion is constant. */
export function foeMark(pen, x, y, theme) {
  if (Number.isNaN(x + y)) return;
  pen.setLineDash([]);
  pen.strokeStyle = theme.warning;
  pen.lineWidth = 2;
  pen.beginPath();
  for (const [across, down] of [[0, -9], [9, 0], [0, 9], [-9, 0]]) pen.lineTo(x + across, y + down);
  pen.closePath();
  pen.stroke();
  pen.lineWidth = 1;
}

/** Something outside of the picture: an arrow at the rim. */
export function rimMark(pen, { at: [x, y], angle }, colour) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  pen.fillStyle = colour;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x - 10 * c + 5 * s, y - 10 * s - 5 * c);
  pen.lineTo(x - 10 * c - 5 * s, y - 10 * s + 5 * c);
  pen.fill();
}

/** An arrow with a head of a fixed size; nothing where it would be shorter than it could be seen. */
export function arrowMark(pen, from, to, { colour, dash, width, head }) {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (!(length > 1)) return;
  const [c, s] = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
  pen.strokeStyle = pen.fillStyle = colour;
  pen.lineWidth = width;
  pen.setLineDash(dash);
  stroke(pen, from, [to[0] - 0.7 * head * c, to[1] - 0.7 * head * s]);
  pen.lineWidth = 1;
  pen.beginPath();
  pen.moveTo(to[0], to[1]);
  for (const side of [0.5, -0.5]) pen.lineTo(to[0] - head * (c - side * s), to[1] - head * (s + side * c));
  pen.fill();
}

/** A straight line in the pen's present style. */
export function stroke(pen, from, to) {
  pen.beginPath();
  pen.moveTo(from[0], from[1]);
  pen.lineTo(to[0], to[1]);
  pen.stroke();
}

export function disc(pen, x, y, radius, colour) {
  pen.fillStyle = colour;
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fill();
}

export function ring(pen, x, y, radius, colour, width) {
  if (Number.isNaN(x + y)) return;
  pen.setLineDash([]);
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.stroke();
  pen.lineWidth = 1;
}
