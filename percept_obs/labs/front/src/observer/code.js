// The few lines of Python that make the same run.

import { switchOf } from "../common/observer_list.js";

const NOISES = { uniform: "Uniform", gaussian: "Gaussian" };

/** Python text for settings that are shown. */
export function pythonOf(shown, model) {
  const { settings } = shown;
  const names = new Set(["PerspectiveSystem", "track"]);
  const lines = model.recordings[settings.scenario] ? [] : simulation(shown, names);
  const recorded = model.recordings[settings.scenario];
  const motion = recorded ? recorded.kind : "affine";
  names.add(motion);
  names.add(settings.surface);
  if (recorded) lines.push("# recording = the one that you gave to the lab", "");
  const outputs = settings.outputs.map((o) => `"${o}"`).join(", ");
  lines.push(`form = PerspectiveSystem(${motion}(), ${settings.surface}()).measure(${outputs})`);
  const options = [];
  const { mode, values } = settings.start;
  if (mode !== "own") options.push(`start=${list(mode === "zero" ? [0, 0, 0] : values)}`);
  if (settings.hold !== "zero") options.push(`hold="${settings.hold}"`);
  if (settings.believed) {
    lines.push(`believed = affine(${matrix(settings.believed.A)}, ${list(settings.believed.b)})`);
    options.push("believed=believed");
  }
  for (const name of settings.observers) {
    const { gains: known, ways } = model.observers[name];
    const way = switchOf(settings, name);
    const used = known.filter((gain) => ways[way].includes(gain.name));
    const changed = used.filter((gain) => settings.gains[name][gain.name] !== gain.value);
    const gains = (way === Object.keys(ways)[0] ? "" : `, switch="${way}"`) + changed.map((gain) => `, ${gain.name}=${number(settings.gains[name][gain.name])}`).join("");
    const result = settings.observers.length > 1 ? `run_${name}` : "run";
    lines.push(`${result} = track(${["recording", `${name}(form${gains})`, ...options].join(", ")})`);
    lines.push(`print(${result}.verdict())`);
  }
  const from = (place, wanted) => `from ${place} import ${[...wanted].sort().join(", ")}\n`;
  const imports = from("percept_obs", names) + from("percept_obs.observers", settings.observers);
  return `${imports}\n${lines.join("\n")}\n`;
}

function simulation({ settings, time, leavesAt }, names) {
  for (const name of ["affine", "Camera", "Scenario", "record", NOISES[settings.noise.kind]]) names.add(name);
  // As long as the point is seen, which may be shorter than what was asked for.
  const duration = leavesAt === null ? settings.duration : time.at(-1);
  const noise = `${NOISES[settings.noise.kind]}(${number(settings.noise.size)})`;
  const surface = settings.surface === "plane" ? `plane(${list(settings.normal)})` : `${settings.surface}()`;
  return [
    `motion = affine(${matrix(settings.A)}, ${list(settings.b)})`,
    `scenario = Scenario("from the lab", motion, ${list(settings.X0)}, ${number(duration)}, ${surface})`,
    `camera = Camera(period=${number(settings.period)}, noise=${noise}, dropout=${number(settings.dropout)})`,
    `recording = record(scenario, camera=camera, seed=${settings.seed})`,
  ];
}

function number(value) {
  return String(value);
}

function list(values) {
  return `[${values.map(number).join(", ")}]`;
}

function matrix(rows) {
  return `[${rows.map(list).join(", ")}]`;
}
