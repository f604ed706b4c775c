// The derivation desk: steps are filled in line by line, and judged while somebody types.

import { same } from "../../state/settings.js";
import { themeOf } from "../../draw/canvas.js";
import { LabBase } from "../../ui/lab_base.js";
import { answerTo } from "./model/answers.js";
import { Sheet as Judge, sheetName } from "./model/sheet.js";
import { build } from "./page/layout.js";
import { Panel, WORDS } from "./page/panel.js";
import { agrees, MotionPicture } from "./page/picture.js";
import { Replay } from "./page/replay.js";
import { Sheet } from "./page/sheet.js";

/** Settings that a sheet, and verdicts and hints are of, and what Python says of these. */
const SHEET = ["student", "motion", "surface", "outputs", "observer", "part", "step"];
const JUDGED = [...SHEET, "typed", "hints"];
const FROM_PYTHON = ["words", "right", "hint", "says"];
/** Milliseconds without typing after which what is not right is said. */
const PAUSE = 1000;

export class DeskLab extends LabBase {
  calm = true;
  /** Key of the line that has, or last had, the focus. */
  chosen = "";
  drawnAt = 0;
  judges = new WeakMap();

  constructor(widget, place, model) {
    super(widget, model, WORDS);
    this.picture = new MotionPicture(this);
    this.replay = new Replay(this);
    this.sheet = new Sheet(this);
    this.panel = new Panel(this);
    /** @type {any} Python's last answer, with the settings that it is of */
    this.heard = { ...widget.get("analysis"), settings: this.settings };
    /** True if there is no Python that could say more. */
    this.alone = !widget.save_changes;
    this.answer = this.found(this.settings);
    this.follow(build(this, place));
    this.replay.watch(this.sheet.body);
  }

  get figures() {
    return [this.picture, this.replay.chart];
  }

  close() {
    super.close();
    this.replay.pause();
  }

  /** Take what stands in a line; hints on its step close, but for which lines are right. */
  type(key, text) {
    this.replay.stop();
    const { typed: { [key]: _old, ...typed }, hints } = this.settings;
    if (text) typed[key] = text;
    this.change({ typed, hints: hints[this.step] > 1 ? { ...hints, [this.step]: 1 } : hints });
  }

  /** The key of the step's hints. */
  get step() {
    return `${this.settings.part} ${this.answer?.step ?? this.settings.step}`;
  }

  openHint(number) {
    this.change({ hints: { ...this.settings.hints, [this.step]: number } }, true);
  }

  turnTo(step) {
    this.choose("");
    this.change({ step }, true);
  }

  /** The focus has come to a line: it is the one that is shown. */
  choose(key) {
    this.replay.stop();
    this.chosen = key;
    this.schedule();
  }

  /** Open or close the drawer; no step, for the buttons that lead back stand in it. */
  unfold() {
    const { view } = this.state;
    this.state.amend({ view: { ...view, more: view.more ? "" : "choices" } });
    this.schedule();
  }

  touched(chosen) {
    clearTimeout(this.resting);
    this.calm = chosen;
    this.panel.show();
    if (!chosen) this.resting = setTimeout(() => this.rest(), PAUSE);
    if (chosen) this.rest();
    else this.tell();
  }

  /** Nobody types any more: one step of the history ends, and what is not right may be said. */
  rest() {
    clearTimeout(this.resting);
    this.state.release();
    Object.assign(this, { resting: null, calm: true });
    this.tell();
  }

  /** Tell Python what is there, unless it knows. */
  tell() {
    this.schedule();
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
    const name = sheetName(settings, model.given);
    const printed = this.widget.get("sheets")?.[name] ?? model.sheets[name];
    if (!printed) return alone ? { problem: model.said["unknown system"], settings } : null;
    if (printed.problem) return { ...printed, settings };
    if (!this.judges.has(printed)) this.judges.set(printed, new Judge(printed, model.markup.letters, model.said));
    const judge = this.judges.get(printed);
    const told = !alone && heard.lines && JUDGED.every((each) => same(heard.settings[each], settings[each]));
    if (told) judge.hear(heard.lines, settings);
    const own = { ...answerTo(judge, settings, alone), settings };
    if (!told) return own;
    const lines = own.lines.map((line, k) => ({ ...line, ...heard.lines[k] }));
    const steps = own.steps.map((step, k) => ({ ...step, ...heard.steps[k] }));
    return { ...own, ...Object.fromEntries(FROM_PYTHON.map((each) => [each, heard[each]])), steps, lines };
  }

  paint() {
    this.pending = false;
    cancelAnimationFrame(this.frame);
    const { settings, replay, view } = this;
    if (this.answer?.settings !== settings) this.answer = this.found(settings) ?? this.answer;
    const { answer } = this;
    const current = answer?.settings === settings;
    this.theme ??= themeOf(view.root);
    this.shown = answer;
    view.problem(answer?.problem ?? "");
    this.panel.unfold(this.state);
    const [open, played] = [Boolean(this.state.view.more), replay.at !== null];
    const waiting = !this.alone && this.heard.settings !== settings && answer?.right !== true;
    view.marked({ open, waiting, played, pictured: Boolean(answer?.picture) });
    if (!answer || answer.problem || !SHEET.every((name) => same(answer.settings[name], settings[name]))) return;
    view.show(answer);
    this.sheet.show(answer, current);
    const now = performance.now();
    const motion = { held: false, still: replay.still.matches, passed: Math.min(now - this.drawnAt, 60) };
    this.drawnAt = now;
    if (answer.picture && this.picture.draw(replay.motions(answer.picture), answer, settings.point, this.theme, motion))
      this.schedule();
    replay.draw(this.theme);
    if (current) view.says(this.sentence(answer));
    if (current && this.calm && !played) view.announce(this.sheet.told(answer));
  }

  /** One sentence: what is seen, or what to do. */
  sentence({ picture, words, right, lines, settings, steps, step, hint }) {
    const { replay, calm, model: { said: { says } } } = this;
    if (replay.at !== null) return replay.part ? says.growing : says.opening;
    const typed = lines.filter(({ key }) => settings.typed[key]);
    if (!typed.length) return picture?.foe ? says.place : picture ? says.empty : says.lines;
    if (!calm && !right) return says.calm;
    if (typed.some(({ refusal }) => refusal)) return says.unread;
    if (right && typed.length === lines.length) return `${words} ${step < steps.length ? says.next : says.last}`;
    const alike = picture && agrees(picture);
    if (right && alike) return says.agreed;
    if (right !== false || lines.some(({ mark }) => mark === "begun")) return words;
    if (alike) return `${words} ${says.hidden}`;
    const marked = lines.some(({ pieces }) => pieces.some((piece) => piece.includes('class="slip"')));
    return `${words} ${marked ? says.marked : hint ? says.hints : ""}`;
  }
}
