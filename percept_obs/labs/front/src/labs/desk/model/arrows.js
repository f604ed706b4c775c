// How the image moves by typed lines and as it does: at a point, over the picture, term by term.

const SIDE = Array.from({ length: 7 }, (_, k) => Number((-0.9 + 0.3 * k).toFixed(6)));
/** Places in the image at which pairs of arrows stand. */
const FIELD = SIDE.flatMap((y2) => SIDE.map((y1) => [y1, y2]));

/**
 * Motions in 1/s, true and mine, at the point and over the picture, with null for what is not typed or has no value;
 * "foe" has the places, where these are asked for.  Null where no motion of an image can be drawn in a plane.
 */
export function pictureOf(sheet, step, typed, point) {
  const { lines, printed } = sheet;
  const image = [...lines.keys()].filter((row) => printed.image.includes(lines[row].name));
  if (image.length !== 2) return null;
  const rows = sheet.rows(step);
  const here = new Map([...typed].filter(([row]) => rows.includes(row)));
  const typedIn = (row) => (here.has(row) ? sheet.entry(row, here.get(row)) : undefined);
  const own = (row) => (rows.includes(row) ? typedIn(row) : here.size ? sheet.followed(step, here, row) : undefined);
  const asked = (row) => sheet.asked(row);
  const at = (some, of) => some.map((row) => numbersOf(sheet, of(row), [point])[0]);
  const over = (of) => image.map((row) => numbersOf(sheet, of(row), placesOf(point)));
  const isPlace = rows.map((row) => `${lines[row].name}'`).join() === printed.image.join();
  return {
    names: image.map((row) => lines[row].name),
    ...{ true: at(image, asked), mine: at(image, own) },
    field: { places: FIELD, true: over(asked), mine: over(own) },
    foe: isPlace && { true: at(rows, asked), mine: at(rows, typedIn) },
  };
}

/** Beginnings of a line of the image's motion; each misses by a part of the true motion, as root mean squares. */
export function grownOf(sheet, row, text, point) {
  if (!sheet.printed.image.includes(sheet.lines[row].name)) return [];
  const sizeOf = (values) => Math.hypot(...values.map((value) => value ?? NaN));
  const known = numbersOf(sheet, sheet.asked(row), placesOf(point));
  return sheet.entry(row, text).begun.map(({ end, tree, value }) => {
    const field = numbersOf(sheet, { value }, placesOf(point));
    const miss = sizeOf(known.map((each, k) => (field[k] === null ? null : field[k] - each))) / sizeOf(known);
    const [at] = numbersOf(sheet, { value }, [point]);
    return { pieces: sheet.pieces(tree), end, at, field, miss: Number.isFinite(miss) ? miss : null };
  });
}

const placesOf = ([, , inverse]) => FIELD.map(([y1, y2]) => [y1, y2, inverse]);

/** Numbers of a formula at places y1, y2 and the inverse distance; null where it has none. */
function numbersOf(sheet, formula, places) {
  const numbers = Object.entries(sheet.printed.numbers);
  return places.map((place) => {
    const at = sheet.changed(new Map([...numbers, ...place.map((value, k) => [`y${k + 1}`, value])]));
    const [value] = formula?.value?.(at) ?? [NaN];
    return Number.isFinite(value) ? Number(value.toPrecision(9)) : null;
  });
}
