// A chart as the handle of its time: one drags on it.

import { within } from "../engine/between.js";
import { element, listen } from "../draw/dom.js";

/** Let a hand drag over a view between its margins; `onPart` takes the part of the way, from 0 to 1. */
export function scrubbed(view, { left: before, right: after }, onPart) {
  const pad = element("div", { class: "scrub", "aria-hidden": "true" });
  let down = false;
  const take = (event) => {
    const { left } = view.figure.getBoundingClientRect();
    onPart(within((event.clientX - left - before) / (view.width - before - after), 0, 1));
  };
  listen(pad, {
    pointerdown: (event) => {
      down = true;
      if (event.isTrusted) pad.setPointerCapture(event.pointerId);
      take(event);
    },
    pointermove: (event) => down && take(event),
    "pointerup pointercancel lostpointercapture": () => (down = false),
  });
  view.figure.append(pad);
}
