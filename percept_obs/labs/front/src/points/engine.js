// The whole of a run: points in motion, camera, observer, and what is read off them.

import { lazily, Memory } from "../common/memory.js";
import { column, differences } from "../common/tables.js";
import { Camera } from "./camera.js";
import { inversesOf } from "./flow.js";
import { windowsOf } from "./gramian.js";
import { decayRate, norms, pointErrors, spansOf } from "./measures.js";
import { Observer } from "./observer.js";

/** Runs settings. */
export class Engine {
  constructor(model) {
    this.model = model;
    this.memory = new Memory();
    this.camera = new Camera(model, this.memory);
    this.observer = new Observer(model, this.memory, this.camera);
  }

  /** Everything that is shown for these settings; functions are the state's coefficients and a point's place. */
  run(settings, functions) {
    const points = settings.points.length;
    const { layouts, width } = this.model.states[settings.state];
    const layout = layouts[points - 1];
    const n = layout.names.length;
    const scene = { settings, functions, layout, points, n, width };
    const recording = this.camera.record(scene);
    const { estimate, divergedAt } = this.observer.track(scene, recording);
    const estimated = this.camera.project(scene, estimate, "estimated");
    const { time, truth, depths, outputs } = recording;
    const room = (part, length) => this.memory.room(part, length);
    const size = norms(truth, estimate, n, room("size", time.length));
    const depthOf = (rows, part) => (k) => column(rows, points, k, (length) => room(`${part} ${k}`, length));
    const shown = {
      ...{ settings, points, n, names: layout.names, ...recording, estimate, divergedAt, estimated, size },
      errors: pointErrors(layout, truth, estimate, n, room),
      trueDepth: depthOf(depths, "true depth"),
      depth: depthOf(estimated.depths, "depth"),
      fit: decayRate(time, size),
      absences: Array.from({ length: points }, (_, k) => spansOf(time, outputs, points, k)),
    };
    lazily(shown, "gramian", () => this.gramian(scene, recording));
    return shown;
  }

  /** What the images of each window tell. */
  gramian(scene, { time, clockKey, seenImages }) {
    const { memory, model } = this;
    const clock = memory.once("samples' steps", [clockKey], () => ({
      grid: time,
      steps: differences(time),
      wanted: Int32Array.from(time, (_, k) => k),
    }));
    const { kindOf, flows, made } = this.camera.flows(scene, "gramian", clockKey, clock, clock.wanted);
    made.back ??= flows.map(inversesOf);
    const window = Math.min(scene.settings.window, time.at(-1));
    return windowsOf({ ...scene, model, time, images: seenImages, kindOf, flows, back: made.back, window, memory });
  }
}
