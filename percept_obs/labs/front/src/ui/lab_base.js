// What every page does: it follows the hand, keeps the history of its settings, and tells Python.

import { schemaOf } from "../state/schema.js";
import { same } from "../state/settings.js";
import { State } from "../state/state.js";
import { Link } from "./link.js";

const NULL = /** @type {any} */ (null);

/**
 * Settings with their history, and the link to Python.  A page extends it with a view and figures, with touched(), to
 * be called when settings have changed, paint(), which draws them, and analysed(), which takes Python's answer.
 */
export class LabBase {
  /** Panel, view, result that is shown, Python's answer with its settings, colours, timer while a hand may go on. */
  panel = NULL;
  view = NULL;
  shown = NULL;
  answer = NULL;
  link = NULL;
  theme = NULL;
  resting = NULL;
  width = 800;
  serial = 0;
  frame = 0;
  pending = false;
  closed = false;

  constructor(widget, model, words) {
    this.widget = widget;
    this.model = model;
    this.schema = schemaOf(model.schema, words);
    this.state = new State(structuredClone(widget.get("settings")), structuredClone(widget.get("view") ?? {}));
    this.leave = () => {};
  }

  get settings() {
    return this.state.settings;
  }

  /** True while what is drawn is of settings before the present ones. */
  get late() {
    return false;
  }

  /** @returns {any[]} pictures, each with its figure */
  get figures() {
    return [];
  }

  /** Begin to follow the hand, the page's size and theme, and Python, once the page is built. */
  follow(view) {
    this.view = view;
    this.link = new Link(this.widget, {
      onSettings: (settings) => same(settings, this.settings) || this.replace(settings),
      onView: (view) => same(view, this.state.view) || this.look(structuredClone(view)),
      onAnalysis: (analysis, settings) => this.analysed({ ...analysis, settings }),
      onError: (text) => this.view.pythonError(text),
      onSilence: (silence) => this.view.silence(silence),
    });
    this.leave = this.watchPage(view.root);
    this.panel.show();
    this.schedule();
    this.rest();
  }

  /** Follow sizes and whether the page is dark; return the function that ends it. */
  watchPage(root) {
    const sized = new ResizeObserver((entries) => {
      for (const { target, contentRect } of entries) this.resized(target, contentRect);
    });
    for (const node of [...this.figures.map(({ figure }) => figure), root]) sized.observe(node);
    const scheme = window.matchMedia("(prefers-color-scheme: dark)");
    const themed = () => {
      const light = document.body.dataset.jpThemeLight;
      root.classList.toggle("dark", light ? light === "false" : scheme.matches);
      this.retheme();
    };
    themed();
    const observer = new MutationObserver(themed);
    observer.observe(document.body, { attributes: true, attributeFilter: ["data-jp-theme-light", "class"] });
    scheme.addEventListener("change", themed);
    return () => {
      sized.disconnect();
      observer.disconnect();
      scheme.removeEventListener("change", themed);
    };
  }

  resized(node, { width, height }) {
    const picture = this.figures.find(({ figure }) => figure === node);
    if (picture) picture.resize(width, height);
    else this.width = width;
    this.schedule();
  }

  retheme() {
    this.theme = null;
    this.schedule();
  }

  close() {
    this.closed = true;
    cancelAnimationFrame(this.frame);
    clearTimeout(this.resting);
    for (const control of this.panel?.controls ?? []) control.close?.();
    this.link?.close();
    this.leave();
  }

  /** Change settings; what is chosen rather than moved is a step of its own, and told to Python at once. */
  change(changes, chosen = false) {
    if (chosen) this.state.step({ settings: { ...this.settings, ...changes } });
    else this.state.move(changes);
    this.touched(chosen);
  }

  /** Take whole settings, which Python has set. */
  replace(settings) {
    this.state.step({ settings: structuredClone(settings) });
    this.touched(true);
  }

  /** Look at something else of the same run: a step of its own. */
  look(changes) {
    this.state.look(changes);
    this.looked();
  }

  looked() {}

  reset() {
    this.state.reset(structuredClone(this.model.opening));
    this.touched(true);
  }

  undo() {
    if (this.state.undo()) this.touched(true);
  }

  redo() {
    if (this.state.redo()) this.touched(true);
  }

  touched(_chosen) {}

  rest() {}

  analysed(_answer) {}

  paint() {}

  schedule() {
    if (this.pending || this.closed) return;
    this.pending = true;
    this.frame = requestAnimationFrame(() => this.pending && this.paint());
  }

  say(text) {
    this.view.say(text);
  }

  fail(error) {
    this.view.problem(error.message);
  }
}
