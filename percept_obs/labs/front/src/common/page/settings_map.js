// The map over two settings: what an observer's run comes to at every place, with a cursor that goes there.

import { cellAt } from "../model/axes.js";
import { bare, IMPOSSIBLE, settingsAt, THEN } from "../model/cells.js";
import { breath, Filling } from "../model/filling.js";
import { cellAtShares, sharesOf, Sweep } from "../model/sweep.js";
import { readOf } from "../model/typed.js";
import { cellInWords, mapInWords, placeInWords, stateInWords } from "../model/map_words.js";
import { openBeside } from "./beside.js";
import { Picture } from "./canvas.js";
import { element } from "./controls.js";
import { put } from "./put.js";
import { RunThere } from "./run_there.js";
import { boxOf, drawAim, drawMap } from "./settings_map_drawing.js";

const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const LEAP = 8;
const HOW = "Map over two settings: move the cursor with the arrow keys, Enter goes there";
/** Milliseconds at a time that maps may take of the page's own, until there is a worker and where there is none. */
const SLICE = 8;
/** Milliseconds in which a first picture has been handed to the screen, so that opening a worker does not delay it. */
const SHOWN = 50;

export class SettingsMap extends Picture {
  constructor(lab, axesOf) {
    super("settings-map", "Map over two settings");
    this.figure.hidden = true;
    this.lab = lab;
    this.axesOf = axesOf;
    this.sweep = new Sweep(lab.model, axesOf, () => this.come());
    /** @type {Filling | null} */
    this.here = null;
    /** @type {Worker | null} */
    this.worker = null;
    /** @type {number[] | null} where the cursor is, in shares of the way along both axes */
    this.aim = null;
    /** @type {ReturnType<typeof boxOf> | null} */
    this.box = null;
    this.pad = element("div", { class: "aim", tabindex: 0, role: "slider", "aria-label": HOW, "aria-valuenow": 0, title: "Press to go there" });
    this.pad.dataset.control = "map place";
    this.line = element("p", { class: "run-there", "aria-hidden": "true" });
    this.figure.append(this.pad, this.line);
    /** @type {RunThere | null} */
    this.there = null;
    this.listen();
  }

  listen() {
    const { pad } = this;
    const shares = ({ clientX, clientY }) => {
      const { left, top, width, height } = pad.getBoundingClientRect();
      const [x, y] = [(clientX - left) / width, 1 - (clientY - top) / height];
      return x >= 0 && x < 1 && y >= 0 && y < 1 ? [x, y] : null;
    };
    const point = (aim) => {
      this.aim = aim;
      this.again();
    };
    pad.addEventListener("pointermove", (event) => point(shares(event)));
    pad.addEventListener("pointerleave", () => point(null));
    pad.addEventListener("blur", () => point(null));
    pad.addEventListener("click", (event) => {
      point(shares(event));
      this.go();
    });
    pad.addEventListener("keydown", (event) => {
      const step = STEPS[event.key];
      if (step) this.step(step, event.shiftKey ? LEAP : 1);
      else if (event.key === "Enter") this.go();
      else if (event.key === "Escape" && this.aim) point(null);
      else return;
      event.preventDefault();
    });
  }

  /** Move the cursor by so many of the finest cells. */
  step(direction, size) {
    const cells = Math.max(this.sweep.finest, THEN[THEN.length - 1]);
    const from = this.aim ?? this.standing() ?? [0.5, 0.5];
    this.aim = from.map((share, c) => (cellAt(cellAt(share, cells) / cells + (direction[c] * size + 0.5) / cells, cells) + 0.5) / cells);
    this.again();
  }

  /** Draw once more what has changed here, and nothing else, unless the whole lab is about to be drawn. */
  again() {
    const { lab } = this;
    if (lab.shown && lab.theme && !lab.pending) this.draw(lab.shown, null, null, lab.theme);
  }

  /** Where the shown settings are; null while that is not known. */
  standing() {
    const { shown, kernels } = this.lab;
    const functions = shown && kernels.of(shown.settings);
    const plan = this.sweep.found?.plan;
    return functions && plan ? sharesOf(plan, shown.settings, functions) : null;
  }

  /** The cell at shares of the way along both axes, and the settings there; null as long as it is not filled. */
  at(shares) {
    const { lab, sweep: { found } } = this;
    const cell = found && cellAtShares(found, shares);
    const functions = lab.kernels.of(lab.settings);
    if (!cell || !functions) return null;
    return { cell, observer: found.plan.observer, settings: cell.kind === IMPOSSIBLE ? null : settingsAt(lab.settings, found.plan, cell.place, functions) };
  }

  /** Take the settings of the place under the cursor: a step that can be undone. */
  go() {
    const there = this.aim && this.at(this.aim);
    if (there?.settings) this.lab.change(there.settings, true);
    else if (there) this.lab.say("There is no run at this place.");
  }

