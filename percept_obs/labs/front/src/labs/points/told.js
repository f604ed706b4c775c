// What the first screen of many points tells: its sentence, its chart, and the sliders below.

import { range } from "../../ui/controls.js";
import { derived } from "../../engine/derived.js";
import { between, within } from "../../engine/between.js";
import { keptLine } from "../../draw/lines.js";
import { meanError } from "./questions.js";

/** What is seen, in one sentence. */
export function sentenceOf(scene, seen, moved) {
  const { shown, now, end, why } = scene;
  const { settling, divergedAt, settings, time } = shown;
  const off = `${seen.off.toFixed(1)} m`;
  if (seen.prelude) return "One picture shows directions only: near and small, or far and large, looks the same.";
  const still = settings.input === 0 && settings.camera_velocity.every((value) => value === 0);
  if (why) {
    if (still) return "Three bodies, one picture: without a travel of the camera they go on looking alike.";
    return "Three bodies, one picture. The camera's travel shifts the near one most: that tells them apart.";
  }
  if (divergedAt !== null) return `The estimate left every bound after ${divergedAt.toFixed(1)} s.`;
  const away = seen.hidden.flatMap((hidden, k) => (hidden ? [k + 1] : []));
  if (away.length === seen.hidden.length) return "No mark is seen: nothing pulls the estimate.";
  if (seen.copy && now >= end) return `Still ${off} off. The dashed copy makes the same pictures: drag it.`;
  const found = Number.isFinite(settling) && settling <= now - time[0];
  if (found && now >= end && !moved) return "Found. Now press a mark to hide it, or drag it.";
  if (away.length) return `Mark ${away.join(" and ")} hidden: no ray pulls there, and what is seen carries the rest.`;
  if (found) return `Found: the estimate is in the body, ${off} off.`;
  if (now >= end) return `Not found in ${end.toFixed(0)} s: the estimate is ${off} off.`;
  if (now - time[0] < 0.2 * (end - time[0])) return "The estimate, in blue: each mark is pulled across to its ray.";
  if (still) return "The camera does not travel: it sees the body from one spot, and nothing tells how far it is.";
  return "The camera travels, so the rays turn and pull anew: the estimate slides along them.";
}

/** The error of the body, or of the one mark that is hidden for a while. */
export function chartOf(scene) {
  const { shown, ghost, theme, secret, now, kept } = scene;
  const { time, absences, settling } = shown;
  const hidden = absences.flatMap((spans, k) => (spans.length ? [k] : []));
  const which = hidden.length === 1 ? hidden[0] : -1;
  const valuesOf = (result) => (which < 0 ? meanErrorOf(result) : result.errors[which]);
  const [off, colour] = [valuesOf(shown), theme.lines[0]];
  const text = which < 0 ? "estimate's error" : `error of mark ${which + 1}`;
  const told = settling > 0 && (secret ? time[0] + settling <= now : Number.isFinite(settling));
  const found = { time: time[0] + settling, text: `found ${(time[0] + settling).toFixed(1)} s`, colour };
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
      ...{ name: "travel", label: "Camera travels", low: 0, high: 5, step: 0.1, rest, text: inWords },
      get: () => (flies() ? Math.abs(lab.settings.camera_velocity[0]) : null),
      set: (speed) => change({ camera_velocity: [speed, 0, 0] }),
    }),
  ];
}

/** The mean error of the points at each sample, in metres. */
export function meanErrorOf(result) {
  return derived(result.estimate, "mean error", () => meanError(result));
}
