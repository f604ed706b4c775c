// What a lab shows: two pictures of one time, charts to move it, one sentence, questions, and a few handles.

import { between, within } from "../engine/between.js";
import { button, element, setAttribute, setText } from "../draw/dom.js";
import { Handle } from "../draw/handle.js";
import { TimeChart } from "../draw/chart.js";
import { chartInWords } from "../draw/lines.js";
import { readable } from "../draw/scales.js";
import { View } from "../draw/view.js";
import { same } from "../state/settings.js";
import { Clock, LONGEST_STALL } from "./clock.js";
import { Questions } from "./questions.js";

/** Letters from which on a sentence is written smaller. */
const LONG = 64;
/** Milliseconds of rest after which a sentence is read out. */
const SPOKEN_AFTER = 500;

/**
 * @typedef {object} Scene     what is shown
 * @property {any} shown       the result
 * @property {any} ghost       the result of the kept run, or null
 * @property {any} chosen      the run that arrows and sentence are about
 * @property {string} kept     name of the kept run
 * @property {number} now      time in seconds
 * @property {number} end      last time in sight
 * @property {{low: number, high: number}} span  the part of the time in sight
 * @property {{sample: number, part: number}} at  place of the time between samples
 * @property {boolean} why     whether the copies at other distances are shown
 * @property {boolean} secret  whether the future of the estimate is hidden
 * @property {any} theme
 * @property {any} [body]      what a lab has read off the result for this time
 * @property {any} [worlds]    that make what is seen, of a lab that looks at several
 */

/**
 * The screen of a lab.  A screen of its own puts handles into the pictures, and has methods of a scene, or `parts`,
 * functions of the screen and a scene: `drawImage`, `drawWorld`, `chartOf`, what the chart holds, `sentence`.
 */
export class Screen {
  static parts = /** @type {any} */ ({});
  /** @type {Handle[]} */
  handles = [];
  why = false;
  /** True once the hand has changed something. */
  moved = false;
  drawn = 0;
  /** @type {Scene | null} the last one that was drawn */
  scene = null;
  /** Time under the pointer. */
  peek = /** @type {number | null} */ (null);
  spoken = "";
  /** Timer of the sentence that is read out. */
  timer = 0;
  /** Settings that were compared with those of the opening, and whether they are the same. */
  compared = null;
  opened = true;

  /** @param {{image: string, world: string, axis: string, why?: boolean}} captions */
  constructor(lab, captions, controls, /** @type {import("./questions.js").Question[]} */ questions) {
    this.lab = lab;
    this.controls = controls;
    this.captions = captions;
    this.clock = new Clock(lab, () => this.questions.asking);
    this.questions = new Questions(lab, this.clock, questions, () => this.turned());
    this.image = new View("image", captions.image, captions.image);
    this.world = new View("world", captions.world, captions.world, true);
    this.chart = new TimeChart("first-chart", captions.axis, this.hands());
    /** @type {Record<string, TimeChart>} */
    this.charts = Object.fromEntries(
      Object.entries(lab.parts.charts).map(([name, title]) => {
        return [name, new TimeChart(`chart-${name}`, title, this.hands())];
      }),
    );
    this.says = element("p", { class: "says" });
    this.aloud = element("p", { class: "unseen", role: "status" });
    this.whyButton = button("Why?", () => this.setWhy(!this.why), {
      ...{ class: "why-button", "data-control": "why", "aria-pressed": "false", hidden: captions.why === false },
    });
    const again = { class: "again", "data-control": "again", hidden: true };
    this.resetButton = button("Start again", () => this.again(), again);
    this.all = button("", () => lab.showAll(), { class: "all", "data-control": "all of the time", hidden: true });
  }

  /** What a hand asks of a chart. */
  hands() {
    const { lab } = this;
    return {
      onTime: (time) => this.clock.put(time),
      onPeek: (time) => {
        if (time === this.peek) return;
        this.peek = time;
        lab.redraw();
      },
      onZoom: (factor, about) => lab.zoom(factor, about),
      onWhole: () => lab.showAll(),
      onRun: (run) => lab.choose(run),
    };
  }

  /** Build the page; `more` opens the drawer. */
  build(more) {
    const { image, world, controls } = this;
    image.figure.append(this.whyButton);
    world.figure.append(this.resetButton);
    this.chart.figure.append(this.all);
    const charts = Object.values(this.charts).map(({ figure }) => figure);
    for (const figure of charts) figure.hidden = true;
    this.body = element(
      "section",
      { class: "screen", "aria-label": "Lab" },
      element("div", { class: "heading" }, this.says, this.aloud, this.questions.strip),
      element("div", { class: "views" }, image.figure, world.figure),
      element("div", { class: "time" }, this.clock.press, this.chart.figure),
      element("div", { class: "charts" }, ...charts),
      element("div", { class: "handy" }, ...controls.map(({ row }) => row), more),
    );
    for (const { figure } of [image, world]) {
      figure.addEventListener("pointerdown", (event) => event.target.closest("button") || this.clock.pause());
    }
    return this;
  }

  get views() {
    return [this.image, this.world, this.chart, ...Object.values(this.charts)];
  }

  /** Let the charts of these names stand below the first. */
  showCharts(names) {
    for (const [name, { figure }] of Object.entries(this.charts)) figure.hidden = !names.includes(name);
  }

