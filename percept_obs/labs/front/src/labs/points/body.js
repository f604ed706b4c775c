// Where points of one state are at a time, before the camera and in a world at rest; and what no picture shows.

import { derived } from "../../engine/derived.js";
import { valueBetween } from "../../engine/between.js";
import { rowsOf } from "./camera.js";
import { ENTRIES, inversesOf } from "./flow.js";
import { OWN } from "./kernels.js";
import { eigen, product, pseudoInverse } from "./symmetric.js";

/** How much larger the copy is that no picture tells from the body. */
const LARGER = 0.4;

/** A result at a time, with ways from time 0 to that time and back, and to the world. */
export class Body {
  constructor(engine, model, shown, functions, at) {
    const { settings, points, n } = shown;
    this.points = points;
    this.n = n;
    this.shown = shown;
    this.at = at;
    this.rigid = settings.state !== OWN;
    this.flows = engine.flows(shown, functions);
    this.flow = this.flows.flows.map((rows) =>
      Float64Array.from({ length: ENTRIES }, (_, e) => valueBetween(rows, ENTRIES, e, at)),
    );
    this.back = this.flow.map(inversesOf);
    this.rows = rowsOf(model.states[settings.state].layouts[points - 1], n);
    this.unseen = derived(shown.truth, "unseen", () => {
      const { matrix } = engine.gramian(shown, functions, Infinity);
      const found = eigen(matrix, n);
      const least = model.unseen * Math.max(found[n - 1].value, 1e-300);
      return found.filter(({ value }) => value <= least).map(({ vector }) => vector);
    });
  }

  state(rows) {
    return Float64Array.from({ length: this.n }, (_, i) => valueBetween(rows, this.n, i, this.at));
  }

  /** Places of the points of a state. */
  places(state) {
    const flat = product(this.rows, state, 3 * this.points);
    return Array.from({ length: this.points }, (_, k) => Array.from(flat.subarray(3 * k, 3 * k + 3)));
  }

  /** A difference of states at time 0, now. */
  forward(state) {
    return this.turned(this.flow, 4, state);
  }

  turned(matrices, width, state) {
    const { kindOf } = this.flows;
    return state.map((_, i) => {
      const [vector, row] = [Math.floor(i / 3), i % 3];
      const matrix = matrices[kindOf[vector]];
      return [0, 1, 2].reduce((sum, c) => sum + matrix[width * row + c] * state[3 * vector + c], 0);
    });
  }

  /** Places at time 0 of points of which one is moved now. */
  movedTo(k, place) {
    const { points, n, shown } = this;
    const now = this.places(this.state(shown.truth))[k];
    const step = new Float64Array(3 * points);
    place.forEach((value, i) => (step[3 * k + i] = value - now[i]));
    const state = product(pseudoInverse(this.rows, 3 * points, n), step, n);
    const before = this.places(this.turned(this.back, 3, state));
    return shown.settings.points.map((point, j) => point.map((value, i) => value + before[j][i]));
  }

  /** From the camera's frame now to the world, which is its frame at time 0. */
  toWorld(place) {
    if (!this.rigid) return place;
    const kind = this.flows.kindOf[0];
    const [flow, back] = [this.flow[kind], this.back[kind]];
    const from = place.map((value, i) => value - flow[4 * i + 3]);
    return [0, 3, 6].map((row) => back[row] * from[0] + back[row + 1] * from[1] + back[row + 2] * from[2]);
  }

  /** The places of a copy of the body that has the same images all the time: some size larger, or as it was dragged. */
  copy(amounts) {
    const { unseen, shown } = this;
    const state = this.state(shown.truth);
    const step = state.map((_, i) => unseen.reduce((sum, vector, j) => sum + amounts[j] * vector[i], 0));
    return this.places(this.forward(step).map((value, i) => state[i] + value));
  }

  /** Amounts of each unseen direction that make the body larger, as far as that is not seen. */
  larger() {
    const { unseen, shown } = this;
    return unseen.map((vector) => LARGER * vector.reduce((sum, value, i) => sum + value * shown.truth[i], 0));
  }

  /** How a copy's point moves in the world, seen from above, with each of the amounts. */
  movable(k) {
    const origin = this.toWorld([0, 0, 0]);
    return this.unseen.map((vector) => {
      const [x, , z] = this.toWorld(this.places(this.forward(vector))[k]);
      return [x - origin[0], z - origin[2]];
    });
  }

  /** The least amounts that bring a copy's point to a place, as near as no picture shows it. */
  amountsTo(k, [x, z]) {
    const { unseen, shown } = this;
    const [from, , ahead] = this.toWorld(this.places(this.state(shown.truth))[k]);
    const ways = this.movable(k);
    const rows = Float64Array.from([...ways.map(([across]) => across), ...ways.map(([, along]) => along)]);
    return Array.from(product(pseudoInverse(rows, 2, unseen.length), [x - from, z - ahead], unseen.length));
  }
}
