// The map over two settings: what an observer's run comes to at every place, with a cursor that goes there.

import { cellAt, planOf } from "./axes.js";
import { bare, IMPOSSIBLE, settingsAt, THEN } from "./cells.js";
import { breath, Filling } from "./filling.js";
import { cellInWords, mapInWords, placeInWords, stateInWords } from "./map_words.js";
import { changeAt } from "../state/settings.js";
import { cellAtShares, sharesOf, Sweep } from "./sweep.js";
import { readOf } from "../engine/typed.js";
import { select } from "../ui/controls.js";
import { element, listen, setAttribute, setText } from "../ui/dom.js";
import { topic } from "../ui/fieldsets.js";
import { STEPS } from "../draw/handle.js";
import { LabelledPicture } from "../draw/labels.js";
import { PointerRun } from "./pointer_run.js";
import { boxOf, drawAim, drawMap } from "./settings_map_drawing.js";
import { openWorker } from "../ui/worker.js";

const LEAP = 8;
const HOW = "Map over two settings: move the cursor with the arrow keys, Enter goes there";
const SHOWS = { nothing: "no map", settling: "settling time", error: "error at the end" };
const MEANING = "Each place is a whole run with all other settings as they are; noise has the same seed everywhere.";
/** Milliseconds at a time that maps may take of the page's own, until there is a worker and where there is none. */
const SLICE = 8;
/** Milliseconds in which a first picture has been handed to the screen, so that opening a worker does not delay it. */
const SHOWN = 50;

export class SettingsMap extends LabelledPicture {
  /** @type {Filling | null} what fills maps in the page */
  filling = null;
  /** @type {Worker | null} */
  worker = null;
  /** @type {number[] | null} where the cursor is, in shares of the way along both axes */
  aim = null;
  /** @type {PointerRun | null} */
  pointerRun = null;
  /** The box that the pad covers. */
  box = "";

  constructor(lab, axesOf) {
    super("settings-map", "Map over two settings");
    this.figure.hidden = true;
    this.lab = lab;
    this.sweep = new Sweep(lab.model, axesOf, () => this.come());
    this.pad = element("div", {
      ...{ class: "aim", "data-control": "map place", tabindex: 0, role: "slider", "aria-label": HOW },
      ...{ "aria-valuenow": 0, title: "Press to go there" },
    });
    this.line = element("p", { class: "run-there", "aria-hidden": "true" });
    this.figure.append(this.pad, this.line);
    this.listen();
  }

  listen() {
    const { pad } = this;
    const sharesAt = ({ clientX, clientY }) => {
      const { left, top, width, height } = pad.getBoundingClientRect();
      const [x, y] = [(clientX - left) / width, 1 - (clientY - top) / height];
      return x >= 0 && x < 1 && y >= 0 && y < 1 ? [x, y] : null;
    };
    const point = (aim) => {
      this.aim = aim;
      this.redraw();
    };
    listen(pad, {
      pointermove: (event) => point(sharesAt(event)),
      "pointerleave blur": () => point(null),
      click: (event) => {
        point(sharesAt(event));
        this.go();
      },
      keydown: (event) => {
        const step = STEPS[event.key];
        if (step) this.step(step, event.shiftKey ? LEAP : 1);
        else if (event.key === "Enter") this.go();
        else if (event.key === "Escape" && this.aim) point(null);
        else return;
        event.preventDefault();
      },
    });
  }

  /** Move the cursor by so many of the finest cells. */
  step(direction, size) {
    const { lab, sweep: { found } } = this;
    const cells = THEN[THEN.length - 1];
    const functions = lab.shown && lab.kernels.of(lab.shown.settings);
    const standing = functions && found ? sharesOf(found.plan, lab.shown.settings, functions) : [0.5, 0.5];
    this.aim = (this.aim ?? standing).map((share, c) => {
      const moved = cellAt(share, cells) + direction[c] * size + 0.5;
      return (cellAt(moved / cells, cells) + 0.5) / cells;
    });
    this.redraw();
  }

