// The marks of every picture: arrows, lines, discs and rings.

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
function stroke(pen, from, to) {
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

/** Where the translation points: a circle with a cross. */
export function foeMark(pen, x, y, theme) {
  ring(pen, x, y, 10, theme.warning, 2.5);
  pen.strokeStyle = theme.warning;
  pen.lineWidth = 2;
  stroke(pen, [x - 5, y], [x + 5, y]);
  stroke(pen, [x, y - 5], [x, y + 5]);
  pen.lineWidth = 1;
}
