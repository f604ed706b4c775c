// Every lab as a hand finds it: it opens, asks, is dragged, is set by each of its controls.  A scene is what is then
// drawn and said.

import { readFileSync } from "node:fs";
import { DeskLab } from "../src/labs/desk/lab.js";
import { ObserverLab } from "../src/labs/observer/lab.js";
import { PointsLab } from "../src/labs/points/lab.js";
import { StructureLab } from "../src/labs/structure/lab.js";
import { modelOf } from "../src/state/texts.js";
import { openPage } from "./document.js";
import { loadHere } from "./load_here.js";

const FRONT = new URL("../", import.meta.url);
const OPENED = JSON.parse(readFileSync(new URL("tests/models.json", FRONT), "utf8"));
export const LABS = { observer: ObserverLab, points: PointsLab, structure: StructureLab, desk: DeskLab };
const turn = () => new Promise((resolve) => setImmediate(resolve));

/** Open a lab in a page of its own; `settings` are other ones than it opens with. */
export async function opened(name, { settings = {}, view = {}, ...options } = {}) {
  const page = openPage({ still: true, ...options });
  const given = structuredClone(OPENED[name]);
  const model = await modelOf(readFileSync(new URL(`${name}_lab.gz`, FRONT)), given.model);
  const sent = [];
  const listeners = {};
  const traits = {
    ...{ kind: `${name}_lab`, settings: { ...given.settings, ...settings }, view: { ...given.view, ...view }, model, analysis: {}, written: {} },
    ...{ frames: [], address: options.hash === undefined ? undefined : { name, names: [name] } },
  };
  const widget = {
    get: (trait) => traits[trait],
    set: (trait, value) => (traits[trait] = value),
    on: (event, act) => (listeners[event] ??= []).push(act),
    off: (event, act) => (listeners[event] = listeners[event].filter((each) => each !== act)),
    save_changes: name === "desk" ? undefined : () => sent.push(structuredClone({ settings: traits.settings, view: traits.view })),
    tell: (trait, value) => {
      traits[trait] = value;
      for (const act of listeners[`change:${trait}`] ?? []) act();
    },
  };
  const Of = LABS[name];
  const { Kernels, Engine } = Of.computing ?? {};
  /** Kernels whose texts Node can import. */
  class Here extends (Kernels ?? Object) {
    constructor(whole) {
      super(whole, loadHere);
    }
  }
  class Lab extends Of {
    static computing = { Kernels: Here, Engine };
  }
  const lab = new Lab(widget, page.document.body, model);
  const root = page.document.body;
  /** Wait until pictures and words are of the present settings. */
  const rest = async () => {
    for (let calm = 0, k = 0; calm < 3; k++) {
      if (k > 2000) throw new Error("it never rests");
      await turn();
      page.pass(20);
      calm = lab.settled !== false && !lab.pending && !lab.late && lab.resting === null ? calm + 1 : 0;
    }
    page.pass(600); // until the sentence is read out
  };
  const find = (control) => root.querySelector(`[data-control="${control}"]`);
  const seen = (selector = "[data-control]") => root.querySelectorAll(selector).filter((node) => node.seen && !node.disabled);
  await rest();
  return { lab, page, widget, sent, rest, find, seen, root };
}

/** Use a control as a hand would; returns what it did in words. */
export function use(node) {
  const put = (value, ...types) => {
    node.focus();
    node.value = String(value);
    for (const type of types) node.tell(type);
    return `at ${value}`;
  };
  if (node.classList.contains("handle")) return drag(node);
  if (node.tagName === "select") {
    const others = node.options.filter(({ disabled, value }) => !disabled && value !== node.value);
    return others.length ? put(others.at(-1).value, "change") : "";
  }
  if (node.tagName === "textarea") return put("a13 + y1", "input");
  if (node.type === "range") {
    const [low, high, step] = [node.min, node.max, node.step].map(Number);
    const part = Number(node.value) > (low + high) / 2 ? 0.25 : 0.75;
    return put(low + Math.round((part * (high - low)) / step) * step, "input", "change");
  }
  if (node.type === "number") return put(Number(((Number(node.value) || 1) * 1.25).toPrecision(3)), "input", "change");
  if (node.type === "checkbox") {
    node.checked = !node.checked;
    node.tell("change");
    return node.checked ? "on" : "off";
  }
  if (node.type === "text") return put("Ada", "change");
  node.focus();
  node.tell("click");
  return "pressed";
}

function drag(node) {
  for (const [type, clientX, clientY] of [["pointerdown", 100, 100], ["pointermove", 112, 91], ["pointermove", 118, 88], ["pointerup", 118, 88]])
    node.tell(type, { clientX, clientY });
  return "dragged";
}

