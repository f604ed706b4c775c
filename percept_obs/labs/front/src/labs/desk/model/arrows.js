// How the image moves by typed lines and as it does: at a point, over the picture, term by term.

import { RealPoint, valueAt } from "./proving.js";

const SIDE = Array.from({ length: 7 }, (_, k) => -0.9 + 0.3 * k).map((value) => Number(value.toFixed(6)));
/** Places in the image at which pairs of arrows stand. */
const FIELD = SIDE.flatMap((y2) => SIDE.map((y1) => [y1, y2]));
/** Largest number of beginnings of a line that are shown. */
const MOST_TERMS = 24;

/**
 * Motions in 1/s: "true" and "mine" at the point, and "field" with both over the picture; "mine" has null for what is
 * not typed or has no value.  "foe" has the true and the typed place where that is what is asked for.  Null for what is
 * no motion of an image, or cannot be drawn in a plane.
 */
export function pictureOf(sheet, step, typed, point) {
  const { lines, printed } = sheet;
  const image = [...lines.keys()].filter((row) => printed.image.includes(lines[row].name));
  if (image.length !== 2) return null;
  const rows = sheet.rows(step);
  const here = new Map([...typed].filter(([row]) => rows.includes(row)));
  const own = (row) => {
    if (rows.includes(row)) return formulaOf(sheet, row, here);
    return here.size ? sheet.followed(step, here, row) : undefined;
  };
  const motions = image.map((row) => [sheet.asked(row), own(row)]);
  const places = FIELD.map(([y1, y2]) => [y1, y2, point[2]]);
  const [true_, mine] = [0, 1].map((which) => motions.map((pair) => numbersOf(sheet, pair[which], [point])[0]));
  const [over, typedOver] = [0, 1].map((which) => motions.map((pair) => numbersOf(sheet, pair[which], places)));
  const asked = rows.map((row) => lines[row].name).join() === printed.image.map((name) => name.replace("'", "")).join();
  const foe = asked && {
    true: rows.map((row) => numbersOf(sheet, sheet.asked(row), [point])[0]),
    mine: rows.map((row) => numbersOf(sheet, formulaOf(sheet, row, here), [point])[0]),
  };
  const field = { places: FIELD, true: over, mine: typedOver };
  return { names: image.map((row) => lines[row].name), true: true_, mine, field, foe };
}

function formulaOf(sheet, row, typed) {
  return typed.has(row) ? sheet.entry(row, typed.get(row)).formula : undefined;
}

/**
 * Beginnings of a line of the image's motion: their ends in the text, what they look like, their motions, and "miss",
 * the root mean square of the difference from the true motion over the picture, as a part of that of the true one.
 */
export function grownOf(sheet, row, text, point) {
  if (!sheet.printed.image.includes(sheet.lines[row].name)) return [];
  const places = FIELD.map(([y1, y2]) => [y1, y2, point[2]]);
  const known = numbersOf(sheet, sheet.asked(row), places);
  return endsOf(text).flatMap((end) => {
    const { formula, markup } = sheet.entry(row, text.slice(0, end));
    if (!formula) return [];
    const field = numbersOf(sheet, formula, places);
    const squares = known.map((value, k) => (field[k] === null || value === null ? NaN : (field[k] - value) ** 2));
    const miss = Math.sqrt(mean(squares) / mean(known.map((value) => (value ?? NaN) ** 2)));
    const [at] = numbersOf(sheet, formula, [point]);
    return [{ markup, end, at, field, miss: Number.isFinite(miss) ? miss : null }];
  });
}

const mean = (values) => values.reduce((all, value) => all + value, 0) / values.length;

/** Places in a text at which a term of the outermost sum ends; the last one is the text's own. */
export function endsOf(text) {
  let [depth, before] = [0, "="];
  /** @type {number[]} */
  const ends = [];
  for (const [k, sign] of [...text].entries()) {
    depth += Number("([{".includes(sign)) - Number(")]}".includes(sign));
    if ("+-".includes(sign) && !depth && !"+-*/^=({[,".includes(before)) ends.push(text.slice(0, k).trimEnd().length);
    if (sign.trim()) before = sign;
  }
  return [...ends.slice(0, MOST_TERMS - 1), text.length];
}

/** Numbers of a formula at places y1, y2 and the inverse distance; null where it has none. */
function numbersOf(sheet, formula, places) {
  const { numbers } = sheet.printed;
  return places.map((place) => {
    if (!formula) return null;
    const values = (name) => numbers[name] ?? place[["y1", "y2", "y3"].indexOf(name)] ?? NaN;
    const found = valueAt(new RealPoint(values, sheet.meant), formula);
    return found ? Number(found[0].toPrecision(9)) : null;
  });
}
