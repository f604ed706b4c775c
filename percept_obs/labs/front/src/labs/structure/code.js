// The few lines of Python that make the same run.

import { userDefined, durationOf, list, NOISES, script, trackings } from "../../ui/code.js";
import { isTyped } from "../../engine/typed.js";
import { isSampled, varies } from "./camera.js";
import { isZero } from "./kernels.js";

const MAKERS = {
  ideal: ["integral_sliding_mode", ""],
  layer: ["integral_sliding_mode", ', switch="hyperbolic tangent"'],
  sign: ["integral_sliding_mode", ', switch="sign"'],
};
const VELOCITIES = ["v_c", "v_p"].flatMap((which) => [1, 2, 3].map((axis) => `${which}${axis}`));

export function pythonOf(shown, model) {
  const { settings, refusal } = shown;
  const { unknown, earlier, ybar, scale, noise, period } = settings;
  const zero = VELOCITIES.filter((name) => isZero(settings, name, model) && !unknown.includes(name));
  const options = [
    `(${unknown.map((name) => `"${name}"`).join(", ")}${unknown.length === 1 ? "," : ""})`,
    ...(zero.length ? [`zero=(${zero.map((name) => `"${name}",`).join(" ")})`] : []),
    ...(earlier && !unknown.includes("d_s") ? ['earlier=("d_s",)'] : []),
  ];
  if (refusal)
    return `from percept_obs import StructureAndMotion\n\nStructureAndMotion(${options.join(", ")})  # is refused\n`;
  const own = userDefined(model.own, settings.observers);
  const make = NOISES[noise.kind];
  const lines = [
    ...own.lines,
    ...motionIn(settings, model),
    `depth = 1 / (${scale} * ${ybar[2]})`,
    `position = (${ybar[0]} * depth, ${ybar[1]} * depth, depth)`,
    `choice = StructureAndMotion(${options.join(", ")})`,
    `where = ("from the lab", motion, position, ${durationOf(shown)}, pinhole())`,
    `scenario = StructureScenario(*where, scale=${scale}, choice=choice)`,
    `depths = GivenDepth(${make}(${noise.depth}), bias=${settings.bias}, drift=${settings.drift})`,
    `camera = ScaledDepthCamera(${period}, ${make}(${noise.size}), depth=depths)`,
    `recording = record(scenario, camera=camera, seed=${settings.seed})`,
  ];
  const start = settings.start === "zero" ? ['{"y1": 0.0, "y2": 0.0, "ybar3": 0.0}'] : [];
  const makerOf = (name) => MAKERS[name] ?? [name, ""];
  const how = [...start, `hold="${settings.hold}"`, `step=${settings.step}`];
  lines.push(
    ...trackings(settings, model, { makerOf, form: "choice.form", options: how, tolerance: settings.tolerance }),
  );
  const wanted = {
    percept_obs: [make, "StructureAndMotion", "pinhole", "record", "track", ...(isSampled(settings) ? [] : ["rigid"])],
    "percept_obs.observers": new Set(
      settings.observers.filter((name) => !model.own[name]).map((name) => makerOf(name)[0]),
    ),
    ...own.modules,
    "percept_obs.structure": ["GivenDepth", "ScaledDepthCamera", "StructureScenario"],
  };
  return script(wanted, lines);
}

function motionIn(settings, model) {
  if (isSampled(settings)) return ["# motion = rigid(...), the velocities that you gave to the lab"];
  if (isTyped(settings)) return motionThatIsTyped(settings, model);
  if (varies(settings)) return motionThatSwings(settings, model.phases);
  // A swing whose rate is 0 stays where it begins.
  const start = (which, value, k) => value + settings[`${which}_swing`][k] * Math.sin(model.phases[which][k]);
  const [v_c, v_p] = ["v_c", "v_p"].map((which) => list(settings[which].map((value, k) => start(which, value, k))));
  return rigidOf(list(settings.w_c), v_c, v_p);
}

/** Velocities as numbers and swings set them, and what was typed of these. */
function motionThatIsTyped(settings, { phases, written }) {
  const { python } = written[settings.motion];
  const namesOf = (which) => [1, 2, 3].map((axis) => `${which}${axis}`);
  const moved = (which) => list(namesOf(which).map((name) => python[name] ?? name));
  return [
    "def velocities(t):",
    `    ${namesOf("w_c").join(", ")} = ${settings.w_c.join(", ")}`,
    ...["v_c", "v_p"].map((which) => `    ${namesOf(which).join(", ")} = ${swung(settings, phases, which).join(", ")}`),
    `    return ${["w_c", "v_c", "v_p"].map(moved).join(", ")}`,
    "",
    ...rigidOf(...[0, 1, 2].map((k) => `lambda t: velocities(t)[${k}]`)),
  ];
}

function motionThatSwings(settings, phases) {
  const velocities = ["v_c", "v_p"].map((which) => `${which} = lambda t: ${list(swung(settings, phases, which))}`);
  return [...velocities, ...rigidOf(list(settings.w_c), "v_c", "v_p")];
}

function rigidOf(w_c, v_c, v_p) {
  return [
    "motion = rigid(",
    `    camera_angular_velocity=${w_c},`,
    `    camera_velocity=${v_c},`,
    `    point_velocity=${v_p},`,
    ")",
  ];
}

/** The components of a velocity, with the swings of those that swing. */
function swung(settings, phases, which) {
  return settings[which].map((value, k) => {
    const swing = settings[`${which}_swing`][k];
    return swing ? `${value} + ${swing} * math.sin(${settings.rate} * t + ${phases[which][k]})` : `${value}`;
  });
}