/** Yield the scenes of a lab, each as its name and what is then drawn and said. */
export async function* scenesOf(name) {
  yield* played(name);
  if (name === "desk") yield* typed();
  const open = await opened(name);
  const { lab, page, rest, find, seen } = open;
  const scene = async (what) => {
    await rest();
    return [what, page.told()];
  };
  const again = async () => {
    lab.screen ? lab.screen.again() : lab.reset();
    await rest();
  };
  yield scene("it opens");
  for (const node of seen(".handle")) {
    const control = node.getAttribute("data-control");
    for (const key of ["ArrowUp", "ArrowRight", "Enter"]) {
      node.focus();
      node.tell("keydown", { key, shiftKey: key === "ArrowUp" });
      node.tell("keyup", { key });
      yield scene(`${control}, ${key}`);
    }
    lab.undo();
    yield scene(`${control}, undone`);
    lab.redo();
    drag(node);
    yield scene(`${control}, dragged`);
    await again();
  }
  for (const question of lab.screen?.questions.all ?? []) {
    lab.screen.questions.ask(question.name);
    yield scene(`${question.name}, asked`);
    use(find("answer 1"));
    yield scene(`${question.name}, answered`);
    lab.screen.clock.put(0.4 * lab.screen.clock.end);
    if (!lab.screen.whyButton.hidden) use(find("why"));
    yield scene(`${question.name}, why`);
    use(find("done"));
    await rest();
  }
  await again();
  use(find("more"));
  const groups = seen("summary");
  for (const summary of groups) {
    summary.tell("click");
    const group = summary.getAttribute("data-control") ?? "";
    yield scene(`${group}, open`);
    const own = seen("[data-control]").filter((node) => summary.parentElement.contains(node) && node !== summary);
    for (const control of own.map((node) => node.getAttribute("data-control"))) {
      const node = find(control);
      if (!node?.seen || node.disabled) continue;
      const what = use(node);
      yield scene(`${group}: ${control}, ${what}`);
      await again();
      if (!summary.parentElement.open) summary.tell("click");
    }
    for (const wrong of ["0", "1e9", "-2.5", ""]) {
      for (const field of seen("input").filter(({ type }) => type === "number")) {
        if (!summary.parentElement.contains(field) || field.getAttribute("data-control") === "duration number") continue;
        field.focus();
        field.value = wrong;
        field.tell("input");
      }
      yield scene(`${group}: "${wrong}" in every field`);
      await again();
      if (!summary.parentElement.open) summary.tell("click");
    }
    summary.tell("click");
  }
  for (const control of seen(".handy [data-control], .actions [data-control], .steps [data-control]").map((node) => node.getAttribute("data-control"))) {
    const what = use(find(control));
    yield scene(`${control}, ${what}`);
  }
  lab.close();
}

/** Yield the scenes of a lab while it plays, and while a hand is at its chart. */
async function* played(name) {
  const { lab, page, rest, root, find, seen } = await opened(name, { still: false });
  yield ["before it plays", page.told()];
  for (const part of [1, 2, 3]) {
    page.pass(1500);
    yield [`it plays, ${part}`, page.told()];
  }
  page.pass(8000);
  yield ["it has played", page.told()];
  if (!lab.screen) return lab.close();
  const pad = root.querySelector(".first-chart .scrub");
  pad.tell("pointermove", { clientX: 300, clientY: 50 });
  await rest();
  yield ["a value is read", page.told()];
  pad.tell("pointerdown", { clientX: 200, clientY: 20 });
  pad.tell("pointermove", { clientX: 230, clientY: 20 });
  pad.tell("pointerup");
  await rest();
  yield ["the time is dragged", page.told()];
  find("play").focus();
  for (const key of ["ArrowLeft", "+", "PageUp"]) find("play").tell("keydown", { key });
  pad.tell("wheel", { deltaY: -200, clientX: 400, clientY: 30 });
  await rest();
  yield ["it is zoomed", page.told()];
  use(find("more"));
  lab.look({ more: "charts", charts: Object.keys(lab.parts.charts), side: true });
  if (lab.settings.noise) lab.change({ noise: { ...lab.settings.noise, size: 0.004 }, kept: structuredClone(lab.settings) }, true);
  await rest();
  yield ["all charts, beside a kept run", page.told()];
  page.pass(5000);
  yield ["Python has not answered", page.told()];
  if (seen("[data-control='choose sliding_mode']").length) use(find("choose sliding_mode"));
  lab.close();
  return undefined;
}

/** Lines for the rate of y1 at the desk: right, with a slip, begun, and no plain arithmetic. */
const RATE = "a11 y1 + a12 y2 + a13 + b1 y3 - y1 (a31 y1 + a32 y2 + a33 + b3 y3)";
const LINES = [
  ...[RATE, RATE.replace("a12", "a21"), RATE.replace("a13", "2 a13"), RATE.replace("+ b1", "- b1"), RATE.replace("y1 (", "y2 (")],
  ...["a13 + (a11 - a33) y1", "a13 + (a11", "1/y1 + a13^-2", "sqrt(1 + y1^2) - sin(y2) exp(a11)", "y1 + q", "\\frac{y1}{2}", "y1^y2"],
];

/** Yield what the desk finds of lines, with all hints open. */
async function* typed() {
  for (const text of LINES) {
    const settings = { step: 6, typed: { "rate 6 y1'": text, "rate 6 y3'": "-y3 (a31 y1 + a32 y2 + a33)" }, hints: { "rate 6": 4 } };
    const { lab, page, rest } = await opened("desk", { settings });
    await rest();
    yield [`typed: ${text}`, page.told()];
    lab.replay.put(9);
    await rest();
    yield [`up to the ninth letter: ${text}`, page.told()];
    lab.close();
  }
}