  /** Draw once more what has changed here, and nothing else, unless the whole lab is about to be drawn. */
  redraw() {
    const { lab } = this;
    if (lab.shown && lab.theme && !lab.pending) this.draw(lab.shown, null, null, lab.theme);
  }

  /** The cell at shares of the way along both axes, and the settings there; null as long as it is not filled. */
  at(shares) {
    const { lab, sweep: { found } } = this;
    const cell = found && cellAtShares(found, shares);
    const functions = lab.kernels.of(lab.settings);
    if (!cell || !functions) return null;
    const settings = cell.kind === IMPOSSIBLE ? null : settingsAt(lab.settings, found.plan, cell.place, functions);
    return { cell, observer: found.plan.observer, settings };
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
    this.redraw();
    setTimeout(() => this.filling && this.openWorker(), SHOWN);
    const finest = this.sweep.found?.levels.at(-1);
    if (finest && finest.done === finest.cells ** 2 && !lab.held && lab.shown) this.describe(lab.shown);
  }

  /** Fill maps in slices of the page's own time: until there is a worker, and where there is none. */
  fill() {
    if (this.filling) return;
    const { lab, sweep } = this;
    const { model, kernels } = lab;
    const { Engine, CellEngine, axesOf } = lab.constructor.computing;
    const computing = { model, kernels, engine: new CellEngine(model), runs: new Engine(model), axesOf };
    const filling = new Filling(computing, (part) => sweep.take(part), { slice: SLICE, pause: breath });
    const pointerRun = (this.pointerRun ??= new PointerRun(lab.charts.error));
    const failed = (error) => lab.fail(error);
    this.filling = filling;
    sweep.fill({ ask: (task) => filling.take(task).catch(failed) });
    pointerRun.computeBy((task) => filling.follow(task).then((found) => pointerRun.take(found), failed));
  }

  /**
   * Let a worker fill maps as soon as it is open: from when somebody comes to the map's controls, or else after the
   * first picture, which would wait for it.
   */
  openWorker() {
    this.fill();
    const { filling, lab, sweep, pointerRun } = this;
    if (this.worker || typeof Worker === "undefined") return;
    const ready = (ask) => {
      filling?.stop();
      pointerRun?.computeBy(ask);
      sweep.fill({ ask: (task) => ask({ ...task, written: readOf(task.settings, lab.model) }) });
      // Who comes to its controls has the map before choosing to see it.
      if (lab.shown) this.want(lab.shown);
    };
    const answer = (found) => {
      if (found.error) lab.fail(new Error(found.error));
      else if (found.key) pointerRun?.take(found);
      else sweep.take(found);
    };
    this.worker = openWorker(lab.widget, { ready, answer }, "maps");
  }

  /** Fill nothing any more. */
  close() {
    this.filling?.stop();
    this.worker?.terminate();
    this.filling = this.worker = null;
    this.sweep.close();
    this.pointerRun?.computeBy(null);
    this.pointerRun?.want(null);
  }

  /** Ask for the map of what is shown; return the functions of its settings, where they are there. */
  want({ settings, tolerance }) {
    const functions = this.lab.kernels.of(settings);
    if (functions) this.sweep.want(settings, functions, tolerance);
    return functions;
  }

  draw(shown, _ghost, _cursor, theme) {
    const { figure, sweep } = this;
    const what = shown.settings.over.shows;
    const off = what === "nothing";
    if (off && !figure.hidden) this.close();
    figure.hidden = off;
    if (off) return undefined;
    this.fill();
    const functions = this.want(shown);
    if (!functions) return undefined;
    this.begin(theme);
    const box = boxOf(this);
    this.coverBy(box);
    const { plan, found, version } = sweep;
    const title = this.title(plan, what);
    const axes = found && [plan?.across.place, plan?.up.place];
    this.underlay([version, title, box, axes, theme], () => drawMap(this, box, { found, plan, what, title }, theme));
    const standing = found && sharesOf(found.plan, shown.settings, functions);
    if (standing) drawAim(this.context, box, standing, this.aim && cellAtShares(found, this.aim), theme);
    return this.read();
  }

