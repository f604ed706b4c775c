// A handle on a picture: dragged with mouse, touch or arrow keys.

import { element } from "./controls.js";
import { readable } from "../model/scales.js";

const NUDGE = 0.01;
const LEAP = 10;
const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** Stands at a place in the picture's coordinates, if there is one, and tells where it is moved to. */
export class Handle {
  constructor({ name, label, className, text = "", onMove, onRest, onKey = (_event) => false }) {
    this.onMove = onMove;
    this.onRest = onRest;
    this.onKey = onKey;
    /** @type {number[] | null} */
    this.at = null;
    /** @type {{id: number, x: number, y: number, from: number[]} | null} */
    this.grip = null;
    this.keyed = false;
    this.scale = 1;
    this.node = element("div", { class: `handle ${className}`, tabindex: 0, role: "slider", "aria-label": label, "aria-valuenow": 0 });
    this.node.dataset.control = name;
    this.node.append(text);
    this.listen();
  }

  listen() {
    const { node } = this;
    node.addEventListener("pointerdown", (event) => {
      if (!this.at || event.button > 0) return;
      event.preventDefault();
      node.focus({ preventScroll: true });
      // What had the focus comes to rest and is drawn, and this handle may be gone with it.
      if (!this.at) return;
      try {
        node.setPointerCapture(event.pointerId);
      } catch {
        // A pointer that a script made cannot be captured; its moves arrive all the same.
      }
      this.grip = { id: event.pointerId, x: event.clientX, y: event.clientY, from: [...this.at] };
    });
    const follow = (event) => {
      if (!this.grip || event.pointerId !== this.grip.id) return;
      const [y1, y2] = this.grip.from;
      this.move([y1 + (event.clientX - this.grip.x) / this.scale, y2 - (event.clientY - this.grip.y) / this.scale]);
    };
    const release = (event) => {
      if (!this.grip || event.pointerId !== this.grip.id) return;
      // A quick drag loses its last move in half of the cases, so the place is read once more.
      if (event.type === "pointerup") follow(event);
      this.grip = null;
      this.onRest();
    };
    node.addEventListener("pointermove", follow);
    for (const type of ["pointerup", "pointercancel", "lostpointercapture"]) node.addEventListener(type, release);
    node.addEventListener("keydown", (event) => {
      if (!this.at) return;
      const step = STEPS[event.key];
      if (step) {
        const size = NUDGE * (event.shiftKey ? LEAP : 1);
        this.move([this.at[0] + step[0] * size, this.at[1] + step[1] * size]);
      } else if (!this.onKey(event)) return;
      this.keyed = true;
      event.preventDefault();
    });
    for (const type of ["keyup", "blur"]) {
      node.addEventListener(type, () => {
        if (this.keyed) this.onRest();
        this.keyed = false;
      });
    }
  }

  /** Go to a place, where the next step begins: keys may come faster than pictures. */
  move(place) {
    this.at = place;
    this.onMove(place);
  }

  /**
   * Stand at a place, or at the edge of the box nearest to it; without a place, nowhere.  A picture that is late, of
   * settings before the present ones, does not say where the next step begins.
   */
  stand(at, frame, late = false) {
    const { node } = this;
    if (!late) this.at = at;
    node.hidden = !at;
    if (!at) return;
    const { box, scale, x, y } = frame;
    this.scale = scale;
    const inside = (value, low) => Math.min(Math.max(value, low), low + box.side);
    const [left, top] = [inside(x(at[0]), box.left), inside(y(at[1]), box.top)];
    const outside = Math.abs(left - x(at[0])) + Math.abs(top - y(at[1])) > 1;
    if (outside !== node.classList.contains("outside")) node.classList.toggle("outside");
    const right = left > box.left + 0.7 * box.side;
    if (right !== node.classList.contains("right")) node.classList.toggle("right");
    node.style.transform = `translate(${left}px, ${top}px)`;
  }

  describe(more = "") {
    if (!this.at) return;
    this.node.setAttribute("aria-valuenow", this.at[0].toFixed(3));
    this.node.setAttribute("aria-valuetext", `y1 ${readable(this.at[0])}, y2 ${readable(this.at[1])}${more}`);
  }
}
