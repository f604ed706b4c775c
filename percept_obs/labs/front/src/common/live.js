// What every lab does: settings in, pictures and words out, once a frame and for the latest settings only.

import { themeOf } from "./canvas.js";
import { same } from "./equal.js";
import { Link } from "./link.js";

const REST = 150;
const BETWEEN_WORDS = 250;

/**
 * A lab that follows the hand and tells Python when the hand rests. A lab of its own gives it `kernels`, `figures`,
 * `panel` and `view` before open(), and says in methods of its own:
 *   show(settings)     what is shown of them, for draw(), speak(), describe() and summary(serial)
 *   afterAct(act)      the settings that a preset's act shows
 */
export class Live {
  constructor(widget, model) {
    this.widget = widget;
    this.model = model;
    this.settings = structuredClone(widget.get("settings"));
    this.cursor = null;
    this.width = 800;
    this.serial = 0;
    this.before = null;
    this.pictures = 0;
    this.spoken = 0;
  }

  /** Begin to follow: the hand, the page's size and theme, Python. */
  open() {
    this.link = new Link(this.widget, {
      onSettings: (settings) => this.adopt(settings),
      onAnalysis: (analysis, settings) => settings === this.settings && this.analysed(analysis),
      onError: (text) => this.view.pythonError(text),
      onSilence: (silence) => this.view.silence(silence),
    });
    this.observeSurroundings();
    this.panel.show();
    this.schedule();
    this.rest();
  }

  observeSurroundings() {
    this.sized = new ResizeObserver((entries) => {
      for (const { target, contentRect } of entries) {
        const picture = this.figures.find(({ figure }) => figure === target);
        if (picture) picture.size = { width: contentRect.width, height: contentRect.height };
        else this.width = contentRect.width;
      }
      this.schedule();
    });
    for (const { figure } of this.figures) this.sized.observe(figure);
    this.sized.observe(this.view.root);
    this.themed = new MutationObserver(() => this.retheme());
    this.themed.observe(document.body, { attributes: true, attributeFilter: ["data-jp-theme-light", "class"] });
    this.scheme = window.matchMedia("(prefers-color-scheme: dark)");
    this.onScheme = () => this.retheme();
    this.scheme.addEventListener("change", this.onScheme);
  }

  retheme() {
    this.theme = null;
    this.schedule();
  }

  close() {
    this.closed = true;
    cancelAnimationFrame(this.frame);
    clearTimeout(this.resting);
    this.link.close();
    this.sized.disconnect();
    this.themed.disconnect();
    this.scheme.removeEventListener("change", this.onScheme);
  }

  /** Take changed settings; what is chosen rather than moved is told to Python at once. */
  change(changes, chosen = false) {
    this.settings = { ...this.settings, ...changes };
    this.touched(chosen);
  }

  /** Take whole settings: of a preset, of Reset, of the way back. */
  replace(settings) {
    this.settings = structuredClone(settings);
    this.touched(true);
  }

  /** Take settings that Python has set. */
  adopt(settings) {
    if (!same(settings, this.settings)) this.replace(settings);
  }

  touched(chosen) {
    this.schedule();
    if (!chosen) return this.restSoon();
    this.view.notice("");
    this.settings = this.fitted(this.settings);
    // What a choice hides must be gone before the next event can reach it.
    this.panel.show();
    return this.rest();
  }

  /** What is shown, and what is kept to compare with. */
  wanted(settings) {
    return settings.kept ? [settings, settings.kept] : [settings];
  }

  /** Whether all that these settings need is there, so that they can be shown at once. */
  ready(settings) {
    return this.wanted(settings).every((s) => this.kernels.of(s));
  }

  /** A promise of it. */
  prepare(settings) {
    return Promise.all(this.wanted(settings).map((s) => this.kernels.prepare(s)));
  }

  allows(observer, gain, value) {
    return this.kernels.allows(observer, gain, value);
  }

  /** The settings, or those that take their place where they are impossible. */
  fitted(settings) {
    return settings;
  }

  restSoon() {
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.rest(), REST);
  }

  /** The hand rests: tell Python, and those who listen. */
  async rest() {
    clearTimeout(this.resting);
    this.resting = null;
    if (this.pending) this.paint();
    const { settings } = this;
    try {
      await this.prepare(settings);
    } catch (error) {
      this.fail(error);
      return;
    }
    if (this.closed || settings !== this.settings) return;
    if (this.pending || this.shown?.settings !== settings) this.paint();
    if (this.shown?.settings !== settings) return;
    this.speakNow();
    this.link.send(settings, this.summary(++this.serial));
    this.describe();
    this.view.rested();
  }

  schedule() {
    if (this.pending || this.closed) return;
    this.pending = true;
    this.frame = requestAnimationFrame(() => this.pending && this.paint());
  }

  paint() {
    this.pending = false;
    cancelAnimationFrame(this.frame);
    const { settings } = this;
    if (!this.ready(settings)) {
      this.wait(settings);
      return;
    }
    try {
      this.shown = this.show(settings);
      this.theme ??= themeOf(this.view.root);
      this.draw();
      this.pictures += 1;
      // Nobody reads sixty texts a second, and the page would lay itself out for each of them.
      if (performance.now() - this.spoken > BETWEEN_WORDS) this.speakNow();
    } catch (error) {
      this.fail(error);
    }
  }

  wait(settings) {
    if (this.awaited === settings) return;
    this.awaited = settings;
    this.prepare(settings).then(
      () => this.awaited === settings && this.schedule(),
      (error) => this.fail(error),
    );
  }

  /** Bring words and controls to what is drawn. */
  speakNow() {
    this.spoken = performance.now();
    this.view.problem("");
    this.panel.show();
    this.speak();
  }

  point(cursor) {
    if (cursor === this.cursor || this.shown?.problem) return;
    this.cursor = cursor;
    this.spoken = 0;
    this.schedule();
  }

  act(preset, number) {
    this.before ??= this.settings;
    this.replace(this.afterAct(preset.acts[number]));
  }

  goBack() {
    if (this.before) this.replace(this.before);
    this.before = null;
  }

  keep() {
    this.change({ kept: this.settings.kept ? null : { ...structuredClone(this.settings), kept: null } }, true);
  }

  reset() {
    this.before = null;
    this.cursor = null;
    this.view.forgetPreset();
    this.replace(this.model.opening);
  }

  /** Take what Python has found out about the settings at rest. */
  analysed({ sentences }) {
    this.view.analysis((sentences ?? []).filter(Boolean));
  }

  say(text) {
    this.view.say(text);
  }

  fail(error) {
    this.view.problem(error.message);
  }
}
