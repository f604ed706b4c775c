// Verdicts in words, which come from Python, so that both say the same.

import { settled } from "../engine/errors.js";
import { readable, short } from "../draw/scales.js";
import { filled } from "../state/texts.js";

/** Verdict on one observer, as Run.verdict() in Python. */
export function verdict(run, shown, model) {
  const { verdicts } = model;
  const say = (which, values) => filled(verdicts[which], values);
  const since = (time) => short(time - shown.time[0]);
  if (run.divergedAt !== null) return divergedInWords(since(run.divergedAt), model);
  const count = run.resets.length;
  let besides = count ? say(count === 1 ? "reset once" : "reset often", { count, time: since(run.resets[0]) }) : "";
  for (const which of new Set(run.gaps.map((gap) => gap[2]))) {
    const gaps = run.gaps.filter((gap) => gap[2] === which);
    const [begin, end] = gaps[0].slice(0, 2).map(since);
    besides += say(begin === end ? "short gap" : "gap", { begin, end, reason: run.gapReasons[which - 1] });
    if (gaps.length > 1) besides += say(gaps.length === 2 ? "one more gap" : "more gaps", { count: gaps.length - 1 });
  }
  const length = shown.time.at(-1) - shown.time[0];
  if (!shown.truth) return say("followed", { time: short(length) }) + besides;
  const never = run.gaps.length && run.error.every(Number.isNaN); // there was an estimate
  if (never) return say("not yet", { window: short(length), judged: shown.judged }) + besides;
  const judged = { judged: shown.judged, error: run.error.at(-1), tolerance: shown.tolerance };
  return settledInWords(judged, run.settling, length, model) + besides;
}

export function divergedInWords(time, { verdicts, remedy }) {
  return `${filled(verdicts.diverged, { time })}${verdicts.grew}; ${remedy}`;
}

/** Verdict on a relative error, with its last value; `settling` is infinite where it ends outside. */
export function settledInWords({ judged, error, tolerance }, settling, length, { verdicts, settledPart, farOff }) {
  const inside = settled(settling, length, settledPart) ? "converged" : "late";
  const outside = Number.isNaN(error) ? "none" : error === Infinity ? "behind" : "outside";
  return filled(verdicts[settling === Infinity ? outside : inside], {
    error_of: verdicts.relative,
    judged,
    error: error <= farOff ? percent(error) : `more than ${short(100 * farOff, 6)} %`,
    tolerance: percent(tolerance, 6),
    time: short(settling),
  });
}

/** A share in per cent. */
export function percent(share, digits = 3) {
  return `${short(100 * share, digits)} %`;
}

/** When the point was lost, if it was. */
export function leavingInWords({ leavesAt }) {
  if (leavesAt === null) return [];
  return [`The point passes behind the camera at ${readable(leavesAt)} s; the charts end there.`];
}

/** Numbers that Python is told: verdicts, final estimates, resets, and estimates at some times. */
export function summaryOf(shown, serial, model) {
  if (shown.problem) return { serial, problem: shown.problem };
  if (shown.refusal) return { serial, refusal: shown.refusal };
  const number = (value) => (Number.isFinite(value) ? value : null);
  const last = shown.time.length - 1;
  const probes = Array.from({ length: 9 }, (_, k) => Math.round((k / 8) * last));
  const row = (run, k) => Array.from(run.estimate.subarray(k * shown.width, (k + 1) * shown.width), number);
  const by = (value) => Object.fromEntries(shown.runs.map((run) => [run.name, value(run)]));
  return {
    serial,
    samples: shown.time.length,
    verdicts: by((run) => verdict(run, shown, model)),
    settling: by((run) => number(run.settling)),
    resets: by((run) => run.resets.length),
    final: by((run) => row(run, last)),
    probes: { samples: probes, estimates: by((run) => probes.map((k) => row(run, k))) },
  };
}
