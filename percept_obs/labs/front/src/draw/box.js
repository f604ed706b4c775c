// The box around what a picture is to hold.

/** A box of places, from which follow the middle and the scale of a picture that holds it. */
export class Box {
  low = [Infinity, Infinity];
  high = [-Infinity, -Infinity];

  /** Hold a place with some room around it; what is not finite has none. */
  take(place, room = [0, 0]) {
    if (!Number.isFinite(place[0] + place[1])) return;
    for (const c of [0, 1]) {
      this.low[c] = Math.min(this.low[c], place[c] - room[c]);
      this.high[c] = Math.max(this.high[c], place[c] + room[c]);
    }
  }

  get size() {
    return [0, 1].map((c) => this.high[c] - this.low[c]);
  }

  get middle() {
    return [0, 1].map((c) => (this.low[c] + this.high[c]) / 2);
  }
}
