// How the map over two settings is drawn: shades, hatches, the line of the tolerance, axes, a key beside it.

import { cellAt, shareOf, ticksOn } from "./axes.js";
import { DIVERGED, EACH_CELL, FOLLOWED, IMPOSSIBLE, NOT_YET } from "./cells.js";
import { linearScale, readable } from "../draw/scales.js";
import { paintDots } from "../draw/canvas.js";
import { clipTo, drawTicks } from "./image_frame.js";
import { stroke } from "../draw/marks.js";

const MARGIN = { left: 46, top: 34, right: 94, bottom: 62 };
const SHADES = 8;
const [FAINTEST, STRONGEST] = [0.08, 0.92];
/** The least error of a shade of its own: half decades from 0.01 % on. */
const LEAST_DECADE = -4;
const SETTLING = 1;

/** The part of a picture that is the map itself. */
export function boxOf({ width, height }) {
  const { left, top, right, bottom } = MARGIN;
  return { left, top, width: Math.max(20, width - left - right), height: Math.max(20, height - top - bottom) };
}

/** Values at which a next shade begins. */
export function edgesOf(what, duration) {
  if (what === "error") return Array.from({ length: SHADES - 1 }, (_, k) => 10 ** (LEAST_DECADE + (k + 1) / 2));
  const highest = Math.ceil(Math.log10(duration));
  const powers = Array.from({ length: SHADES }, (_, k) => highest - SHADES + 1 + k);
  const round = powers.flatMap((power) => [1, 2, 5].map((step) => Number(`${step}e${power}`)));
  return round.filter((edge) => edge < duration).slice(1 - SHADES);
}

const opacityOf = (shade) => FAINTEST + ((STRONGEST - FAINTEST) * shade) / (SHADES - 1);

function shadeOf(edges, value) {
  const above = edges.findIndex((edge) => value < edge);
  return above < 0 ? SHADES - 1 : above;
}

/** Rows of cells as fine as any that is filled, each with the numbers of the finest level that has it. */
function merged({ levels }) {
  const { cells } = levels.at(-1);
  const values = new Float64Array(EACH_CELL * cells * cells);
  for (let j = 0, at = 0; j < cells; j++) {
    for (let i = 0; i < cells; i++, at += EACH_CELL) {
      for (let k = levels.length - 1; k >= 0 && values[at] === NOT_YET; k--) {
        const level = levels[k];
        const [column, row] = [i, j].map((place) => cellAt((place + 0.5) / cells, level.cells));
        const from = EACH_CELL * (row * level.cells + column);
        for (let c = 0; c < EACH_CELL; c++) values[at + c] = level.values[from + c];
      }
    }
  }
  return { cells, values };
}

/** The hatch of what has no shade: lines across for what does not settle, a lattice for what diverges. */
function hatch(pen, kind, theme) {
  const size = 6;
  const tile = document.createElement("canvas");
  tile.width = tile.height = size;
  const on = /** @type {CanvasRenderingContext2D} */ (tile.getContext("2d"));
  on.strokeStyle = kind === DIVERGED ? theme.warning : theme.muted;
  on.lineWidth = 1;
  on.globalAlpha = kind === DIVERGED ? 1 : 0.8;
  for (const shift of [-size, 0, size]) {
    stroke(on, [shift, size], [shift + size, 0]);
    if (kind === DIVERGED) stroke(on, [shift, 0], [shift + size, size]);
  }
  return pen.createPattern(tile, "repeat");
}

function hatchOf(values, at, what) {
  if (values[at] === DIVERGED) return DIVERGED;
  const value = values[at + (what === "settling" ? SETTLING : 2)];
  return values[at] === FOLLOWED && !(value < Infinity) ? FOLLOWED : 0;
}

function paintCells(pen, { left, top, width, height }, { found, what }, theme) {
  const { cells, values } = merged(found);
  const edges = edgesOf(what, found.duration);
  const [across, down] = [width / cells, height / cells];
  const paths = { [DIVERGED]: new Path2D(), [FOLLOWED]: new Path2D() };
  const picture = document.createElement("canvas");
  paintDots(picture, cells, theme.lines[0], (cell) => {
    const at = EACH_CELL * cell;
    const [i, j] = [cell % cells, Math.floor(cell / cells)];
    const hatched = hatchOf(values, at, what);
    if (hatched) paths[hatched].rect(left + i * across, top + height - (j + 1) * down, across, down);
    if (hatched || values[at] !== FOLLOWED) return 0;
    return opacityOf(shadeOf(edges, values[at + (what === "settling" ? SETTLING : 2)]));
  });
  pen.imageSmoothingEnabled = false;
  pen.drawImage(picture, left, top, width, height);
  for (const kind of [FOLLOWED, DIVERGED]) {
    pen.fillStyle = hatch(pen, kind, theme);
    pen.fill(paths[kind]);
  }
}

/** The line on which the error at the end is the tolerance, through the finest level that is whole. */
export function toleranceLine({ levels, tolerance }) {
  const level = levels.findLast(({ cells, done }) => done === cells * cells);
  const pieces = [];
  if (!level) return pieces;
  const { cells, values } = level;
  // Beyond a thousand tolerances a line is drawn halfway: what diverges has no error at all.
  const bounded = (at) => {
    if (values[at] === IMPOSSIBLE) return NaN;
    const height = Math.log(values[at + 2] / tolerance);
    return values[at] === DIVERGED || Number.isNaN(height) ? 7 : Math.min(Math.max(height, -7), 7);
  };
  const corner = (i, j) => bounded(EACH_CELL * (j * cells + i));
  for (let j = 0; j + 1 < cells; j++) {
    for (let i = 0; i + 1 < cells; i++) {
      const around = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(([a, b]) => ({ a, b, height: corner(a, b) }));
      const crossings = around.flatMap((one, k) => {
        const other = around[(k + 1) % 4];
        if (!(one.height < 0 !== other.height < 0) || Number.isNaN(one.height + other.height)) return [];
        const part = one.height / (one.height - other.height);
        return [[(one.a + part * (other.a - one.a) + 0.5) / cells, (one.b + part * (other.b - one.b) + 0.5) / cells]];
      });
      for (let k = 0; k + 1 < crossings.length; k += 2) pieces.push([crossings[k], crossings[k + 1]]);
    }
  }
  return pieces;
}

