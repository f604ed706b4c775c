// The few lines of Python that make the same run.

import { userDefined, durationOf, list, NOISES, script, trackings } from "../../ui/code.js";
import { switchOf } from "../../state/settings.js";
import { keyOf } from "./kernels.js";
import { isTyped } from "../../engine/typed.js";
import { seesSize, startWithSize } from "./size.js";

/** Text of the size that an estimate starts from. */
const SEEN = { zero: "0", chosen: "recording.outputs[0, 2]" };

/** The text; with the bound where the chart of errors is shown. */
export function pythonOf(shown, model, charts = ["error"]) {
  const { settings } = shown;
  const names = new Set(["PerspectiveSystem", "track"]);
  const recorded = model.recordings[settings.scenario];
  const own = userDefined(model.own, [settings.surface, ...settings.observers]);
  const sized = seesSize(settings);
  const plain = model.own[settings.surface]?.call ?? `${settings.surface}()`;
  const surface = sized ? `sized(${plain})` : plain;
  if (sized) names.add("sized");
  const lines = [
    ...own.lines,
    ...(recorded ? ["# recording = the one that you gave to the lab", ""] : simulation(shown, names, model)),
  ];
  const motion = recorded ? recorded.kind : "affine";
  names.add(motion);
  if (!model.own[settings.surface]) names.add(settings.surface);
  const form = model.forms[keyOf(settings)];
  const outputs = settings.outputs.map((o) => `"${o}"`).join(", ");
  lines.push(`form = PerspectiveSystem(${motion}(), ${surface}).${form.w ? "measure" : "partition"}(${outputs})`);
  const options = /** @type {string[]} */ ([]);
  const { mode, values } = settings.start;
  const asked = startWithSize(mode === "zero" ? [0, 0, 0] : values, sized ? [0, 0, [SEEN[mode]]] : []);
  if (mode !== "own") options.push(`start=${list(asked)}`);
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
  if (shown.bound && charts.includes("error")) {
    names.add("cramer_rao");
    lines.push(
      "bound = cramer_rao(recording, form)",
      'print(f"least relative error at the end: {bound.relative[-1]:.3g}")',
    );
  }
  const ours = settings.observers.filter((name) => !model.own[name]);
  const wanted = { percept_obs: names, "percept_obs.observers": ours, ...own.modules };
  return script(wanted, lines);
}

/** Lines that make the motion, and what the copied code has to be given. */
function motionOf({ A, b, motion, scenario }, { written, scenarios }) {
  if (scenarios[scenario]?.track)
    return [`# motion = that of the scenario ${JSON.stringify(scenario)} that you gave to the lab`];
  if (!isTyped({ motion })) return [`motion = affine(${matrix(A)}, ${list(b)})`];
  const { python } = written[motion];
  const numbers = Object.fromEntries([
    ...A.flatMap((row, i) => row.map((value, j) => [`a${i + 1}${j + 1}`, value])),
    ...b.map((value, i) => [`b${i + 1}`, value]),
  ]);
  const used = Object.keys(numbers).filter((name) =>
    Object.values(python).some((text) => new RegExp(`\\b${name}\\b`).test(text)),
  );
  const entry = (name) => python[name] ?? numbers[name];
  const rows = matrix(A.map((row, i) => row.map((_, j) => entry(`a${i + 1}${j + 1}`))));
  return [
    ...used.map((name) => `${name} = ${numbers[name]}`),
    `motion = affine(lambda t: ${rows}, lambda t: ${list(b.map((_, i) => entry(`b${i + 1}`)))})`,
  ];
}

function simulation(shown, names, model) {
  const { settings } = shown;
  for (const name of ["affine", "Camera", "Scenario", "record", NOISES[settings.noise.kind]]) names.add(name);
  const noise = `${NOISES[settings.noise.kind]}(${settings.noise.size})`;
  const shape = { plane: list(settings.normal), unified: settings.xi }[settings.surface];
  const own = model.own[settings.surface]?.call;
  const plain = own ?? `${settings.surface}(${shape ?? ""})`;
  const surface = seesSize(settings) ? `sized(${plain}, ${model.radius})` : plain;
  return [
    ...motionOf(settings, model),
    `scenario = Scenario("from the lab", motion, ${list(settings.X0)}, ${durationOf(shown)}, ${surface})`,
    `camera = Camera(period=${settings.period}, noise=${noise}, dropout=${settings.dropout})`,
    `recording = record(scenario, camera=camera, seed=${settings.seed})`,
  ];
}

function matrix(rows) {
  return list(rows.map(list));
}