  /** Put the pad over the box. */
  coverBy(box) {
    const style = Object.entries(box).map(([side, value]) => `${side}: ${value}px`).join("; ");
    if (this.box !== style) this.pad.style.cssText = this.box = style;
  }

  title(plan, what) {
    const { title } = this.lab.model.observers[plan.observer];
    return `${what === "settling" ? "Settling time" : "Error at the end"}, ${title}`;
  }

  /** Say what the run under the cursor comes to, or how far the map is. */
  read() {
    const { sweep, aim, pad, sweep: { found } } = this;
    const cell = aim && found && cellAtShares(found, aim);
    const text = cell ? `${placeInWords(found.plan, cell.place)}: ${cellInWords(cell)}` : stateInWords(sweep);
    setText(this.line, text);
    const settings = cell && this.at(aim)?.settings;
    const key = cell && JSON.stringify([sweep.key, cell.place]);
    this.pointerRun?.want(settings ? { key, follow: bare(settings, found.plan.observer) } : null);
    pad.setAttribute("aria-valuenow", String(Math.round(100 * (aim?.[0] ?? 0))));
    setAttribute(pad, "aria-valuetext", text);
  }

  describe(shown) {
    const { shows } = shown.settings.over;
    if (shows === "nothing") return this.tell("off");
    const { sweep, sweep: { found } } = this;
    return this.tell(found ? mapInWords(sweep, shows, this.title(found.plan, shows)) : stateInWords(sweep));
  }
}

/** The controls of the map: what it shows, of which observer, and the setting along each axis. */
export function mapTopic(panel, axesOf) {
  const { lab, model } = panel;
  const plan = () => {
    const functions = lab.kernels.of(lab.settings);
    return functions && planOf(lab.settings, model, axesOf, functions);
  };
  const set = (part) => (value) => lab.change(changeAt(lab.settings, `over.${part}`, value), true);
  const titles = Object.fromEntries(Object.entries(model.observers).map(([name, { title }]) => [name, title]));
  const shows = select({
    ...{ name: "map shows", label: "shows", choices: SHOWS, set: set("shows") },
    get: () => lab.settings.over.shows,
  });
  const observer = select({
    ...{ name: "map observer", label: "observer", choices: titles, set: set("observer") },
    get: () => {
      const { over, observers } = lab.settings;
      return observers.includes(over.observer) ? over.observer : observers[0];
    },
    possible: (name) => lab.settings.observers.includes(name),
  });
  const axes = ["across", "up"].map((part) => axisChoice(part, set(part), plan));
  const rows = [observer, ...axes].map((control) => panel.add(control));
  const meaning = element("p", { class: "meaning" }, MEANING);
  const more = panel.onlyIf(({ over }) => over.shows !== "nothing", ...rows, meaning);
  const body = topic("over", "Map over two settings", panel.add(shows), more);
  listen(body, { "pointerenter focusin toggle": () => lab.planes.find((plane) => plane.sweep).openWorker() });
  return body;
}

/** A choice among the axes that have a meaning at present, besides that of the other side. */
function axisChoice(part, set, plan) {
  const control = select({ name: `map ${part}`, label: part, set, choices: {}, get: () => "" });
  const [box] = control.parts;
  let shownFor = "";
  const show = () => {
    const now = plan();
    if (!now) return;
    const axes = now.axes.filter((axis) => axis !== now[part === "across" ? "up" : "across"]);
    const key = axes.map(({ place }) => place).join();
    const option = ({ place, label }) => element("option", { value: place }, label);
    if (key !== shownFor) box.replaceChildren(...axes.map(option));
    shownFor = key;
    box.value = now[part]?.place ?? "";
  };
  return { ...control, show };
}