function onBox({ left, top, width, height }) {
  return ([x, y]) => [left + x * width, top + height - y * height];
}

function drawTolerance(pen, box, found, theme) {
  const place = onBox(box);
  pen.beginPath();
  for (const [from, to] of toleranceLine(found)) {
    pen.moveTo(...place(from));
    pen.lineTo(...place(to));
  }
  for (const [colour, width] of [[theme.paper, 4], [theme.ink, 1.5]]) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.stroke();
  }
  pen.lineWidth = 1;
}

/** All that stays while a cursor moves. */
export function drawMap(picture, box, { found, plan, what, title }, theme) {
  const { pen, width } = picture;
  const words = (text) => picture.shortened(text, width - 10);
  picture.write(words(`${title}, in ${what === "settling" ? "s" : "%"}`), 5, 8, theme.ink, "left");
  if (found) {
    pen.save();
    clipTo(pen, box);
    paintCells(pen, box, { found, what }, theme);
    drawTolerance(pen, box, found, theme);
    pen.restore();
    drawKey(picture, box, what, found, theme);
  }
  if (!plan?.across || !plan.up) return;
  const ticks = (axis, length, each) => ticksOn(axis, (low, high) => linearScale(low, high, length / each).ticks);
  const frame = {
    box: { ...box, side: box.width },
    x: (value) => box.left + shareOf(plan.across, value) * box.width,
    y: (value) => box.top + box.height - shareOf(plan.up, value) * box.height,
  };
  const each = [ticks(plan.across, box.width, 45), ticks(plan.up, box.height, 30)];
  picture.write(words(plan.up.label), 5, box.top - 10, theme.ink, "left");
  const across = words(plan.across.label);
  const end = Math.max(box.left + box.width, 5 + pen.measureText(across).width);
  picture.write(across, end, box.top + box.height + 25, theme.ink, "right");
  drawTicks(picture, frame, each, { ...theme, grid: "transparent" });
}

/** The key of shades and hatches, beside the map. */
function drawKey(picture, { left, top, width, height }, what, { duration, tolerance }, theme) {
  const { pen } = picture;
  const x = left + width + 10;
  const edges = edgesOf(what, duration);
  const each = Math.min(14, Math.max(4, (height - 76) / SHADES));
  pen.setLineDash([]);
  const word = (text, at, y) => picture.write(text, at, y, theme.ink, "left");
  for (let shade = 0; shade < SHADES; shade++) {
    pen.globalAlpha = opacityOf(shade);
    pen.fillStyle = theme.lines[0];
    pen.fillRect(x, top + shade * each, 16, each);
    pen.globalAlpha = 1;
  }
  pen.strokeStyle = theme.line;
  pen.strokeRect(x + 0.5, top + 0.5, 16, SHADES * each);
  const every = Math.ceil((what === "settling" ? 11 : 20) / each);
  edges.forEach((edge, k) => {
    if ((k + 1) % every) return;
    word(readable(what === "settling" ? edge : 100 * edge, 2), x + 21, top + (k + 1) * each);
  });
  const rows = [
    [FOLLOWED, what === "settling" ? "never" : "no error"],
    [DIVERGED, "diverges"],
    [IMPOSSIBLE, "no run"],
  ];
  let y = top + SHADES * each + 8;
  for (const [kind, text] of rows) {
    if (kind !== IMPOSSIBLE) {
      pen.fillStyle = hatch(pen, kind, theme);
      pen.fillRect(x, y, 16, 11);
    }
    pen.strokeStyle = theme.line;
    pen.strokeRect(x + 0.5, y + 0.5, 16, 11);
    word(text, x + 21, y + 6);
    y += 16;
  }
  pen.strokeStyle = theme.ink;
  pen.lineWidth = 1.5;
  stroke(pen, [x, y + 6], [x + 16, y + 6]);
  pen.lineWidth = 1;
  word(`${readable(100 * tolerance, 2)} % error`, x + 21, y + 6);
}

/** The present settings as a cross, and the cell under the cursor as a frame. */
export function drawAim(pen, box, standing, cell, theme) {
  const place = onBox(box);
  const [x, y] = place(standing.map((share) => Math.min(Math.max(share, 0), 1)));
  pen.setLineDash([]);
  for (const [colour, width] of [[theme.paper, 4.5], [theme.ink, 2]]) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    stroke(pen, [x - 6, y], [x + 6, y]);
    stroke(pen, [x, y - 6], [x, y + 6]);
  }
  pen.lineWidth = 1;
  if (!cell) return;
  const [left, bottom] = place([cell.i / cell.cells, cell.j / cell.cells]);
  const [right, top] = place([(cell.i + 1) / cell.cells, (cell.j + 1) / cell.cells]);
  pen.strokeStyle = theme.paper;
  pen.strokeRect(left - 1.5, top - 1.5, right - left + 3, bottom - top + 3);
  pen.strokeStyle = theme.ink;
  pen.strokeRect(left - 0.5, top - 0.5, right - left + 1, bottom - top + 1);
}
