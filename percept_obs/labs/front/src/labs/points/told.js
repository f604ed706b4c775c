// What the first screen of many points tells over time: its chart, and the sliders below.

import { range } from "../../ui/controls.js";
import { between, within } from "../../engine/between.js";
import { keptLine } from "../../draw/lines.js";
import { foundAfter, meanErrorOf } from "./sentences.js";

/** The error of the body, or of the one mark that is hidden for a while. */
export function chartOf(_screen, scene) {
  const { shown, ghost, theme, secret, now, kept } = scene;
  const { time, absences } = shown;
  const since = foundAfter(shown);
  const hidden = absences.flatMap((spans, k) => (spans.length ? [k] : []));
  const which = hidden.length === 1 ? hidden[0] : -1;
  const valuesOf = (result) => (which < 0 ? meanErrorOf(result) : result.errors[which]);
  const [off, colour] = [valuesOf(shown), theme.lines[0]];
  const text = which < 0 ? "estimate's error" : `error of mark ${which + 1}`;
  const told = since > 0 && (secret ? time[0] + since <= now : Number.isFinite(since));
  const found = { time: time[0] + since, text: `found ${(time[0] + since).toFixed(1)} s`, colour };
  const bars = absences.map((spans) => spans.map(({ begin, end }) => [begin, end]));
  return {
    scale: { low: 0, high: 1.3 * within(Math.max(...off.filter(Number.isFinite), 0), 0.5, 20) },
    unit: "m",
    lines: [
      ...(ghost ? [keptLine(kept, ghost.time, valuesOf(ghost), theme)] : []),
      { id: "estimate", text, time, values: off, colour, width: 3, secret },
    ],
    bars: hidden.length ? { text: "seen", rows: bars } : null,
    found: told ? [{ ...found, value: off[between(time, found.time).sample] }] : [],
  };
}

/** The sliders below: the gain, which is 1 over P, and the camera's speed on its way round the body. */
export function controlsOf(lab) {
  const change = (changes) => {
    lab.screen.touch();
    lab.screen.renew();
    lab.change(changes);
  };
  const rest = () => lab.rest();
  const inWords = (speed) => `${speed.toFixed(1)} m/s`;
  const flies = () => lab.settings.motion !== "" && lab.settings.motion === lab.model.drive.motion;
  return [
    range({
      ...{ name: "gain", label: "Gain", low: 0.05, high: 10, log: true, rest },
      get: () => (lab.settings.weight === "constant" ? Number((1 / lab.settings.size).toPrecision(2)) : null),
      set: (gain) => change({ size: Number((1 / gain).toPrecision(6)) }),
    }),
    range({
      ...{ name: "travel", label: "Camera travels", low: 0, high: 8, step: 0.1, rest, text: inWords },
      get: () => (flies() ? Math.abs(lab.settings.camera_velocity[0]) : null),
      set: (speed) => change({ camera_velocity: [speed, 0, 0] }),
    }),
  ];
}
