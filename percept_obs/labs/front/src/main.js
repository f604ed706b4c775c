// The bundle's entrance: anywidget calls render() for each view of a lab.
//
// To add a lab: a folder beside observer/ with a class that extends Live (common/live.js) and says how settings become
// pictures and words; name it below, as its Python side names it in `kind`. Charts, controls, groups of controls, the
// layout, modules made from printed texts, and the line to Python are in common/ and know nothing of observers.

import { modelOf } from "./common/texts.js";
import { ObserverLab } from "./observer/lab.js";
import { PointsLab } from "./points/lab.js";
import { StructureLab } from "./structure/lab.js";

const LABS = { observer_lab: ObserverLab, points_lab: PointsLab, structure_lab: StructureLab };

export default {
  async render({ model, el }) {
    const place = document.createElement("div");
    el.append(place);
    let lab;
    try {
      lab = new LABS[model.get("kind")](model, place, await modelOf(model.get("texts"), model.get("model")));
    } catch (error) {
      place.textContent = `The lab could not be opened: ${error.message}`;
      throw error;
    }
    const known = (window.perceptObsLabs ??= new Set());
    known.add(lab);
    return () => {
      known.delete(lab);
      lab.close();
    };
  },
};
