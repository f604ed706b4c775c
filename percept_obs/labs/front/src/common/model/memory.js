// What a computation keeps from one run to the next. Nothing of a room is ever handed out.

const serials = new WeakMap();
let last = 0;

/** A number that stands for an object among inputs: two grids of one length and end may differ between. */
export function serialOf(object) {
  if (!serials.has(object)) serials.set(object, (last += 1));
  return serials.get(object);
}

/** Values that are made once for the same inputs, and arrays that are used again. */
export class Memory {
  constructor() {
    this.kept = new Map();
    this.rooms = new Map();
  }

  /** Room for numbers that only one run needs: taken again by the next, so that a drag leaves no litter. */
  room(part, length) {
    let room = this.rooms.get(part);
    if (room?.length !== length) this.rooms.set(part, (room = new Float64Array(length)));
    return room;
  }

  /** The value made for these inputs; made anew when they change, and then the one before is gone. */
  once(part, inputs, make) {
    const key = JSON.stringify(inputs);
    const kept = this.kept.get(part);
    if (kept && kept.key === key) return kept.value;
    const value = make();
    this.kept.set(part, { key, value });
    return value;
  }
}
