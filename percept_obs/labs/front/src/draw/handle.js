// A handle on a picture: dragged with mouse, touch or arrow keys.

import { within } from "../engine/between.js";
import { readable } from "./scales.js";
import { element, listen } from "./dom.js";

const NUDGE = 0.01;
const LEAP = 10;
/** Pixels within which a handle that can be pressed was not moved. */
const PRESSED = 4;

/** Steps of the arrow keys, right and up. */
const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** Stands at a place in the picture's coordinates, if there is one, and tells where it is moved to. */
export class Handle {
  /** @param {Record<string, any>} parts  `onPress` is for a press that does not move it, and for Enter or space */
  constructor({ name, label, className, nudge = NUDGE, onMove, onRest, onPress = null }) {
    this.nudge = nudge;
    this.onMove = onMove;
    this.onPress = onPress;
    /** @type {number[] | null} */
    this.at = null;
    /** @type {{id: number, x: number, y: number, from: number[], moved: boolean} | null} */
    this.grip = null;
    this.keyed = false;
    this.scale = 1;
    this.node = element("div", {
      ...{ class: `handle ${className}`, "data-control": name, tabindex: 0, role: "slider" },
      ...{ "aria-label": label, "aria-valuenow": 0 },
    });
    const follow = (event) => {
      if (!this.grip || event.pointerId !== this.grip.id) return;
      const { x, y, from: [y1, y2] } = this.grip;
      const near = Math.hypot(event.clientX - x, event.clientY - y) < PRESSED;
      if (onPress && !this.grip.moved && near) return;
      this.grip.moved = true;
      this.move([y1 + (event.clientX - x) / this.scale, y2 - (event.clientY - y) / this.scale]);
    };
    const release = (event) => {
      if (!this.grip || event.pointerId !== this.grip.id) return;
      // A quick drag loses its last move in half of the cases, so the place is read once more.
      if (event.type === "pointerup") follow(event);
      const { moved } = this.grip;
      this.grip = null;
      if (moved || !onPress) onRest();
      else onPress();
    };
    const endOfKeys = () => {
      if (this.keyed) onRest();
      this.keyed = false;
    };
    listen(this.node, {
      pointerdown: (event) => this.take(event),
      pointermove: follow,
      "pointerup pointercancel lostpointercapture": release,
      keydown: (event) => this.key(event),
      "keyup blur": endOfKeys,
    });
  }

  take(event) {
    if (!this.at || event.button > 0) return;
    event.preventDefault();
    // A ring of focus under the finger would look like a mark.
    this.node.focus(/** @type {any} */ ({ preventScroll: true, focusVisible: false }));
    // What had the focus comes to rest and is drawn, and this handle may be gone with it.
    if (!this.at) return;
    // A pointer that a script made cannot be captured; its moves arrive all the same.
    if (event.isTrusted) this.node.setPointerCapture(event.pointerId);
    this.grip = { id: event.pointerId, x: event.clientX, y: event.clientY, from: [...this.at], moved: false };
  }

  key(event) {
    if (!this.at) return;
    const step = STEPS[event.key];
    const size = this.nudge * (event.shiftKey ? LEAP : 1);
    if (this.onPress && (event.key === "Enter" || event.key === " ")) {
      this.onPress();
      event.preventDefault();
      return;
    }
    if (!step) return;
    this.move(this.at.map((value, c) => value + step[c] * size));
    this.keyed = true;
    event.preventDefault();
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
    const wanted = [x(at[0]), y(at[1])];
    const sides = [box.width, box.height];
    const [left, top] = [box.left, box.top].map((low, c) => within(wanted[c], low, low + sides[c]));
    node.classList.toggle("outside", Math.abs(left - wanted[0]) + Math.abs(top - wanted[1]) > 1);
    node.style.transform = `translate(${left}px, ${top}px)`;
  }

  describe() {
    if (!this.at) return;
    this.node.setAttribute("aria-valuenow", this.at[0].toFixed(3));
    this.node.setAttribute("aria-valuetext", `y1 ${readable(this.at[0])}, y2 ${readable(this.at[1])}`);
  }
}
