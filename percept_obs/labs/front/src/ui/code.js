// Python code of a run: the parts that all labs share.

import { switchOf } from "../state/settings.js";

export const NOISES = { uniform: "Uniform", gaussian: "Gaussian" };

export function list(values) {
  return `[${values.join(", ")}]`;
}

/** Lines of imports: names by the module that has them; nothing of a module that none is wanted of. */
function imports(wanted) {
  const lines = Object.entries(wanted).map(([place, names]) => [place, [...names].sort().join(", ")]);
  return lines.filter(([, names]) => names).map(([place, names]) => `from ${place} import ${names}\n`).join("");
}

/** The text of lines of Python, with imports of what is wanted and of what their text shows that they need. */
export function script(wanted, lines) {
  const text = lines.join("\n");
  const modules = [["math.", "import math"], ["np.", "import numpy as np"]].filter(([sign]) => text.includes(sign));
  return `${modules.map(([, line]) => `${line}\n\n`).join("")}${imports(wanted)}\n${text}\n`;
}

/** Duration until the point leaves, which may be shorter than the one of the settings. */
export function durationOf({ settings, time, leavesAt }) {
  return leavesAt === null ? settings.duration : time.at(-1);
}

/** Imports of the user's observers and surfaces, and a comment for each that cannot be imported. */
export function userDefined(own, names) {
  const used = names.map((name) => own?.[name]).filter(Boolean);
  const modules = {};
  for (const { module, name } of used) if (module) (modules[module] ??= []).push(name);
  const lines = used
    .filter(({ module }) => !module)
    .map(({ name }) => `# ${name} = the one that you gave to the lab`);
  return { modules, lines };
}

/** Lines in which each observer follows and says what happened; its maker comes with what it is told of its switch. */
export function trackings(settings, { observers, own }, { makerOf, form, options, tolerance = "" }) {
  return settings.observers.flatMap((name) => {
    const { gains, ways } = observers[name];
    const [maker, way] = makerOf(name);
    const used = gains.filter((gain) => ways[switchOf(settings, name)].includes(gain.name));
    const changed = used.filter((gain) => settings.gains[name][gain.name] !== gain.value);
    const values = changed.map((gain) => `${gain.name}=${settings.gains[name][gain.name]}`);
    const given = values.map((value) => `, ${value}`).join("");
    const made = own?.[name]
      ? own[name].call.replace("(form)", `(${form}${way})`) + (values.length ? `.with_gains(${values.join(", ")})` : "")
      : `${maker}(${form}${way}${given})`;
    const result = settings.observers.length > 1 ? `run_${name}` : "run";
    const call = ["recording", made, ...options].join(", ");
    return [`${result} = track(${call})`, `print(${result}.verdict(${tolerance}))`];
  });
}
