// The few lines of Python that make the same run.

import { isZero } from "./kernels.js";

const MAKERS = {
  ideal: ["integral_sliding_mode", ""],
  layer: ["integral_sliding_mode", ', switch="hyperbolic tangent"'],
  sign: ["integral_sliding_mode", ', switch="sign"'],
};
const NOISES = { uniform: "Uniform", gaussian: "Gaussian" };
const VELOCITIES = ["v_c", "v_p"].flatMap((which) => [1, 2, 3].map((axis) => `${which}${axis}`));

/** Python text for settings that are shown. */
export function pythonOf(shown, model) {
  const { settings, time, leavesAt, refusal } = shown;
  const { unknown, earlier, ybar, scale, noise, period } = settings;
  const zero = VELOCITIES.filter((name) => isZero(settings, name) && !unknown.includes(name));
  const options = [
    `(${unknown.map((name) => `"${name}"`).join(", ")}${unknown.length === 1 ? "," : ""})`,
    ...(zero.length ? [`zero=(${zero.map((name) => `"${name}",`).join(" ")})`] : []),
    ...(earlier && !unknown.includes("d_s") ? ['earlier=("d_s",)'] : []),
  ];
  if (refusal) return `from percept_obs import StructureAndMotion\n\nStructureAndMotion(${options.join(", ")})  # is refused\n`;
  const swings = settings.rate !== 0 && [...settings.v_c_swing, ...settings.v_p_swing].some(Boolean);
  // As long as the point is seen, which may be shorter than what was asked for.
  const duration = leavesAt === null ? settings.duration : time.at(-1);
  const make = NOISES[noise.kind];
  const lines = [
    ...(swings ? motionThatSwings(settings, model.phases) : [`motion = rigid(${list(settings.w)}, ${constant(settings, "v_c", model)}, ${constant(settings, "v_p", model)})`]),
    `depth = 1 / (${scale} * ${ybar[2]})`,
    `position = (${ybar[0]} * depth, ${ybar[1]} * depth, depth)`,
    `choice = StructureAndMotion(${options.join(", ")})`,
    `setup = StructureScenario(Scenario("from the lab", motion, position, ${duration}, pinhole()), ${scale}, choice)`,
    `camera = Camera(${period}, ${make}(${noise.size}))`,
    `depths = GivenDepth(${make}(${noise.depth}), bias=${settings.bias}, drift=${settings.drift})`,
    `recording = record_structure(setup, camera=camera, depth=depths, seed=${settings.seed})`,
  ];
  const start = settings.start === "zero" ? ', {"y1": 0.0, "y2": 0.0, "ybar3": 0.0}' : "";
  const makers = new Set();
  for (const name of settings.observers) {
    const [maker, way] = MAKERS[name] ?? [name, ""];
    makers.add(maker);
    const changed = model.observers[name].gains.filter((gain) => settings.gains[name][gain.name] !== gain.value);
    const gains = changed.map((gain) => `, ${gain.name}=${settings.gains[name][gain.name]}`).join("");
    const result = settings.observers.length > 1 ? `run_${name}` : "run";
    lines.push(`${result} = track(recording, ${maker}(choice.form${way}${gains})${start}, hold="${settings.hold}", step=${settings.step})`);
    lines.push(`print(${result}.verdict(${settings.tolerance}))`);
  }
  const names = ["Camera", make, "Scenario", "StructureAndMotion", "pinhole", "record_structure", "rigid", "track"].sort();
  return [
    ...(swings ? ["import math", ""] : []),
    `from percept_obs import ${names.join(", ")}`,
    `from percept_obs.observers import ${[...makers].sort().join(", ")}`,
    "from percept_obs.structure import GivenDepth, StructureScenario",
    "",
    ...lines,
    "",
  ].join("\n");
}

function list(values) {
  return `[${values.join(", ")}]`;
}

/** Velocities at time 0, which are those at all times. */
function constant(settings, which, { phases }) {
  return list(settings[which].map((value, k) => value + settings[`${which}_swing`][k] * Math.sin(phases[which][k])));
}

function motionThatSwings(settings, phases) {
  const component = (which) => (value, k) => {
    const swing = settings[`${which}_swing`][k];
    return `${value} + ${swing} * math.sin(${settings.rate} * t + ${phases[which][k]})`;
  };
  const velocity = (which) => `lambda t: [${settings[which].map(component(which)).join(", ")}]`;
  return [
    `v_c = ${velocity("v_c")}`,
    `v_p = ${velocity("v_p")}`,
    `motion = rigid(lambda t: ${list(settings.w)}, v_c, v_p)`,
  ];
}
