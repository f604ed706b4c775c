// What a lab does with its settings: computes once, draws as often as asked, undoes, and hears answers to them only.
import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";
import { State } from "../src/state/state.js";
import { Link } from "../src/ui/link.js";
import { Lab } from "../src/ui/lab.js";

const OPENING = { gain: 1, seed: 0, period: 0.01, duration: 1, observers: [], kept: null };

const VIEW = { more: "", charts: [], chosen: "", side: false, sight: null };

/** An engine that counts what it is asked for. */
class CountingEngine {
  runs = 0;
  completions = 0;

  run(settings, functions, whole) {
    this.runs += 1;
    const time = Float64Array.of(0, 1);
    return {
      settings,
      time,
      truth: null,
      runs: [],
      names: [],
      width: 0,
      value: settings.gain * functions.factor,
      whole,
    };
  }

  completed(result) {
    this.completions += 1;
    return { ...result, whole: true };
  }
}

/** The one function that settings need, which is always there. */
class SmallKernels {
  whole = new Set();

  of() {
    return { factor: 2 };
  }

  async prepare() {}
}

/** A model of the kernel's side: traits with listeners, as anywidget hands them over. */
function fakeWidget() {
  const state = { settings: structuredClone(OPENING), model: { observers: {}, opening: OPENING }, view: VIEW };
  const listeners = {};
  return {
    get: (name) => state[name],
    set: (name, value) => (state[name] = value),
    on: (event, listener) => (listeners[event] = listener),
    off: () => {},
    save_changes: () => {},
    /** Python puts a value there. */
    tell: (name, value) => {
      state[name] = value;
      listeners[`change:${name}`]();
    },
  };
}

/** A lab of one picture, which notes what it draws and what it says of Python's answers. */
class SmallLab extends Lab {
  static computing = { Kernels: SmallKernels, Engine: CountingEngine };

  constructor(widget) {
    const words = { reasons: () => [], summaryOf: (_, serial) => ({ serial }), charts: {} };
    super(widget, { schema: {}, ...widget.get("model") }, { words: {}, ...words });
    this.drawings = [];
    this.spokenOf = [];
    const draw = (shown, ghost) => this.drawings.push([shown.value, ghost?.value ?? null, this.state.cursor]);
    this.screen = { views: [], draw, describe() {}, showCharts() {}, close() {} };
    this.panel = { show: () => {} };
    this.drawer = { show: () => {}, speak: () => this.spokenOf.push(this.answered()?.sentences ?? null) };
    const told = (name) => [name, (value) => (this.told[name] = value)];
    this.told = {};
    const names = ["problem", "notice", "silence"];
    const root = { classList: { toggle() {} }, style: { setProperty() {} } };
    this.follow({ root, ...Object.fromEntries(names.map(told)) });
  }

  get engine() {
    return this.results.engines[0];
  }
}

const settled = () => new Promise((resolve) => setImmediate(resolve));
let frames;
let clock;

beforeEach(() => {
  frames = [];
  clock = 1000;
  mock.method(performance, "now", () => clock);
  const observer = class {
    observe() {}
    disconnect() {}
  };
  const style = { getPropertyValue: () => "black" };
  Object.assign(globalThis, {
    requestAnimationFrame: (act) => frames.push(act),
    cancelAnimationFrame: () => {},
    ResizeObserver: observer,
    MutationObserver: observer,
    document: { body: { dataset: {} } },
    window: { matchMedia: () => ({ addEventListener() {}, removeEventListener() {} }) },
    getComputedStyle: () => style,
  });
});

afterEach(() => mock.restoreAll());

/** The next frame, some time later. */
function frame(later = 16) {
  clock += later;
  for (const act of frames.splice(0)) act();
}

async function opened() {
  const widget = fakeWidget();
  const lab = new SmallLab(widget);
  await settled();
  frame();
  return { lab, widget };
}

