// The screen of the structure lab: a family of worlds makes one film, and what one knows picks one of them.

import { tick } from "../../ui/controls.js";
import { Screen } from "../../ui/screen.js";
import { firstOf } from "../../ui/sentences.js";
import { within } from "../../engine/between.js";
import { isTyped } from "../../engine/typed.js";
import { element } from "../../draw/dom.js";
import { Box } from "../../draw/box.js";
import { keptLine } from "../../draw/lines.js";
import { isSampled } from "./camera.js";
import { QUESTIONS } from "./questions.js";
import { hasStories, NEARLY, seenOf, SENTENCES, speed } from "./sentences.js";
import { knowledgeOf, ratiosOf, TRUE, unknownOf, Worlds } from "./worlds.js";
import { drawMap, placeOfMap } from "./map.js";
import { carAside, HIGH, metres } from "./marks.js";

const CAPTIONS = { image: "Three films", world: "From above", axis: "Estimate over truth" };
/** Sizes of the other worlds at the start; one is moved by hand, between two bounds, as is its story. */
const [HALF, TWICE] = [0.5, 2];
const BOUNDS = { size: [0.3, 2.5], share: [0, 1.5] };
/** Seconds between places of the past, and pixels below the pictures that the caption needs. */
const [EVERY, FOOT] = [1, 30];
/** Part of the run before which a way is too short to be dragged, and of its depth that an object keeps at least. */
const [SHORT, IN_FRONT] = [0.15, 0.1];
/** Words for the reasons of gaps; the first is that of a refused choice. */
const GAPS = ["cannot be told", "speed near zero", "no estimate yet"];
const TOO_FAR = "too far to tell";
/** Metres a second below which a speed is near zero. */
const NEAR_ZERO = 0.1;

export class StructureScreen extends Screen {
  /** Size of the other world that a hand may take, and the camera's share of the motion in it. */
  size = TWICE;
  share = 0.5;
  worlds = /** @type {Worlds} */ (/** @type {any} */ (null));
  /** What is seen, and can be told, at the time that was drawn last. */
  seen = /** @type {any} */ (null);

  constructor(lab) {
    super(lab, CAPTIONS, ticksOf(lab), QUESTIONS);
    this.other = this.handle(this.world, {
      ...{ name: "world", label: "Another world that makes this film", nudge: 0.25 },
      onMove: (place) => this.scale(place),
    });
    this.camera = this.handle(this.world, {
      ...{ name: "camera", label: "The camera, where it has come to", nudge: 0.25 },
      onMove: (place) => this.drive(place),
    });
  }

  build(more) {
    super.build(more);
    this.body.classList.add("of-worlds");
    this.body.querySelector(".handy")?.prepend(element("span", {}, "Known:"));
    return this;
  }

  renew() {
    [this.size, this.share] = [TWICE, 0.5];
  }

  // What a hand does.

  /** Give the other world the size, or the story, with which its object stands nearest to a place of the map. */
  scale([x, z]) {
    const { now } = /** @type {any} */ (this.scene);
    const name = this.stories ? "share" : "size";
    const [from, to] = [0, 1].map((value) => this.worlds.places({ ...this.others[1], [name]: value }, now).object);
    const way = [to[0] - from[0], to[2] - from[2]];
    const part = ((x - from[0]) * way[0] + (z - from[2]) * way[1]) / Math.hypot(...way) ** 2;
    if (!Number.isFinite(part)) return;
    this[name] = within(part, BOUNDS[name][0], BOUNDS[name][1]);
    this.lab.redraw();
  }

  /** Let the camera have come to a place of the map by now: its velocity changes, and the object stays. */
  drive([x, z]) {
    const { now, end } = /** @type {any} */ (this.scene);
    const { start, shown } = this.worlds;
    const way = this.worlds.way(now);
    const [first, last] = [start, end].map((time) => this.worlds.before(time)[2]);
    const change = [x - way[0], 0, z - way[2]].map((value) => value / (now - start));
    change[2] = Math.min(change[2], (last - IN_FRONT * first) / (end - start));
    this.lab.change({ v_c: shown.settings.v_c.map((value, k) => Number((value + change[k]).toFixed(3))) });
  }

  // What is seen at a time.

  /** True where the size is known and both speeds along an axis are open: one film, many stories. */
  get stories() {
    return hasStories(this.worlds.known);
  }

  /** The two worlds beside the true one. */
  get others() {
    const { size, share, stories } = this;
    return stories ? [{ size: 1, share: 0 }, { size: 1, share }] : [{ size: HALF, share: null }, { size, share: null }];
  }

  look(scene) {
    const { lab } = this;
    const { shown } = scene;
    if (this.worlds?.shown !== shown) {
      const functions = lab.kernels.of(shown.settings);
      const { camera } = lab.results.engines[0];
      this.worlds = new Worlds(shown, (times) => camera.velocities(shown.settings, functions, times));
    }
    scene.worlds = this.worlds;
    this.seen = { ...seenOf(this.worlds, scene), others: this.othersAt(scene) };
    return this.seen;
  }

