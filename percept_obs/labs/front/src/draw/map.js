// What maps of the first screen have in common: ground, and a camera.

/** Lines in a direction at most, whatever the numbers are. */
const MOST_LINES = 500;

/** A line for each decimetre or metre, or for more where these would be too near. */
export function drawGround(view, { x, y }, theme) {
  const { width, height, at: [cx, cz, scale] } = view;
  const step = [0.1, 1, 5, 10, 50, 100, 1000].find((m) => m * scale >= 9) ?? 10 ** Math.ceil(Math.log10(9 / scale));
  const about = (/** @type {number} */ middle, /** @type {number} */ reach) => {
    const first = Math.ceil((middle - reach) / step);
    return Array.from({ length: Math.min(Math.ceil((2 * reach) / step), MOST_LINES) }, (_, k) => first + k);
  };
  const lines = [
    ...about(cx, (0.6 * width) / scale).map((k) => ({ k, ends: [[x(k * step), 0], [x(k * step), height]] })),
    ...about(cz, (0.6 * height) / scale).map((k) => ({ k, ends: [[0, y(k * step)], [width, y(k * step)]] })),
  ];
  for (const [alpha, fifth] of /** @type {[number, boolean][]} */ ([[0.18, false], [0.5, true]])) {
    const some = lines.filter(({ k }) => (k % 5 === 0) === fifth);
    view.line(some.flatMap(({ ends }) => [...ends, [NaN, NaN]]), theme.line, { width: 1, alpha });
  }
}

/** A camera from above, turned from straight ahead. */
export function drawCamera(view, at, turn, theme) {
  const [x, y] = at;
  const pen = view.context;
  pen.save();
  pen.translate(x, y);
  pen.rotate(turn);
  pen.fillStyle = theme.ink;
  pen.beginPath();
  for (const [u, v] of [[-4, 2], [-7, -6], [7, -6], [4, 2]]) pen.lineTo(u, v);
  pen.roundRect(-11, 0, 22, 14, 3);
  pen.fill();
  pen.restore();
  view.avoid(x, y + 4, 14);
}

/** What an image holds, between two far places. */
export function drawCone(view, camera, edges, theme) {
  const pen = view.context;
  pen.beginPath();
  for (const [u, v] of [camera, ...edges]) pen.lineTo(u, v);
  pen.fillStyle = theme.ink;
  pen.globalAlpha = 0.06;
  pen.fill();
  pen.globalAlpha = 1;
}
