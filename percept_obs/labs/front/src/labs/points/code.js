// The few lines of Python that make the same run.

import { list, NOISES, script } from "../../ui/code.js";
import { isTyped } from "../../engine/typed.js";
import { OWN } from "./kernels.js";
import { readP, textOfP } from "./weight.js";

const WEIGHTS = {
  constant: ({ size }) => [size, []],
  scheduled: ({ size, final, duration }) => [`lambda t: ${size} * (${final} / ${size}) ** (t / ${duration})`, []],
  typed: (_, typed) => [typed.varies ? `lambda t: ${typed.text}` : typed.text, []],
  lyapunov: ({ size, decrease }, { text = size }) => [`lyapunov(${text}, ${decrease})`, ["lyapunov"]],
  riccati: ({ size, forgetting }, { text = size }) => [`riccati(${text}, ${forgetting})`, ["riccati"]],
};

/** The typed P in Python, for a state of n entries. */
function typedP(model, settings, n) {
  const { entries, varies, python } = readP(model, settings);
  return { varies, text: entries === 1 ? python : `np.diag(${n / entries} * ${python})` };
}

export function pythonOf({ settings, truth, n, points, names: states }, model) {
  const { error } = model;
  const own = settings.state === OWN;
  const names = new Set(["Camera", NOISES[settings.noise.kind], "PointsScenario", "luenberger", "record", "track"]);
  const [P, weights] = WEIGHTS[settings.weight](settings, typedP(model, settings, n));
  const helpers = new Set(weights);
  const { noise, period, dropout, duration, seed, view } = settings;
  const start = Array.from(truth.subarray(0, n), (value) => Number(value.toPrecision(12)));
  const lines = [
    ...(textOfP(settings) ? [`P = ${settings.size}`] : []),
    ...(own ? [] : movedAs(settings, model)),
    ...formOf(settings, points, names, helpers),
    `# the state is ${states.join(", ")}`,
    `scenario = PointsScenario("from the lab", form, ${list(start)}, ${duration})`,
    `camera = Camera(period=${period}, noise=${NOISES[noise.kind]}(${noise.size}), dropout=${dropout}, reach=${view})`,
    `recording = record(scenario, camera=camera, seed=${seed})`,
  ];
  settings.hidden.forEach(
    (times, k) => times && lines.push(`recording = recording.without(${times.join(", ")}, point=${k})`),
  );
  const options = [`hold="${settings.hold}"`, `step=${settings.step}`];
  if (settings.start === "rays") {
    names.add("FirstSight");
    options.unshift(`FirstSight(${settings.depth})`);
  }
  if (settings.start === "error") {
    lines.push(`start = recording.truth[0] - ${settings.error} * np.resize(${list(error)}, form.states)`);
    options.unshift("start");
  }
  lines.push(`run = track(recording, luenberger(form, ${P}), ${options.join(", ")})`, "print(run.verdict())");
  const wanted = {
    percept_obs: names,
    "percept_obs.points": helpers,
    "percept_obs.points.manoeuvre": own ? [] : ["Manoeuvre"],
    ...(isTyped(settings) && {
      "percept_obs.system.motion": ["TIME as t"],
      sympy: model.written[settings.motion].functions,
    }),
  };
  return script(wanted, lines);
}

/** Motion of camera and body, with the typed changes. */
function movedAs(settings, { written }) {
  const { turning, spin, input, camera_velocity } = settings;
  const constant = `camera_velocity=(${camera_velocity.join(", ")})`;
  const lines = [
    `moves = Manoeuvre(turning=${turning}, spin=${spin}, input=${input}, ${constant})`,
    "turning, velocity, spinning = moves.velocities",
  ];
  if (!isTyped(settings)) return lines;
  const { sympy } = written[settings.motion];
  const namesOf = (which) => [1, 2, 3].map((axis) => `${which}${axis}`);
  const moved = (which) => list(namesOf(which).map((name) => sympy[name] ?? name));
  return [
    ...lines,
    `${namesOf("w_c").join(", ")} = turning`,
    `${namesOf("v_c").join(", ")} = velocity`,
    `${namesOf("w_b").join(", ")} = spinning`,
    `turning, velocity, spinning = ${moved("w_c")}, ${moved("v_c")}, ${moved("w_b")}`,
  ];
}

function formOf({ state }, points, names, helpers) {
  if (state === OWN) return ["# form = the PointsForm that you gave to the lab"];
  if (state === "independent") {
    names.add("rigid");
    helpers.add("independent_points");
    return [
      "motion = rigid(camera_angular_velocity=turning, camera_velocity=velocity)",
      `form = independent_points(motion, ${points})`,
    ];
  }
  const helper = { body: "rigid_body", origin: "body_with_origin" }[state];
  helpers.add(helper);
  return [`form = ${helper}(${points}, turning, velocity, spinning)`];
}