  /** What the other observers estimate now. */
  othersAt({ shown, chosen, at }) {
    const others = shown.runs.filter((run) => run !== chosen);
    return others.map((run) => ({ run, ratio: ratiosOf(this.worlds, shown, run)[at.sample] }));
  }

  /** What another world would need, and whether what is known contradicts that; null where nothing does. */
  against(world) {
    const { known, reading, told, why } = this.seen;
    if (!told && !known.nothing) return null;
    if (known.size) return { text: "", off: world.size !== 1 };
    if (!reading) return null;
    const need = speed(world.size * reading.value);
    return { text: `needs ${need}`, off: why !== NEARLY && need !== speed(reading.value) };
  }

  /** A world's name. */
  nameOf(world) {
    if (!this.stories) return world === TRUE ? "true" : (TIMES[world.size] ?? `×${world.size.toFixed(1)}`);
    const { camera, object } = this.worlds.speeds(world, this.scene?.now ?? 0);
    const stands = (velocity) => Number(speed(Math.hypot(...velocity))) === 0;
    const who = stands(camera) ? "camera stands" : stands(object) ? "car rests" : "both move";
    return world === TRUE ? `true: ${who}` : who;
  }

  /** A world's name with its length, what is read in it, and whether what is known contradicts that. */
  readIn(world, now) {
    const { known, reading } = this.seen;
    const { camera, object } = this.worlds.speeds(world, now);
    const [driven, drives] = [camera, object].map((value) => speed(Math.hypot(...value)));
    const against = this.stories ? null : this.against(world);
    const name = `${this.nameOf(world)}${this.stories ? "" : `: ${metres(world.size * this.worlds.length)} long`}`;
    return [name, ...this.readings({ known, reading, against, driven, drives }, world)];
  }

  readings({ known, reading, against, driven, drives }, world) {
    if (!against && (this.stories || !known.rests)) return [`camera ${driven}, car ${drives} m/s`, false];
    if (!against) return [`camera ${driven} m/s`, false];
    if (known.size) return [world === TRUE ? "as known" : "not as known", against.off];
    const verb = world === TRUE ? `reads ${speed(reading.value)}` : against.text;
    return [`camera ${verb} m/s${reading.along}`, against.off];
  }

  // The film: a strip for each world, and nothing but the words differs.

  drawImage(scene, motion, _note) {
    const { image: view } = this;
    const { theme, now, shown } = scene;
    this.scene = scene;
    this.look(scene);
    const moving = view.glide(this.imageGoal(scene), motion);
    view.begin(theme);
    const { width, height, context: pen } = view;
    const [c1, c2, scale] = /** @type {number[]} */ (view.at);
    const high = (height - FOOT) / 3;
    [this.others[0], TRUE, this.others[1]].forEach((world, k) => {
      const draw = (time, colour, look) => {
        const [y1, y2, length] = this.worlds.image(world, time);
        const at = [width / 2 + (y1 - c1) * scale, high * (k + 0.5) + 12 - (y2 - c2) * scale];
        carAside(view, at, length * scale, colour, look);
      };
      pen.save();
      pen.beginPath();
      pen.rect(0, high * k, width, high);
      pen.clip();
      const past = { full: false, alpha: 0.5 };
      for (let time = shown.time[0]; time < now - 0.4 * EVERY; time += EVERY) draw(time, theme.muted, past);
      draw(now, world === TRUE ? theme.ink : theme.muted);
      pen.restore();
      view.line([[0, high * (k + 1)], [width, high * (k + 1)]], theme.paper, { width: 3 });
      const [name, text, off] = this.readIn(world, now);
      view.write(name, 10, high * k + 13, theme.ink, "left");
      view.write(text, width - 10, high * k + 13, off ? theme.warning : theme.ink, "right");
    });
    view.end();
    return moving;
  }

  /** Middle and scale of the image in which the whole film lies. */
  imageGoal({ shown }) {
    const { image, time } = shown;
    const box = new Box();
    let longest = 0;
    for (let k = 0; k < time.length; k += Math.ceil(time.length / 100)) {
      const [y1, y2, length] = image.subarray(3 * k, 3 * k + 3);
      longest = Math.max(longest, length);
      box.take([y1, y2], [length / 2, (HIGH * length) / 2]);
    }
    const { width, height } = this.image.size ?? { width: 360, height: 300 };
    const [across, up] = box.size.map((side) => Math.max(side, 1e-9));
    const scale = Math.min((width - 24) / across, ((height - FOOT) / 3 - 26) / Math.max(up, HIGH * longest));
    return [...box.middle, Math.max(scale, 1 / across)];
  }

  // The worlds from above, one inside of the other: all cameras begin at one place.

  drawWorld(scene, motion, note) {
    const { world: view, seen, worlds } = this;
    const { now, end } = scene;
    const moving = view.glide(placeOfMap(this, scene), motion);
    const frame = drawMap(view, this, scene, note);
    const { late, settings } = this.lab;
    const grip = (place) => [place[0], place[2]];
    this.other.stand(seen.free ? grip(worlds.places(this.others[1], now).object) : null, frame, late);
    const fixed = worlds.turns || isTyped(settings) || isSampled(settings) || this.questions.asking;
    const long = now - worlds.start > SHORT * (end - worlds.start);
    this.camera.stand(long && !fixed ? grip(worlds.places(TRUE, now).camera) : null, frame, late);
    return moving;
  }

