// The bundle's entrance: anywidget calls render() for each view of a lab.

import { ObserverLab } from "./lab.js";

const LABS = { observer_lab: ObserverLab };

export default {
  render({ model, el }) {
    const place = document.createElement("div");
    el.append(place);
    let lab;
    try {
      lab = new LABS[model.get("kind")](model, place);
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