  /** Begin to play once the screen is in sight. */
  follow() {
    this.lab.resize();
    const seen = new IntersectionObserver((entries) => {
      if (!entries.some(({ isIntersecting }) => isIntersecting) || this.clock.begun) return;
      seen.disconnect();
      this.clock.begin(() => !this.moved && !this.questions.open);
    });
    seen.observe(this.body);
    this.leave = () => seen.disconnect();
  }

  close() {
    this.clock.pause();
    clearTimeout(this.timer);
    this.leave?.();
  }

  /** Put a handle into a picture; `onMove` takes its place in the picture's own coordinates. */
  handle(view, { name, label, onMove, ...more }) {
    const made = new Handle({
      ...{ name, label: `${label}: drag it, or use the arrow keys`, className: "grip", ...more },
      onMove: (place) => {
        this.touch();
        onMove(place);
      },
      onRest: () => this.lab.rest(),
    });
    view.figure.append(made.node);
    this.handles.push(made);
    return made;
  }

  /** The hand has changed something: nothing is secret any more. */
  touch() {
    this.moved = true;
    this.clock.secret = false;
    this.clock.waiting = false;
  }

  /** Take changes, and show from the start what they do. */
  replay(changes) {
    this.clock.pause();
    this.moved = true;
    this.clock.rewind(true);
    this.lab.change(changes, true);
  }

  /** Forget what is not in the settings, for they are about something else now. */
  renew() {}

  turned() {
    this.setWhy(false);
    this.renew();
  }

  again() {
    this.turned();
    this.moved = false;
    this.clock.secret = this.clock.waiting = true;
    this.lab.reset();
  }

  setWhy(on) {
    this.why = on;
    setAttribute(this.whyButton, "aria-pressed", String(on));
    this.lab.redraw();
  }

  /** True while nothing was changed. */
  get opening() {
    const { settings, model } = this.lab;
    if (this.compared !== settings) Object.assign(this, { compared: settings, opened: same(settings, model.opening) });
    return this.opened;
  }

  /** Draw what is shown, as one scene. */
  draw(shown, ghost, theme) {
    const { lab, clock, questions, why } = this;
    // Nobody sees a lab that is folded away; it is drawn when it has a size again.
    if ([this.image, this.world, this.chart].some((view) => !view.measure())) return;
    clock.follow();
    const [now, { secret }, { span }] = [clock.present(), clock, lab];
    const kept = (questions.answered && questions.open?.kept) || "kept run";
    const chosen = lab.chosenOf(shown);
    const end = within(shown.time[shown.time.length - 1], span.low, span.high);
    const scene = { shown, ghost, chosen, kept, now, end, span, at: between(shown.time, now), why, secret, theme };
    const stamp = performance.now();
    const passed = Math.min(stamp - this.drawn, LONGEST_STALL);
    const motion = { held: lab.held, still: clock.still.matches, passed };
    this.drawn = stamp;
    this.scene = scene;
    const noteOn = (name) => questions.note(name, scene);
    this.resetButton.hidden = (!this.moved && this.opening) || Boolean(questions.open);
    const times = { span, now, peek: this.peek };
    const late = [
      this.drawImage(scene, motion, noteOn("image")),
      this.drawWorld(scene, motion, noteOn("world")),
      this.chart.draw({ ...this.chartOf(scene), note: noteOn("chart") }, times, theme, motion),
      ...this.drawCharts(scene, times, motion),
    ];
    this.showSpan(span);
    questions.show();
    this.say(questions.sentence(scene) || this.sentence(scene));
    clock.show();
    for (const control of this.controls) control.show();
    // A view on its way is drawn once more.
    if (late.some(Boolean)) lab.redraw();
  }

  /** Draw the charts below the first. */
  drawCharts(scene, times, motion) {
    const { lab, charts } = this;
    return lab.state.view.charts.filter((name) => charts[name]?.measure()).map((name) => {
      const parts = lab.parts.chartOf(name, scene, times.span, lab);
      return parts ? charts[name].draw(parts, times, scene.theme, motion) : false;
    });
  }

  /** Say which part of the time is shown, if it is one. */
  showSpan({ low, high }) {
    const { whole } = this.lab;
    const all = high - low > (1 - 1e-6) * (whole.high - whole.low);
    this.all.hidden = all;
    if (!all) setText(this.all, `${readable(high - low)} of ${readable(whole.high - whole.low)} s, show all`);
  }

  /** Say one sentence; who does not see it hears it when it stays. */
  say(text) {
    if (text === this.spoken) return;
    this.spoken = text;
    setText(this.says, text);
    this.says.classList.toggle("long", text.length > LONG);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => setText(this.aloud, text), SPOKEN_AFTER);
  }

  describe() {
    const { spoken } = this;
    for (const view of [this.image, this.world, this.chart]) view.tell(spoken);
    for (const [name, chart] of Object.entries(this.charts)) {
      if (chart.chart && this.lab.state.view.charts.includes(name)) chart.tell(chartInWords(chart.chart));
    }
    for (const handle of this.handles) handle.describe();
  }

  /** @returns {boolean} true while the view is on its way */
  drawImage(...given) {
    return partsOf(this).drawImage(this, ...given);
  }

  drawWorld(...given) {
    return partsOf(this).drawWorld(this, ...given);
  }

  /** @returns {import("../draw/chart.js").Chart} */
  chartOf(scene) {
    return partsOf(this).chartOf(this, scene);
  }

  /** @returns {string} */
  sentence(scene) {
    return partsOf(this).sentence(this, scene);
  }
}

const partsOf = (screen) => screen.constructor.parts;
