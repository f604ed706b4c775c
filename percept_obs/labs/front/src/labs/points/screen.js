// The screen of the lab of many points: a body's estimate is pulled, mark by mark, on to the rays of the marks.

import { Screen } from "../../ui/screen.js";
import { firstOf } from "../../ui/sentences.js";
import { within } from "../../engine/between.js";
import { PointsEngine } from "./engine.js";
import { QUESTIONS } from "./questions.js";
import { PARTS, seenOf, SENTENCES } from "./sentences.js";
import { drawImage } from "./image.js";
import { chartOf, controlsOf } from "./told.js";
import { drawWorld } from "./world.js";

const CAPTIONS = { image: "What the camera sees", world: "The world from above", axis: "How far the estimate is off" };
/** Marks in sight that a hand may move and hide. */
const IN_HAND = 3;
/** Shares of the given error with which the estimate may start. */
const [LEAST_ERROR, MOST_ERROR] = [0.5, 4];
/** How much the copy of the first look grows and shrinks, and milliseconds of a swing. */
const [SWING, SWINGS] = [0.45, 2600];

export class PointsScreen extends Screen {
  static parts = { drawImage, drawWorld, chartOf };
  /** Amounts of the directions that no picture shows, as a hand has dragged the copy. */
  amounts = /** @type {number[] | null} */ (null);
  looked = 0;

  constructor(lab) {
    super(lab, CAPTIONS, controlsOf(lab), QUESTIONS);
    this.clock.firstLook = SWINGS;
    this.engine = new PointsEngine(lab.model);
    this.marks = Array.from({ length: IN_HAND }, (_, k) =>
      this.handle(this.image, {
        ...{ name: `mark ${k + 1}`, label: `Mark ${k + 1}, the ${PARTS[k]}; press it to hide it` },
        onMove: (place) => this.aim(k, place),
        onPress: () => this.hide(k),
      }),
    );
    this.begin = this.handle(this.world, {
      ...{ name: "estimate", label: "The estimate's start", nudge: 0.1 },
      onMove: (place) => this.startAt(place),
    });
    this.twin = this.handle(this.world, {
      ...{ name: "copy", label: "A copy with the same pictures", nudge: 0.25 },
      onMove: (place) => this.slide(place),
    });
  }

  renew() {
    this.amounts = null;
  }

  // What a hand does.

  /** Move a mark of the body to a direction, at the depth that it has now; none of a body that is drawn late. */
  aim(k, [y1, y2]) {
    const { body, places } = this.seen;
    if (places.length !== this.lab.settings.points.length) return;
    const depth = places[k][2];
    this.lab.change({ points: body.movedTo(k, [y1 * depth, y2 * depth, depth]) });
  }

  /** Hide a mark from now on, or show it; at both ends of the time, for all of it. */
  hide(k) {
    const { hidden, duration } = this.lab.settings;
    if (k >= hidden.length) return;
    const now = this.clock.present();
    const whole = now <= this.clock.start || now >= this.clock.end;
    const from = whole ? 0 : now;
    const away = hidden[k] && hidden[k][0] <= now && now < hidden[k][1];
    const times = away ? (from > hidden[k][0] ? [hidden[k][0], from] : null) : [from, duration + 1];
    this.touch();
    this.renew();
    this.lab.change({ hidden: hidden.with(k, times) }, true);
  }

  /** Let the estimate start so that its first mark is as near to a place as its error's direction allows. */
  startAt([x, z]) {
    const [error] = [this.lab.settings.error];
    const [from, to] = [this.seen.inWorld[0], this.seen.foundInWorld[0]];
    const way = [to[0] - from[0], to[2] - from[2]];
    const part = ((x - from[0]) * way[0] + (z - from[2]) * way[1]) / Math.hypot(...way) ** 2;
    if (Number.isFinite(part)) this.lab.change({ error: within(part * error, LEAST_ERROR, MOST_ERROR) });
  }

  slide(place) {
    this.amounts = this.seen.body.amountsTo(this.seen.held, place);
    this.lab.redraw();
  }

  // What is seen at a time.

  look(scene) {
    const { lab: { model, kernels }, engine } = this;
    const { now, secret, why } = scene;
    const seen = seenOf({ engine, model, kernels }, scene);
    const { body, places, found } = seen;
    const world = (list) => list.map((place) => body.toWorld(place));
    const untouched = !this.questions.open && !this.moved && !this.clock.playing;
    const prelude = secret && !this.left && now <= this.clock.start && untouched;
    if (!prelude) this.left = true;
    let copy = /** @type {number[][] | null} */ (null);
    if (prelude) {
      // Nothing moves before somebody looks.
      if (!this.clock.begun) this.looked = performance.now();
      this.looked ||= performance.now();
      const size = Math.exp(SWING * Math.sin((2 * Math.PI * (performance.now() - this.looked)) / SWINGS));
      copy = places.map((place) => place.map((value) => size * value));
    } else if (seen.free && !secret && !why) {
      if (this.amounts?.length !== body.unseen.length) this.amounts = body.larger();
      copy = body.copy(this.amounts);
    }
    this.seen = {
      ...seen,
      ...{ prelude, copy, inWorld: world(places), foundInWorld: world(found), copyInWorld: copy && world(copy) },
      sees: !prelude && !why,
    };
    scene.body = body;
    return this.seen;
  }

  seen = /** @type {any} */ (null);
  /** True once the copy of the first look was left behind. */
  left = false;

  sentence(scene) {
    return firstOf(SENTENCES, { ...scene, ...this.seen, verdicts: this.lab.model.verdicts, moved: this.moved });
  }
}
