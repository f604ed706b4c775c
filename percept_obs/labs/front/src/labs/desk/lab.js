// The derivation desk: steps are filled in line by line, and Python says what it finds while somebody types.

import { changeAt, same } from "../../state/settings.js";
import { themeOf } from "../../draw/canvas.js";
import { LabBase } from "../../ui/lab_base.js";
import { build } from "./page/layout.js";
import { Panel, WORDS } from "./page/panel.js";
import { agrees, MotionPicture } from "./page/picture.js";
import { Replay } from "./page/replay.js";
import { answerTo, Sheet as Judge, sheetName } from "./model/answers.js";
import { Sheet } from "./page/sheet.js";

const DEBOUNCE = 20;
/** Settings that verdicts and hints are of, and what Python says of them. */
const SHEET = ["student", "motion", "surface", "outputs", "observer", "part", "step"];
const JUDGED = [...SHEET, "typed", "hints"];
const FROM_PYTHON = ["words", "right", "hint", "says"];
/** Milliseconds without typing after which a text that may not be complete is judged. */
const PAUSE = 1000;
/** Milliseconds after which it is said that Python is at work. */
const SLOW = 250;
const OPENING = "How does the image move? Watch a line being derived.";
const GROWING = "Each term bends the blue arrow. With all of them right it lies on the true one.";
const LINES = "Type the lines of this step, one after the other.";
const AGREED = "Right, here and everywhere: both arrows are one. Type the next line.";
const PLACE = "Where does distance drop out of the motion? A ring shows the place that you type.";
const EMPTY = "Type what you derive: a blue arrow shows the motion that it means.";

export class DeskLab extends LabBase {
  constructor(widget, place, model) {
    super(widget, model, WORDS);
    this.calm = true;
    /** @type {any} the timer of what is told to Python next */
    this.telling = null;
    /** @type {any} the timer after which it is said that Python is at work */
    this.slow = null;
    /** @type {"first" | "workbench"} */
    this.face = widget.get("face") ?? "first";
    /** True once somebody has typed. */
    this.byHand = false;
    /** Key of the line that has, or last had, the focus. */
    this.chosen = "";
    this.drawnAt = 0;
    this.picture = new MotionPicture(this);
    this.replay = new Replay(this);
    this.sheet = new Sheet(this);
    this.panel = new Panel(this);
    /** @type {any} Python's last answer, with the settings that it is of */
    this.heard = { ...widget.get("analysis"), settings: this.settings };
    /** True if there is no Python that could say more. */
    this.alone = !widget.save_changes;
    this.judges = new WeakMap();
    this.answer = this.found(this.settings);
    this.follow(build(this, place));
    if (this.face === "first") this.replay.follow();
  }

  get figures() {
    return [this.picture, this.replay.chart];
  }

  /** Show the first screen, or the workbench, of the same lines. */
  turn(face) {
    this.face = face;
    this.replay.stop();
    this.view.turn(face);
    this.schedule();
  }

  close() {
    super.close();
    this.replay.pause();
    clearTimeout(this.slow);
    clearTimeout(this.telling);
  }

  // What the hand does.

  /** Take what stands in a line; hints on its step close, but for which lines are right. */
  type(key, text) {
    this.replay.stop();
    this.byHand = true;
    const { [key]: _old, ...others } = this.settings.typed;
    const typed = text ? { ...others, [key]: text } : others;
    const step = this.stepKey();
    const open = this.settings.hints[step] ?? 0;
    this.change({ typed, hints: open > 1 ? { ...this.settings.hints, [step]: 1 } : this.settings.hints });
  }

  stepKey() {
    return `${this.settings.part} ${this.answer?.step ?? this.settings.step}`;
  }

  openHint(number) {
    this.change({ hints: { ...this.settings.hints, [this.stepKey()]: number } }, true);
  }

  turnTo(step) {
    this.replay.stop();
    this.chosen = "";
    this.change({ step }, true);
  }

  movePoint([y1, y2]) {
    this.change(changeAt(changeAt(this.settings, "point.0", y1), "point.1", y2));
  }

  /** The focus has come to a line: it is the one that is shown. */
  choose(key) {
    this.replay.stop();
    if (this.chosen === key) return;
    this.chosen = key;
    this.schedule();
  }

  /** The line whose growth is shown: the chosen one, or the first that has some. */
  shownLine() {
    const grown = Object.entries(this.answer?.grown ?? {}).filter(([, parts]) => parts.length);
    const key = (grown.find(([name]) => name === this.chosen) ?? grown[0])?.[0] ?? "";
    return { key, text: this.answer?.settings.typed[key] ?? "" };
  }

  /** Motions that are shown: of a line that is played, or cannot be read yet, as far as it stands there. */
  motions() {
    const { picture } = this.answer;
    const { at, part, line } = this.replay;
    const row = picture.names.findIndex((name) => line.key.endsWith(` ${name}`));
    if (row < 0 || (at === null && picture.mine[row] !== null)) return { ...picture, whole: picture.mine };
    const shown = at === null ? line.parts.at(-1) : part;
    const put = (values, value) => values.map((old, k) => (k === row ? value : old));
    const none = picture.field.places.map(() => null);
    const field = { ...picture.field, mine: put(picture.field.mine, shown?.field ?? none) };
    return { ...picture, whole: picture.mine, mine: put(picture.mine, shown?.at ?? null), field };
  }

