// A time chart under the hand: a click puts the time, a drag shows the part that it marks, the wheel zooms, twice shows all.

import { element } from "./controls.js";

/** Pixels from which on a drag is meant. */
const MEANT = 6;

export function zoomable(lab, chart, player) {
  const { canvas, figure } = chart;
  const part = element("div", { class: "part", hidden: true });
  figure.append(part);
  /** @type {{x: number, time: number} | null} */
  let grip = null;

  const cover = (one, other) => {
    const [left, right] = [one, other].map((time) => chart.place.x(time)).sort((a, b) => a - b);
    part.style.transform = `translateX(${left}px)`;
    part.style.width = `${right - left}px`;
  };
  const letGo = () => {
    grip = null;
    part.hidden = true;
  };

  canvas.addEventListener("pointerdown", (event) => {
    const time = chart.timeAt(event.clientX);
    if (time === null || event.button > 0) return;
    grip = { x: event.clientX, time };
    if (event.isTrusted) canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!grip) {
      if (!player.playing) lab.peek(chart.timeAt(event.clientX));
      return;
    }
    if (part.hidden && Math.abs(event.clientX - grip.x) < MEANT) return;
    part.hidden = false;
    cover(grip.time, chart.nearest(event.clientX));
  });
  canvas.addEventListener("pointerup", (event) => {
    if (!grip) return;
    const { time } = grip;
    if (part.hidden) player.put(time);
    else lab.zoom((timeline) => timeline.select({ low: time, high: chart.nearest(event.clientX) }));
    letGo();
  });
  canvas.addEventListener("pointercancel", letGo);
  canvas.addEventListener("pointerleave", () => lab.peek(null));
  canvas.addEventListener("dblclick", () => lab.zoom((timeline) => timeline.select(timeline.whole)));
  canvas.addEventListener("wheel", (event) => {
    // Without the focus in this part of the lab the wheel belongs to the page that is read.
    const meant = event.ctrlKey || player.body.contains(document.activeElement);
    const about = chart.timeAt(event.clientX);
    if (!meant || about === null) return;
    event.preventDefault();
    lab.zoom((timeline) => timeline.zoom(Math.exp(0.002 * event.deltaY), about));
  }, { passive: false });
}
