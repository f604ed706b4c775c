// The lab of structure and motion: what is known, what can therefore be estimated, and how the estimates converge.

import { Results } from "../common/model/results.js";
import { ImagePlane } from "../common/page/image_plane.js";
import { Live } from "../common/page/live.js";
import { open } from "../common/page/opening.js";
import { pythonOf } from "./model/code.js";
import { StructureEngine } from "./model/engine.js";
import { StructureKernels } from "./model/kernels.js";
import { PRESETS } from "./model/presets.js";
import { imagePlaneInWords, readingAt, reasons } from "./model/text.js";
import { ChoiceOfUnknowns } from "./page/choice.js";
import { StructureFormulas } from "./page/formula.js";
import { StructurePanel } from "./page/panel.js";
import { chartOf, chartsOf, LABELS } from "./page/pictures.js";
import { Scene } from "./page/scene.js";
import { SCHEMA } from "./schema.js";

export class StructureLab extends Live {
  constructor(widget, place) {
    super(widget, SCHEMA);
    this.kernels = new StructureKernels(this.model);
    this.results = new Results(this.kernels, () => new StructureEngine(this.model));
    const plane = new ImagePlane({
      name: "ybar",
      label: "Start of the point",
      tag: "start",
      placeOf: (shown) => shown.settings.ybar.slice(0, 2),
      inWords: imagePlaneInWords,
      onMove: (point) => this.moveStart(point),
      onRest: () => this.rest(),
    });
    this.planes = [plane, new Scene()];
    this.formulas = new StructureFormulas(this.model);
    this.panel = new StructurePanel(this);
    this.choice = new ChoiceOfUnknowns(this.model, this);
    this.head = this.choice.body;
    open(this, place, LABELS, PRESETS);
  }

  moveStart([y1, y2]) {
    if (Math.abs(y1) <= 1000 && Math.abs(y2) <= 1000) this.change({ ybar: [y1, y2, this.settings.ybar[2]] });
  }

  chosen() {
    return chartsOf(this.shown);
  }

  chartOf(name) {
    return chartOf(name, this.shown, this.ghost, this.theme);
  }

  speak() {
    this.choice.show(this.shown);
    super.speak();
  }

  reasons() {
    return reasons(this.shown, this.model);
  }

  readingAt(cursor) {
    return this.shown.refusal ? "" : readingAt(this.shown, cursor);
  }

  copy() {
    return pythonOf(this.shown, this.model);
  }
}