  touched(chosen) {
    clearTimeout(this.telling);
    clearTimeout(this.resting);
    this.calm = chosen;
    if (chosen) {
      this.panel.show();
      this.rest();
    } else {
      this.resting = setTimeout(() => this.rest(), PAUSE);
      this.telling = setTimeout(() => this.tell(), DEBOUNCE);
    }
    this.schedule();
  }

  /** Nobody types any more: one step of the history ends, and what is not right may be said. */
  rest() {
    clearTimeout(this.resting);
    this.resting = null;
    this.state.release();
    this.calm = true;
    this.tell();
    this.schedule();
  }

  /** Tell Python what is there, unless it knows. */
  tell() {
    clearTimeout(this.telling);
    if (this.closed || this.link?.sent?.settings === this.settings) return;
    this.link?.send(this.settings, { serial: ++this.serial });
  }

  analysed(answer) {
    this.heard = answer;
    this.answer = this.found(this.settings) ?? this.answer;
    this.schedule();
  }

  /** What the page finds by itself, with what Python has said of the same lines; null while it has no such sheet. */
  found(settings) {
    const { model, heard, alone } = this;
    const printed = this.widget.get("sheets")?.[sheetName(settings, model.given)] ??
      model.sheets[sheetName(settings, model.given)];
    if (!printed) return alone ? { problem: model.said["unknown system"], settings } : null;
    if (printed.problem) return { ...printed, settings };
    if (!this.judges.has(printed)) this.judges.set(printed, new Judge(printed, model.reader, model.said));
    const own = { ...answerTo(this.judges.get(printed), settings, alone), settings };
    if (alone || !heard.lines || !JUDGED.every((name) => same(heard.settings[name], settings[name]))) return own;
    const told = Object.fromEntries(FROM_PYTHON.map((name) => [name, heard[name]]));
    const steps = own.steps.map((step, k) => ({ ...step, ...heard.steps[k] }));
    const lines = own.lines.map(({ refusal: _, ...line }, k) => ({ ...line, ...heard.lines[k] }));
    return { ...own, ...told, steps, lines };
  }

  // What is shown.

  /** Return true if Python's answer is about the text that stands in a line now. */
  isOf(key) {
    return this.answer?.settings.typed[key] === this.settings.typed[key];
  }

  paint() {
    this.pending = false;
    cancelAnimationFrame(this.frame);
    const { settings, replay } = this;
    if (this.answer?.settings !== settings) this.answer = this.found(settings) ?? this.answer;
    const { answer } = this;
    const current = answer?.settings === settings;
    const sameSheet = SHEET.every((name) => same(answer?.settings[name], settings[name]));
    const sameLines = sameSheet && same(answer.settings.typed, settings.typed);
    this.theme ??= themeOf(this.view.root);
    this.shown = answer;
    this.view.problem(answer?.problem ?? "");
    this.view.show(answer, sameSheet);
    this.view.steps(this.state);
    if (sameSheet && !answer.problem) this.sheet.show(answer, current);
    const silent = this.alone || this.heard.settings === settings;
    this.watch(current && (silent || answer.right !== false));
    const plain = settings.motion === "affine" && settings.surface === "pinhole" && !settings.student.trim();
    const usual = plain && !this.model.given;
    this.view.marked({ pictured: Boolean(answer?.picture), played: replay.at !== null, usual });
    if (sameLines && answer.picture) this.draw();
    if (sameLines) replay.show(this.theme);
    if (current) this.view.says(this.sentence(answer));
    if (current && this.calm && replay.at === null) this.view.announce(answer.problem ? "" : this.sheet.told(answer));
  }

  draw() {
    const { answer, settings, replay } = this;
    const now = performance.now();
    const motion = { held: false, still: replay.still.matches, passed: Math.min(now - this.drawnAt, 60) };
    this.drawnAt = now;
    const moving = this.picture.draw(this.motions(), answer.settings.point, settings.point, this.theme, motion);
    if (moving) this.schedule();
  }

  /** Say that Python is at work where its answer takes longer than a blink. */
  watch(current) {
    if (current) {
      clearTimeout(this.slow);
      this.slow = null;
      this.sheet.thinking(false);
    } else this.slow ??= setTimeout(() => this.sheet.thinking(true), SLOW);
  }

  /** One sentence: what is seen, or what to do. */
  sentence(answer) {
    const { replay, calm } = this;
    if (answer.problem) return "";
    if (replay.at !== null) return replay.part ? GROWING : OPENING;
    const typed = answer.lines.filter(({ markup, refusal }) => markup || refusal);
    const { picture } = answer;
    if (!typed.length) return picture ? (picture.foe ? PLACE : EMPTY) : LINES;
    if (!calm && !answer.right) return "Go on: what is not right is told when you pause.";
    if (typed.some(({ refusal }) => refusal)) return "A line cannot be read yet: the place is marked.";
    const last = answer.step === answer.steps.length;
    if (answer.right && typed.length === answer.lines.length)
      return last ? "This step is right, and it is the last one." : "This step is right. Go on to the next one.";
    if (answer.right && picture && agrees(picture)) return AGREED;
    const begun = answer.lines.some(({ mark }) => mark === "begun");
    if (answer.right !== false || begun) return answer.words;
    if (!picture?.mine.some((value) => value !== null)) return `${answer.words} Hints open one by one.`;
    if (agrees(picture)) return "Here the slip hides: the arrows agree, although a line is wrong.";
    const help = answer.hint ? ", or open a hint" : "";
    const told = this.alone ? ` ${this.model.said.alone}` : "";
    return `Your arrow misses the true one: mend the line${help}.${told}`;
  }
}
