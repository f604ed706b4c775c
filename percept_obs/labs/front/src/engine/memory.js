// Results and arrays that are kept from one run to the next. Arrays of a room are never handed out.

import { same, valueAt } from "../state/settings.js";

/** Stands for a group of settings among those that were read. */
const GROUP = Symbol("group");

const isGroup = (value) => typeof value === "object" && value !== null && !Array.isArray(value);

/** Settings that note each value that is read of them in `reads`, by its place. */
function recorded(settings, reads, path = "") {
  const note = (place, value) => reads.set(place, isGroup(value) ? GROUP : value);
  return new Proxy(settings, {
    get(target, key) {
      const value = target[key];
      if (typeof key === "symbol") return value;
      const place = `${path}${key}`;
      note(place, value);
      return isGroup(value) ? recorded(value, reads, `${place}.`) : value;
    },
    ownKeys() {
      throw new Error("read settings by their names, so that it is known which of them count");
    },
  });
}

/** Values that are kept for the settings that were read to make them, and arrays that are used again. */
export class Memory {
  constructor() {
    this.kept = new Map();
    this.rooms = new Map();
  }

  /** Room for numbers that only one run needs: taken again by the next, so that a drag leaves no litter. */
  room(name, length) {
    let room = this.rooms.get(name);
    if (room?.length !== length) this.rooms.set(name, (room = new Float64Array(length)));
    return room;
  }

  /**
   * The value that `make` makes of settings; made anew when a setting that it read has another value, or one of the
   * other inputs is not the same.
   */
  once(name, settings, make, ...inputs) {
    const kept = this.kept.get(name);
    // Read through what may be recorded settings, so that who asks depends on the same.
    const holds = ([place, value]) => {
      const now = valueAt(settings, place);
      return value === GROUP ? isGroup(now) : same(now, value);
    };
    const alike = kept?.inputs.length === inputs.length && inputs.every((input, k) => Object.is(input, kept.inputs[k]));
    if (alike && kept.reads.every(holds)) return kept.value;
    const reads = new Map();
    const value = make(recorded(settings, reads));
    this.kept.set(name, { reads: [...reads], inputs, value });
    return value;
  }
}
