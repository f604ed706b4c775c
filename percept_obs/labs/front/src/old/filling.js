// @ts-check
// Maps over two settings, filled cell by cell: the latest that was asked for, in a worker, or in the page in slices.

import { planOf, valueIn } from "./axes.js";
import { EACH_CELL, fillCell, orderOf, settingsAt, THEN } from "./cells.js";
import { answering } from "../engine/serving.js";

/** Milliseconds between two parts of a map that are told. */
const BETWEEN_PARTS = 90;
/** Milliseconds after a first picture in which a hand that moves may ask for the next map: nothing finer is begun. */
const REST = 40;

/**
 * @typedef {{model: any, kernels: any, engine: any, runs: any, axesOf: any}} Lab
 *   `engine` keeps of a run what a cell holds, and that of `runs` all of it
 * @typedef {{id: number, settings: any, base: any, first: number}} Task  `first` is how many cells a side the first
 *   picture has
 * @typedef {{id: number, cells: number, from: number, values: Float64Array, cost: number}} Part
 *   Numbers of cells of a map with so many cells a side, and the milliseconds that one took.
 */

export class Filling {
  /**
   * @param {Lab} lab
   * @param {(part: Part) => void} tell
   * @param {{slice: number, pause: () => Promise<any>}} manners  milliseconds at a time, and what lets others have
   *   their turn
   */
  constructor(lab, tell, { slice, pause }) {
    this.lab = lab;
    this.tell = tell;
    this.slice = slice;
    this.pause = pause;
    /** @type {Task | null} */
    this.next = null;
    this.busy = this.stopped = false;
  }

  /** Begin nothing any more, and leave what is under way. */
  stop() {
    this.stopped = true;
    this.next = null;
  }

  /** Fill the map of a task, and leave the one before as soon as that has a first picture. */
  async take(task) {
    this.next = task;
    if (this.busy) return;
    this.busy = true;
    try {
      while (this.next) {
        const now = this.next;
        this.next = null;
        await this.fill(now);
      }
    } finally {
      this.busy = false;
    }
  }

  /** Follow one run, with its error at every sample. */
  async follow({ key, follow: settings }) {
    const { kernels, runs } = this.lab;
    await kernels.prepare(settings);
    const result = runs.run(settings, kernels.of(settings), false);
    const [time, errors] = [result.time ?? [], result.runs?.[0]?.error ?? []];
    return { key, time, errors };
  }

  async fill({ id, settings, base, first }) {
    const { model, kernels, axesOf } = this.lab;
    await kernels.prepare(base);
    const functions = kernels.of(base);
    const plan = planOf(settings, model, axesOf, functions);
    let [began, since] = [performance.now(), performance.now()];
    for (const cells of [first, ...THEN]) {
      const order = orderOf(plan, cells);
      const values = new Float64Array(EACH_CELL * cells * cells);
      let from = 0;
      let spent = 0;
      for (let k = 0; k < cells * cells; k++) {
        const before = performance.now();
        const [i, j] = order(k);
        const place = [valueIn(plan.across, i, cells), valueIn(plan.up, j, cells)];
        fillCell(values, EACH_CELL * k, settingsAt(base, plan, place, functions), this.lab, functions);
        const now = performance.now();
        spent += now - before;
        const whole = k + 1 === cells * cells;
        if (whole || (cells > first && now - since > BETWEEN_PARTS)) {
          const part = values.slice(EACH_CELL * from, EACH_CELL * (k + 1));
          this.tell({ id, cells, from, values: part, cost: spent / (k + 1) });
          [from, since] = [k + 1, now];
        }
        if (now - began < this.slice && !whole) continue;
        await (whole && cells === first ? new Promise((resolve) => setTimeout(resolve, REST)) : this.pause());
        if (this.stopped || (this.next && (cells > first || whole))) return;
        began = performance.now();
      }
    }
  }
}

/** Let what has come meanwhile be heard. */
export function breath() {
  const { port1, port2 } = new MessageChannel();
  return new Promise((resolve) => {
    port1.onmessage = () => {
      port1.close();
      resolve(undefined);
    };
    port2.postMessage(null);
  });
}

/** Fill maps in a worker; each message after the first has a task. */
export function serveMaps(computing, scope) {
  answering(computing, scope, (model, { Kernels, Engine, CellEngine, axesOf }) => {
    const lab = { model, axesOf, kernels: new Kernels(model), engine: new CellEngine(model), runs: new Engine(model) };
    const tell = (part) => scope.postMessage(part, [part.values.buffer]);
    const filling = new Filling(lab, tell, { slice: 12, pause: breath });
    return async (task) => ("follow" in task ? scope.postMessage(await filling.follow(task)) : filling.take(task));
  });
}