  // Estimate over truth.

  chartOf(scene) {
    const { shown, ghost, theme, secret, now, end } = scene;
    const { run, ratios, settled, known, free, why } = this.seen;
    const { time } = shown;
    const quantity = known.size ? "speed" : "distance";
    const times = Float64Array.from({ length: 41 }, (_, k) => time[0] + ((end - time[0]) * k) / 40);
    const level = (id, value, colour, more) => ({ id, time: times, values: times.map(() => value), colour, ...more });
    const sizes = this.others.map((world) => (this.stories ? this.speedOf(world, now) : world.size));
    const colour = run ? theme.lines[run.order] : theme.ink;
    const from = run ? ratios.findIndex(Number.isFinite) : -1;
    const begun = from >= 0 && (!secret || time[from] <= now);
    // Nothing is found where nothing can be told.
    const found = Number.isFinite(settled) && (!secret || settled <= now) && !why;
    const estimated = () => ({ time: time.subarray(from), values: ratios.subarray(from), colour, width: 3, secret });
    return {
      ...{ unit: "", mark: (value) => (value ? `×${value}` : "0"), spans: this.spansOf(scene) },
      scale: { low: 0, high: Math.max(2.4, free ? 1.15 * Math.max(...sizes) : 0) },
      title: `${free ? (this.stories ? "speed" : "size") : quantity} ÷ true`,
      lines: [
        ...(ghost ? [{ ...keptLine(scene.kept, ghost.time, this.ratiosOfKept(ghost), theme), secret }] : []),
        ...(free ? sizes.map((value, k) => level(`other ${k}`, value, theme.muted, { width: 2.5, secret })) : []),
        ...this.otherLines(scene),
        ...(begun ? [{ id: "estimate", text: shown.runs.length > 1 ? run.title : "estimate", ...estimated() }] : []),
        level("true", 1, theme.ink, { text: "true", width: 1.6 }),
      ],
      found: found ? [{ time: settled, value: 1, text: `found ${settled.toFixed(1)} s`, colour }] : [],
    };
  }

  /** The other observers' lines. */
  otherLines({ shown, theme, secret }) {
    return this.seen.others.map(({ run }) => {
      const line = { id: run.name, run: run.name, text: run.title, colour: theme.lines[run.order], width: 1.8, secret };
      return { ...line, time: shown.time, values: ratiosOf(this.worlds, shown, run) };
    });
  }

  ratiosOfKept(ghost) {
    return ratiosOf(this.worlds, ghost, ghost.runs[0]).map((value) => within(value, -1, 9));
  }

  /** A world's speed of the camera over the true one. */
  speedOf(world, now) {
    const [own, right] = [world, TRUE].map((each) => Math.hypot(...this.worlds.speeds(each, now).camera));
    return right > 0 ? own / right : 0;
  }

  /** Times in which nothing can be told, as far as they were played. */
  spansOf({ shown, secret, now, end }) {
    const { free, gaps, known } = this.seen;
    const last = secret ? now : end;
    return (free ? [[shown.time[0], end, 0]] : gaps).flatMap(([begin, until, why]) => {
      const span = { begin, end: Math.min(until, last) };
      const who = free && known.size ? "who moves " : "";
      const slow = !known.size && this.passesZero(begin, until);
      const text = why === NEARLY && !slow ? TOO_FAR : `${who}${GAPS[why]}`;
      const wide = (span.end - begin) * this.chart.width > 7 * text.length * (end - shown.time[0]);
      return begin < last ? [{ ...span, text: wide ? text : "" }] : [];
    });
  }

  /** True where the known speed is near zero at some time of a span. */
  passesZero(begin, end) {
    const times = Array.from({ length: 21 }, (_, k) => begin + ((end - begin) * k) / 20);
    return times.some((time) => Math.abs(this.worlds.reading(time)?.value ?? 0) < NEAR_ZERO);
  }

  sentence({ why, ...scene }) {
    const { verdicts } = this.lab.model;
    return firstOf(SENTENCES, { ...scene, ...this.seen, verdicts, alike: why, moved: this.moved });
  }
}

/** Boxes for what is known, which decide what the observer seeks. */
function ticksOf(lab) {
  const now = () => knowledgeOf(lab.settings.unknown);
  const box = (name, before, label) =>
    tick({
      ...{ name: `${name}`, before, label },
      get: () => now()[name],
      set: (on) => lab.screen.replay({ unknown: unknownOf({ ...now(), [name]: on }, lab.model.quantities) }),
    });
  const speeds = [box("ahead", "camera's speed", "ahead"), box("sideways", "", "sideways")];
  return [box("rests", "car", "rests"), box("size", "its", "size"), ...speeds];
}

const TIMES = { [HALF]: "half", [TWICE]: "twice" };
