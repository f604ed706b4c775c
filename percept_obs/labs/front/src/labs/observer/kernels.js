// The functions that settings need: of the point, the surface, the form, the observers.

import { PrintedKernels } from "../../engine/kernels.js";
import { switchOf } from "../../state/settings.js";
import { typedModule } from "../../engine/typed.js";
import { noBound } from "./bound.js";
import { varies } from "./camera.js";

/** Name of a form: what is seen, and what of it is measured; as in texts.py. */
export function keyOf({ surface, outputs }) {
  return `${surface} ${outputs.join("+")}`;
}

export class Kernels extends PrintedKernels {
  /** The observers that do not exist for these settings' form or recording, with the reasons. */
  refused(settings) {
    const { forms, recordings } = this.model;
    const moving = varies(settings, this.model) && !recordings[settings.scenario] ? this.model.varies : {};
    return { ...forms[keyOf(settings)]?.refused, ...recordings[settings.scenario]?.refused, ...moving };
  }

  needed(settings) {
    const key = keyOf(settings);
    const { project, ray, foe, flow } = this.model.surfaces[settings.surface];
    const { w, circle, refused, observers } = this.model.forms[key];
    const loops = settings.observers
      .filter((name) => !refused[name])
      .map((name) => {
        const way = switchOf(settings, name);
        return this.loop([key, name, way].filter(Boolean).join(" "), name, observers[name][way]);
      });
    return [
      { key: "point", texts: { rates: this.model.rates, plant: this.model.plant } },
      ...typedModule(this.model, settings.motion),
      { key: settings.surface, texts: { project, ray, foe } },
      { key, texts: { ...(w && { w }), ...(circle && { circle }) } },
      ...(noBound(settings, this.model) ? [] : [{ key: `flow on ${settings.surface}`, texts: { flow } }]),
      ...loops,
    ];
  }
}