  /** Something of the map has come. */
  come() {
    const { lab } = this;
    this.again();
    setTimeout(() => this.here && this.hire(), SHOWN);
    const finest = this.sweep.found?.levels.at(-1);
    if (finest && finest.done === finest.cells ** 2 && !lab.held && lab.shown) this.describe(lab.shown);
  }

  /** Fill maps in slices of the page's own time: until there is a worker, and where there is none. */
  begin() {
    if (this.here) return;
    const { lab, sweep } = this;
    const there = (this.there ??= new RunThere(lab.charts.error));
    const { Engine, CellEngine, axesOf } = lab.constructor.computing;
    const { model, kernels } = lab;
    const here = new Filling({ model, kernels, engine: new CellEngine(model), runs: new Engine(model), axesOf }, (part) => sweep.take(part), { slice: SLICE, pause: breath });
    this.here = here;
    const failed = (error) => lab.fail(error);
    sweep.fill({ ask: (task) => here.take(task).catch(failed) });
    there.from((task) => here.follow(task).then((found) => there.take(found), failed));
  }

  /** Let a worker fill maps as soon as it is open: hired when somebody comes to its controls, else after the first picture, which would wait for it. */
  hire() {
    this.begin();
    const { here, lab, sweep, there } = this;
    const bundle = lab.widget.get("_esm");
    if (this.worker || typeof Worker === "undefined") return;
    const [kind, texts, model] = ["kind", "texts", "model"].map((name) => lab.widget.get(name));
    this.worker = openBeside({ bundle, kind, texts, model }, {
      onReady: ({ ask }) => {
        here?.stop();
        there?.from(ask);
        sweep.fill({ ask: (task) => ask({ ...task, written: readOf(task.settings, lab.model) }) });
        // Who comes to its controls has the map before choosing to see it.
        if (lab.shown) this.want(lab.shown);
      },
      onAnswer: (answer) => (answer.error ? lab.fail(new Error(answer.error)) : answer.key ? there?.take(answer) : sweep.take(answer)),
      onGone: () => {},
    }, "maps");
  }

  /** Nothing is to be filled any more. */
  close() {
    this.here?.stop();
    this.worker?.terminate();
    this.here = this.worker = null;
    this.sweep.close();
    this.there?.from(null);
    this.there?.want(null);
  }

  /** Ask for the map of what is shown; what its settings compute with, where that is known. */
  want({ settings, tolerance }) {
    const functions = this.lab.kernels.of(settings);
    if (functions) this.sweep.want(settings, functions, tolerance);
    return functions;
  }

  draw(shown, _ghost, _cursor, theme) {
    const { figure, sweep } = this;
    const off = shown.settings.over.shows === "nothing";
    if (off !== figure.hidden) {
      figure.hidden = off;
      if (off) this.close();
    }
    if (off) return undefined;
    this.begin();
    const functions = this.want(shown);
    if (!functions) return undefined;
    const size = this.fit(theme.font);
    const box = boxOf(size);
    if (!this.box || Object.entries(box).some(([side, value]) => this.box?.[side] !== value)) {
      this.box = box;
      Object.assign(this.pad.style, { left: `${box.left}px`, top: `${box.top}px`, width: `${box.width}px`, height: `${box.height}px` });
    }
    const what = shown.settings.over.shows;
    const { plan, found, version } = sweep;
    const title = this.title(plan, what);
    this.underlay([version, what, title, box, found && plan?.across.place, found && plan?.up.place, theme], (pen) => drawMap(pen, box, { found, plan, what, title }, theme));
    const standing = found && sharesOf(found.plan, shown.settings, functions);
    if (standing) drawAim(this.context, box, standing, this.aim && cellAtShares(found, this.aim), theme);
    return this.read();
  }

  title(plan, what) {
    const { title } = this.lab.model.observers[plan.observer];
    return `${what === "settling" ? "Settling time" : "Error at the end"}, ${title}`;
  }

  /** Say what the run under the cursor comes to, or how far the map is. */
  read() {
    const { sweep, aim, sweep: { found } } = this;
    const cell = aim && found && cellAtShares(found, aim);
    const text = cell ? `${placeInWords(found.plan, cell.place)}: ${cellInWords(cell)}` : stateInWords(sweep);
    put(this.line, text);
    const follow = cell && this.at(aim)?.settings;
    this.there?.want(follow ? { key: JSON.stringify([sweep.key, cell.place]), follow: bare(follow, found.plan.observer) } : null);
    this.pad.setAttribute("aria-valuenow", String(Math.round(100 * (aim?.[0] ?? 0))));
    if (this.pad.getAttribute("aria-valuetext") !== text) this.pad.setAttribute("aria-valuetext", text);
  }

  describe(shown) {
    if (shown.settings.over.shows === "nothing") return this.tell("off");
    const { sweep } = this;
    const { shows } = shown.settings.over;
    return this.tell(sweep.found ? mapInWords(sweep, shows, this.title(sweep.found.plan, shows)) : stateInWords(sweep));
  }
}
