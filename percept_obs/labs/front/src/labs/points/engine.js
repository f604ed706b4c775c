// The whole of a run: points in motion, camera, observer, and what is read off them.

import { settlingTime } from "../../engine/errors.js";
import { Memory } from "../../engine/memory.js";
import { differences, windowIn } from "../../engine/tables.js";
import { Camera } from "./camera.js";
import { inversesOf } from "./flow.js";
import { windowsOf } from "./gramian.js";
import { absencesOf, decayRate, distancesOf, largestOf, norms } from "./measures.js";
import { Observer } from "./observer.js";

export class PointsEngine {
  constructor(model) {
    this.model = model;
    this.memory = new Memory();
    this.camera = new Camera(model, this.memory);
    this.observer = new Observer(this.camera);
  }

  /** @returns {import("../../types.js").PointsResult} what is shown of settings: whole, or as far as is drawn */
  run(settings, functions, whole = true) {
    const scene = this.scene(settings, functions);
    const { points, n, layout } = scene;
    const recording = this.camera.record(scene);
    const { estimate, divergedAt } = this.observer.track(scene, recording);
    const { time, truth, outputs } = recording;
    const off = truth.map((value, i) => value - estimate[i]);
    const size = norms(off, n);
    const [errors, distances] = [off, truth].map((rows) => distancesOf(layout, rows, n));
    const relative = errors.map((values, p) => values.map((value, k) => value / distances[p][k]));
    const worst = largestOf(relative);
    const result = {
      ...{ settings, points, n, names: layout.names, ...recording, estimate, divergedAt, size },
      estimated: this.camera.project(scene, estimate),
      errors,
      ...{ relative, worst, settling: settlingTime(time, (k) => worst[k], this.model.tolerance) },
      tolerance: this.model.tolerance,
      fit: decayRate(time, size),
      absences: Array.from({ length: points }, (_, k) => absencesOf(time, outputs, points, k)),
      gramian: null,
      whole: false,
    };
    return whole ? this.completed(result, functions) : result;
  }

  /** A result with all that is read off it. */
  completed(result, functions) {
    return { ...result, gramian: this.gramian(result, functions), whole: true };
  }

  /** Gramian of each window. */
  gramian(result, functions, longest = result.settings.window) {
    const { settings, time, seenImages: images } = result;
    const window = windowIn(time, longest);
    const { model, memory } = this;
    const known = { ...this.scene(settings, functions), ...this.flows(result, functions) };
    return windowsOf({ ...known, model, time, images, window, memory });
  }

  /** Flow of each kind of vector from time 0 to each sample, and the inverses of its Phi. */
  flows({ settings, time }, functions) {
    const divide = () => ({ grid: time, steps: differences(time), wanted: Int32Array.from(time, (_, k) => k) });
    const clock = this.memory.once("samples' steps", settings, divide, time);
    const scene = this.scene(settings, functions);
    const { kindOf, flows, made } = this.camera.flows(scene, "gramian", clock, clock.wanted);
    made.back ??= flows.map(inversesOf);
    return { kindOf, flows, back: made.back };
  }

  scene(settings, functions) {
    const points = settings.points.length;
    const { layouts, width } = this.model.states[settings.state];
    const layout = layouts[points - 1];
    return { settings, functions, layout, points, n: layout.names.length, width };
  }
}
