// The bundle's entrance: anywidget calls render() for each view of a lab.
//
// To add a lab: a folder beside observer/ with an engine that makes results of settings (types.js says of what) and a
// class that extends Lab (ui/lab.js), with a screen that draws them; name it below as its Python side does in `kind`.
// state/ and engine/ compute and know nothing of the page, draw/ makes pictures, ui/ the page; labs/ know all of them.

import { serve } from "./engine/serving.js";
import { modelOf } from "./state/texts.js";
import { element } from "./draw/dom.js";
import { COLOURS } from "./draw/looks.js";
import deskStyle from "./labs/desk/style.css";
import style from "./ui/style.css";
import { DeskLab } from "./labs/desk/lab.js";
import { ObserverLab } from "./labs/observer/lab.js";
import { PointsLab } from "./labs/points/lab.js";
import { StructureLab } from "./labs/structure/lab.js";

const LABS = { desk_lab: DeskLab, observer_lab: ObserverLab, points_lab: PointsLab, structure_lab: StructureLab };

// A worker is made of this bundle as well, and computes what a page draws.
if (typeof document === "undefined" && typeof self !== "undefined")
  serve((kind) => LABS[kind].computing, self);

export default {
  async render({ model, el }) {
    const place = element("div", {}, element("style", {}, style, deskStyle, COLOURS));
    el.append(place);
    let lab;
    try {
      lab = new LABS[model.get("kind")](model, place, await modelOf(model.get("texts"), model.get("model")));
    } catch (error) {
      place.textContent = `The lab could not be opened: ${error.message}`;
      throw error;
    }
    const known = (/** @type {any} */ (window).perceptObsLabs ??= new Set());
    known.add(lab);
    return () => {
      known.delete(lab);
      lab.close();
    };
  },
};
