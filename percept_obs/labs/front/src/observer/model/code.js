// The few lines of Python that make the same run.

import { durationOf, imports, list, NOISES, trackings } from "../../common/model/code.js";
import { switchOf } from "../../common/model/settings.js";

export function pythonOf(shown, model) {
  const { settings } = shown;
  const names = new Set(["PerspectiveSystem", "track"]);
  const recorded = model.recordings[settings.scenario];
  const lines = recorded ? ["# recording = the one that you gave to the lab", ""] : simulation(shown, names);
  const motion = recorded ? recorded.kind : "affine";
  names.add(motion);
  names.add(settings.surface);
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
  const makerOf = (name) => {
    const way = switchOf(settings, name);
    return [name, way === Object.keys(model.observers[name].ways)[0] ? "" : `, switch="${way}"`];
  };
  lines.push(...trackings(settings, model, { makerOf, form: "form", options }));
  const wanted = { percept_obs: names, "percept_obs.observers": settings.observers };
  return `${imports(wanted)}\n${lines.join("\n")}\n`;
}

function simulation(shown, names) {
  const { settings } = shown;
  for (const name of ["affine", "Camera", "Scenario", "record", NOISES[settings.noise.kind]]) names.add(name);
  const noise = `${NOISES[settings.noise.kind]}(${settings.noise.size})`;
  const shape = { plane: list(settings.normal), unified: settings.xi }[settings.surface] ?? "";
  const surface = `${settings.surface}(${shape})`;
  return [
    `motion = affine(${matrix(settings.A)}, ${list(settings.b)})`,
    `scenario = Scenario("from the lab", motion, ${list(settings.X0)}, ${durationOf(shown)}, ${surface})`,
    `camera = Camera(period=${settings.period}, noise=${noise}, dropout=${settings.dropout})`,
    `recording = record(scenario, camera=camera, seed=${settings.seed})`,
  ];
}

function matrix(rows) {
  return list(rows.map(list));
}
