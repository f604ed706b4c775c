// @ts-check
// Results that leave a worker: all of their numbers in one buffer, which is handed over and comes back when it is not
// needed any more.  Nothing is copied on the way, and a drag leaves no litter behind.

/** A new buffer has room for more than is asked, since the next result may be larger. */
const ROOM = 1.25;

/**
 * A copy of plain data whose arrays of numbers lie in one buffer, and that buffer: one of the spare ones, which is
 * taken,
 * or a new one.
 *
 * @param {ArrayBuffer[]} spare
 */
export function packed(data, spare) {
  /** @type {Map<any, number>} where each array begins */
  const begins = new Map();
  let size = 0;
  const measure = (value) => {
    if (!ArrayBuffer.isView(value)) return isDeep(value) && Object.values(value).forEach(measure);
    if (begins.has(value)) return undefined;
    begins.set(value, size);
    size += 8 * Math.ceil(value.byteLength / 8);
    return undefined;
  };
  measure(data);
  const taken = spare.pop();
  const room = taken && taken.byteLength >= size ? taken : new ArrayBuffer(8 * Math.ceil((ROOM * size) / 8));
  const copies = new Map(Array.from(begins, ([array, begin]) => {
    const copy = new array.constructor(room, begin, array.length);
    copy.set(array);
    return [array, copy];
  }));
  const copied = (value) => {
    if (copies.has(value)) return copies.get(value);
    if (Array.isArray(value)) return value.map(copied);
    return isDeep(value)
      ? Object.fromEntries(Object.entries(value).map(([key, inner]) => [key, copied(inner)]))
      : value;
  };
  return { data: copied(data), room };
}

function isDeep(value) {
  return typeof value === "object" && value !== null;
}
