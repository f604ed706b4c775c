// A finer map over two settings than the page fills: Python is asked for it part by part, and stops with the hand.

import { EACH_CELL, FINER, orderOf, rowAt } from "../model/cells.js";
import { element } from "./controls.js";
import { put } from "./put.js";

/** How many places are asked for: at first, at least and at most, and the milliseconds that an answer is to take. */
const [FIRST, LEAST, MOST] = [256, 64, 1024];
const SOON = 300;
const SIZE = `${FINER} × ${FINER}`;

export class FinerMap {
  /**
   * @param {any} lab
   * @param {import("../model/sweep.js").Sweep} sweep
   */
  constructor(lab, sweep) {
    this.lab = lab;
    this.sweep = sweep;
    /** @type {import("../model/sweep.js").Found | null} the map that is being filled */
    this.filling = null;
    /** @type {{serial: number, from: number, at: number} | null} what was asked for last: its number, its first place, when */
    this.asked = null;
    this.many = FIRST;
    this.button = element("button", { type: "button", class: "finer", hidden: true, onclick: () => (this.filling ? this.stop() : this.begin()) });
    this.button.dataset.control = "map finer";
    this.hear = () => this.take(lab.widget.get("map_found"));
  }

  /** How many places of a map Python has filled in. */
  done(found) {
    return found?.levels.find(({ cells }) => cells === FINER)?.done ?? 0;
  }

  begin() {
    const { lab, sweep: { found } } = this;
    if (!found) return;
    this.filling = found;
    this.many = FIRST;
    lab.widget.on("change:map_found", this.hear);
    this.ask(found);
  }

  /** Ask for nothing any more; what is there stays. */
  stop() {
    if (!this.filling) return;
    this.filling = this.asked = null;
    this.lab.widget.off("change:map_found", this.hear);
    this.send({});
    this.show();
  }

  send(asked) {
    this.lab.widget.set("map_asked", asked);
    this.lab.widget.save_changes();
  }

  /** @param {import("../model/sweep.js").Found} filling */
  ask(filling) {
    const { lab, many, sweep: { settings } } = this;
    const from = this.done(filling);
    const functions = lab.kernels.of(settings);
    const { plan: { across, up, observer } } = filling;
    const names = [...new Set([...across.moves, ...up.moves])];
    const order = orderOf(filling.plan, FINER);
    const count = Math.min(many, FINER ** 2 - from);
    const rows = Array.from({ length: count }, (_, k) => rowAt(order(from + k), names, filling, lab, functions));
    // The clock makes it a number that no page before this one has used.
    const serial = Math.max(Date.now(), (this.asked?.serial ?? 0) + 1);
    this.asked = { serial, from, at: performance.now() };
    this.send({ serial, settings: { ...settings, observers: [observer], kept: null }, names, rows });
    this.show();
  }

  /** Take an answer, if it is to the last question and about the map that is shown. */
  take({ serial, values, refusal }) {
    const { asked, filling, sweep } = this;
    if (!filling || !asked || serial !== asked.serial) return;
    if (refusal) {
      this.stop();
      this.lab.view.notice(`Python fills in no finer map: ${refusal.replace(/\.$/, "")}.`);
    } else if (sweep.found === filling && sweep.present) {
      const numbers = new Float64Array(values.buffer.slice(values.byteOffset, values.byteOffset + values.byteLength));
      const count = numbers.length / EACH_CELL;
      const faster = Math.min(Math.max(SOON / (performance.now() - asked.at), 0.25), 2);
      this.many = Math.round(Math.min(Math.max(count * faster, LEAST), MOST));
      sweep.add(filling, { cells: FINER, from: asked.from, values: numbers });
      if (this.filling && this.done(filling) < FINER ** 2) this.ask(filling);
      else this.stop();
    } else this.stop();
  }

  /** Offer it where the page has filled its own; leave a map that is no longer shown. */
  show() {
    const { button, filling, sweep } = this;
    if (filling && !(sweep.found === filling && sweep.present)) this.stop();
    const done = this.done(sweep.found) / FINER ** 2;
    button.hidden = !sweep.whole || done === 1;
    const share = `${Math.floor(100 * done)} %`;
    put(button, this.filling ? `${share} – stop` : "Finer map");
    button.title = this.filling ? `Python has filled in ${share} of ${SIZE} places; press to stop` : `Finer map, by Python: ${SIZE} places`;
    button.setAttribute("aria-label", this.filling ? `${share} – stop Python's map of ${SIZE}` : button.title);
  }
}
