// A line is typed once more, letter by letter: the clock of that, and the chart that one drags.

import { element, setAttribute } from "../../../draw/dom.js";
import { within } from "../../../engine/between.js";
import { Clock } from "../../../ui/clock.js";
import { Misses } from "./misses.js";

/** A clock whose time is how many characters of a line are shown. */
export class Replay extends Clock {
  constructor(lab) {
    const point = (at) => this.stand(at);
    const asked = { point, span: { low: 0 }, redraw: () => lab.schedule(), zoom() {}, showAll() {} };
    super(Object.assign(lab, asked), () => false);
    this.chart = new Misses((at) => this.put(at));
    this.body = element("div", { class: "time" }, this.press, this.chart.figure);
  }

  /** The line that is shown: the chosen one, or the first that has beginnings that were judged. */
  get line() {
    const { answer, chosen } = this.lab;
    const grown = Object.entries(answer?.grown ?? {}).filter(([, parts]) => parts.length);
    const [key, parts] = grown.find(([name]) => name === chosen) ?? grown[0] ?? ["", []];
    return { key, parts, text: answer?.settings?.typed[key] ?? "" };
  }

  get end() {
    return this.line.text.length;
  }

  present() {
    return within(this.lab.state.cursor ?? this.end, 0, this.end);
  }

  /** How many characters are shown; null for the line as it is. */
  get at() {
    return this.present() < this.end ? Math.floor(this.present()) : null;
  }

  /** The last beginning that is complete where the line stands; null before the first. */
  get part() {
    const { at } = this;
    return at === null ? null : (this.line.parts.filter(({ end }) => end <= at).at(-1) ?? null);
  }

  /** Play once when the desk comes in sight, unless motion is not wanted or somebody has begun. */
  watch(body) {
    if (this.still.matches || !this.line.parts.length) return;
    this.stand(0);
    const seen = new IntersectionObserver((entries) => {
      if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
      seen.disconnect();
      this.begin(() => this.lab.state.cursor === 0);
    });
    seen.observe(body);
  }

  /** Show so much of the line; null for the line as it is. */
  stand(at) {
    this.lab.state.cursor = at;
    this.lab.schedule();
  }

  stop() {
    this.pause();
    this.stand(null);
  }

  /** Motions that are shown: of a line that is played, or cannot be read yet, as far as it stands there. */
  motions(picture) {
    const { at, part, line } = this;
    const row = picture.names.findIndex((name) => line.key.endsWith(` ${name}`));
    if (row < 0 || (at === null && picture.mine[row] !== null)) return { ...picture, whole: picture.mine };
    const shown = at === null ? line.parts.at(-1) : part;
    const over = shown?.field ?? picture.field.places.map(() => null);
    const field = { ...picture.field, mine: picture.field.mine.with(row, over) };
    return { ...picture, whole: picture.mine, mine: picture.mine.with(row, shown?.at ?? null), field };
  }

  draw(theme) {
    const { text, parts } = this.line;
    this.body.hidden = !parts.length;
    if (this.body.hidden) return;
    this.chart.draw(text, parts, this.at ?? text.length, theme);
    this.show();
    const word = this.still.matches ? "Step" : this.playing ? "Pause" : "Play";
    setAttribute(this.press, "aria-label", `${word} the typing of this line; arrow keys go through it`);
  }
}