test("cursor, theme and size draw without running an engine; a setting runs it once", async () => {
  const { lab } = await opened();
  assert.equal(lab.engine.runs, 1);
  const before = lab.drawings.length;
  lab.point(0.5);
  frame();
  lab.retheme();
  frame();
  lab.width = 400;
  lab.schedule();
  frame();
  assert.equal(lab.drawings.length, before + 3);
  assert.deepEqual(lab.drawings.at(-1), [2, null, 0.5]);
  assert.equal(lab.engine.runs, 1);
  lab.change({ gain: 3 });
  frame();
  frame(300);
  lab.point(0.7);
  frame(300);
  await lab.rest();
  assert.equal(lab.engine.runs, 2);
  assert.equal(lab.drawings.at(-1)[0], 6);
  lab.close();
});

test("what is read off a result is computed when words or a picture need it, and the kept run once", async () => {
  const { lab } = await opened();
  lab.keep();
  frame();
  const engine = lab.engine;
  const [runs, completions] = [engine.runs, engine.completions];
  for (const gain of [2, 3, 4]) {
    lab.change({ gain });
    frame(10);
  }
  assert.deepEqual([engine.runs - runs, engine.completions - completions], [3, 0]);
  await lab.rest();
  assert.deepEqual([engine.runs - runs, engine.completions - completions], [3, 1]);
  assert.equal(lab.results.engines[1].runs, 1);
  assert.deepEqual(lab.drawings.at(-1).slice(0, 2), [8, 2]);
  lab.close();
});

test("an answer of Python to other settings than those that are shown is not shown", async () => {
  const { lab, widget } = await opened();
  const first = lab.serial;
  widget.tell("analysis", { serial: first, sentences: ["of the opening"], bound: 1 });
  assert.equal(lab.answered().bound, 1);
  lab.change({ gain: 5 });
  frame();
  assert.equal(lab.answered(), null);
  widget.tell("analysis", { serial: first, sentences: ["late"], bound: 2 });
  assert.equal(lab.answered(), null);
  await lab.rest();
  widget.tell("analysis", { serial: first, sentences: ["later still"], bound: 3 });
  assert.equal(lab.answered(), null);
  assert.notEqual(lab.link.waitingFor, null);
  widget.tell("analysis", { serial: lab.serial, sentences: ["of gain 5"], bound: 4 });
  assert.equal(lab.answered().bound, 4);
  frame(10);
  assert.deepEqual(lab.spokenOf.at(-1), ["of gain 5"], "words follow an answer at once");
  lab.close();
});

test("the line to Python hears answers to its latest message only, and says of which settings they are", () => {
  const heard = [];
  const widget = fakeWidget();
  const nothing = () => {};
  const link = new Link(widget, { onAnalysis: (...answer) => heard.push(answer), onSilence: nothing });
  widget.tell("analysis", { serial: 7 });
  const settings = { gain: 1 };
  link.send(settings, { serial: 7 });
  widget.tell("analysis", { serial: 6 });
  assert.deepEqual(heard, []);
  widget.tell("analysis", { serial: 7 });
  link.send({ gain: 2 }, { serial: 8 });
  widget.tell("analysis", { serial: 7 });
  assert.deepEqual(heard, [[{ serial: 7 }, settings]]);
  link.close();
});

test("a drag is one step of the history, and so is each choice", () => {
  const state = new State(OPENING);
  for (const gain of [2, 3, 4]) state.move({ gain });
  state.release();
  state.move({ gain: 5 });
  state.move({ seed: 1 });
  state.step({ settings: { ...state.settings, seed: 2 } });
  const seen = [];
  while (state.undo()) seen.push([state.settings.gain, state.settings.seed]);
  assert.deepEqual(seen, [[5, 1], [5, 0], [4, 0], [1, 0]]);
  assert.equal(state.settings, OPENING);
  while (state.redo()) seen.push([state.settings.gain, state.settings.seed]);
  assert.deepEqual(seen.slice(4), [[4, 0], [5, 0], [5, 1], [5, 2]]);
});

test("what leads back to where it began is no step, and a step forgets what was undone", () => {
  const state = new State(OPENING);
  for (const gain of [2, 1]) state.move({ gain });
  state.release();
  assert.equal(state.undo(), false);
  state.move({ gain: 2 });
  assert.equal(state.undo(), true);
  state.move({ gain: 3 });
  assert.equal(state.redo(), false);
});

test("a question and its answer are steps, and the way back leads to the settings before them", () => {
  const state = new State(OPENING);
  const at = () => [state.settings.seed, state.question?.name, state.question?.said];
  const of = (seed) => ({ ...OPENING, seed });
  state.ask("noise", of(5));
  assert.deepEqual([state.settings, state.question.before], [of(5), OPENING]);
  state.answer(1, of(1));
  assert.deepEqual([...at(), state.question.of.seed], [1, "noise", 1, 1]);
  state.ask("bias", of(6));
  state.answer(0, of(2));
  assert.deepEqual([...at(), state.question.before], [2, "bias", 0, OPENING]);
  state.leave();
  assert.deepEqual([state.settings, state.question], [OPENING, null]);
  const back = [
    [2, "bias", 0],
    [6, "bias", null],
    [1, "noise", 1],
    [5, "noise", null],
    [OPENING.seed, undefined, undefined],
  ];
  for (const step of back) {
    state.undo();
    assert.deepEqual(at(), step);
  }
  for (const step of back.toReversed().slice(1)) {
    state.redo();
    assert.deepEqual(at(), step);
  }
});

test("what is looked at is no part of the settings: it is a step back, and computes nothing again", async () => {
  const { lab, widget } = await opened();
  const { settings } = lab;
  lab.unfold("charts");
  lab.look({ charts: ["error"] });
  lab.look({ sight: [0.2, 0.4] });
  frame(300);
  await lab.settle();
  assert.equal(lab.engine.runs, 1);
  assert.equal(lab.settings, settings);
  assert.deepEqual(widget.get("view"), { ...VIEW, more: "charts", charts: ["error"], sight: [0.2, 0.4] });
  assert.deepEqual(lab.span, { low: 0.2, high: 0.4 });
  lab.undo();
  assert.deepEqual([lab.state.view.charts, lab.state.view.sight], [["error"], null]);
  lab.undo();
  assert.deepEqual(lab.state.view, { ...VIEW, more: "charts" }, "the drawer stays open");
  lab.look({ sight: [0.2, 0.4] });
  lab.change({ duration: 3 }, true);
  assert.equal(lab.state.view.sight, null, "another run is shown whole");
  lab.close();
});

test("zooming keeps the time under the hand where it is, inside the run", async () => {
  const { lab } = await opened();
  lab.zoom(0.5, 0.5);
  assert.deepEqual(lab.span, { low: 0.25, high: 0.75 });
  lab.zoom(0.5, 0.25);
  assert.deepEqual(lab.span, { low: 0.25, high: 0.5 });
  lab.zoom(100, 0.3);
  assert.deepEqual(lab.span, { low: 0, high: 1 });
  lab.zoom(0.5, 0);
  assert.deepEqual(lab.span, { low: 0, high: 0.5 });
  lab.showAll();
  assert.deepEqual(lab.span, lab.whole);
  lab.close();
});

test("a long run of which all observers settle early opens on its beginning, and a short one whole", () => {
  const found = (settling, last) => {
    const lab = Object.create(SmallLab.prototype);
    const settings = { scenario: "one", duration: last };
    Object.assign(lab, {
      model: {},
      state: { settings, view: VIEW },
      part: { of: "", span: null },
      shown: { settings, time: [0, last], runs: settling.map((each) => ({ settling: each })) },
    });
    lab.findPart();
    return lab.span.high;
  };
  assert.equal(found([2.35], 80), 10);
  assert.equal(found([2.35, 1], 80), 10);
  assert.equal(found([2.35, 30], 80), 80);
  assert.equal(found([2.35, Infinity], 80), 80);
  assert.equal(found([0.2], 4), 4);
});
