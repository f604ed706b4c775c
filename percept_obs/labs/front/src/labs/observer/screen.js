// The screen of the observer lab: the estimate slides along its ray until the motion that it expects is seen.

import { Film } from "../../draw/film.js";
import { Screen } from "../../ui/screen.js";
import { derived } from "../../engine/derived.js";
import { between, valueBetween, within } from "../../engine/between.js";
import { affine, imageVelocities } from "../../engine/velocities.js";
import { button, setText } from "../../draw/dom.js";
import { motionOf, readTrack, shapeOf, varies } from "./camera.js";
import { inImage, translationTowards } from "./engine.js";
import { QUESTIONS } from "./questions.js";
import { apply, back, flow, isRigid, Standing, wayOf } from "./standing.js";
import { coefficientsAt, motionAt, placesOf } from "./place.js";
import { drawImage, MOST } from "./image.js";
import { chartOf, controlsOf, radiusOf, sentence } from "./told.js";
import { drawWorld } from "./world.js";

const CAPTIONS = { image: "What the camera sees", world: "The world from above", axis: "Distance over time" };
/** Where the map is not level, but along the first view. */
const OF_FILMS = { world: "From above the camera" };
/** Part of a distance that must be seen from above, or else the map offers to be seen from the side. */
const FLAT = 0.8;
/** Pixels within which the focus of expansion clicks onto the point. */
const CLICK = 7;
/** Pixels within which a press on the film is meant for a track. */
const NEAR = 24;
/** Least distance of a point, in metres. */
const [NEAREST, FARTHEST] = [0.8, 200];

export class ObserverScreen extends Screen {
  static parts = { drawImage, drawWorld, chartOf, sentence };
  /** True where a page shows the truth alone. */
  bare = false;
  /** A place that the map holds besides the run, for the next settings have their point there. */
  room = /** @type {number[] | null} */ (null);
  /** True once a distance was hardly seen from above. */
  steep = false;
  /** What is seen at the time that was drawn last, in metres before the camera. */
  seen = /** @type {any} */ (null);

  constructor(lab) {
    const recorded = lab.settings.scenario in lab.model.recordings;
    // The questions are about a drive, whose settings they change.
    super(lab, recorded ? { ...CAPTIONS, ...OF_FILMS } : CAPTIONS, controlsOf(lab), recorded ? [] : QUESTIONS);
    this.standing = new Standing();
    this.film = new Film(lab);
    this.image.figure.addEventListener("click", (event) => this.pick(event));
    this.focus = this.handle(this.image, {
      ...{ name: "foe", label: "Focus of expansion, where the camera heads" },
      onMove: (place) => this.steer(this.clicked(place)),
    });
    this.point = this.handle(this.image, {
      ...{ name: "point", label: "The point, its direction" },
      onMove: (place) => this.aim(place),
    });
    this.far = this.handle(this.world, {
      ...{ name: "distance", label: "The point, its distance", nudge: 0.25 },
      onMove: (place) => this.reach(place),
    });
  }

  build(more) {
    const { lab } = this;
    const turn = () => lab.look({ side: !lab.state.view.side });
    this.sideButton = button("From the side", turn, { class: "side", "data-control": "side", hidden: true });
    this.world.figure.append(this.sideButton);
    return super.build(more);
  }

  /** Coordinates that the map shows across and upwards. */
  get axes() {
    return this.lab.state.view.side ? [2, 1] : [0, 2];
  }

  /** Offer the other side of the map where this one hides most of a distance. */
  showSide({ inWorld, place, camera }) {
    const { side } = this.lab.state.view;
    const way = inWorld(place).map((value, k) => value - camera[k]);
    this.steep ||= Math.hypot(way[0], way[2]) < FLAT * Math.hypot(...way);
    this.sideButton.hidden = !this.steep && !side;
    setText(this.sideButton, side ? "From above" : "From the side");
    const caption = side ? "The world from the side" : (this.captions.world ?? "");
    if (this.world.caption) setText(this.world.caption, caption);
  }

  renew() {
    this.standing.begin();
    this.steep = false;
  }

  // What a hand does: it moves what it sees now, so the present picture stays, and the past swings.

  /** Settings of the same present with another motion, or with the point elsewhere. */
  moveTo(b, place) {
    const { settings } = this.lab;
    const { now } = /** @type {any} */ (this.scene);
    const motion = { A: settings.A, b };
    const X0 = apply(flow(motion, -now), place);
    if (!(X0[2] > 0.4) || X0.some((value) => !(Math.abs(value) < 1000))) return;
    this.standing.keep(settings, now);
    this.lab.change({ b, X0, start: this.startFor(X0) });
  }

  /** The start of the estimate at the same distance on the ray of another point. */
  startFor(X0) {
    const { settings } = this.lab;
    if (settings.start.mode !== "chosen") return settings.start;
    const { functions } = this.seen;
    const shape = shapeOf(settings);
    const lengthOf = (y1, y2) => Math.hypot(...functions.ray([y1, y2, ...shape], new Float64Array(3)));
    const [z1, z2, inverse] = settings.start.values;
    const [y1, y2] = functions.project([...X0, ...shape], new Float64Array(3));
    return { ...settings.start, values: [y1, y2, (inverse * lengthOf(y1, y2)) / lengthOf(z1, z2)] };
  }

  clicked(place) {
    const { y } = this.seen;
    const apart = /** @type {number[]} */ (this.image.at)[2] * Math.hypot(place[0] - y[0], place[1] - y[1]);
    return apart < CLICK ? y : place;
  }

  steer(place) {
    const { settings } = this.lab;
    const aim = place.map((value) => within(value, -MOST, MOST));
    const b = translationTowards(aim, settings, this.seen.functions);
    const speed = Math.hypot(...settings.b) / Math.hypot(...b);
    this.moveTo(b.map((value) => speed * value), this.seen.place);
  }

  aim(place) {
    const { settings } = this.lab;
    const ray = Array.from(this.seen.functions.ray([...place, ...shapeOf(settings)], new Float64Array(3)));
    const length = Math.hypot(...this.seen.place) / Math.hypot(...ray);
    this.moveTo(settings.b, ray.map((value) => length * value));
  }

  /** Put the point at the place on its ray that is nearest to a place of the map. */
  reach(there) {
    const { place } = this.seen;
    const [camera, point] = [this.seen.camera, this.seen.point].map((where) => this.axes.map((k) => where[k]));
    const along = [0, 1].map((k) => point[k] - camera[k]);
    const part = along.reduce((sum, way, k) => sum + (there[k] - camera[k]) * way, 0) / Math.hypot(...along) ** 2;
    const distance = Math.hypot(...place);
    const wanted = within(part * distance, NEAREST, FARTHEST);
    this.moveTo(this.lab.settings.b, place.map((value) => (value * wanted) / distance));
  }

  // Tracks of a film.

  /** The other tracks of the film that are seen at a time of this one, in the image. */
  others({ scenario }, now) {
    const { recordings } = this.lab.model;
    const { film, begin } = recordings[scenario];
    const found = Object.entries(recordings).flatMap(([name, other]) => {
      const when = begin + now - other.begin;
      const there = other.film === film && name !== scenario && when >= 0 && when <= other.time.at(-1);
      return there ? [{ name, y: sampleOf(other, when) }] : [];
    });
    return found.filter(({ y }) => !y.some(Number.isNaN));
  }

  /** Follow another track from the same frame on. */
  choose(name) {
    const { lab } = this;
    const { recordings } = lab.model;
    this.touch();
    this.setWhy(false);
    lab.state.cursor = this.clock.present() + recordings[lab.settings.scenario].begin - recordings[name].begin;
    lab.chooseScenario(name);
  }

  /** Follow the track that is pressed. */
  pick({ clientX, clientY, target }) {
    const { left, top } = this.image.figure.getBoundingClientRect();
    const apart = ({ at: [x, y] }) => Math.hypot(x - (clientX - left), y - (clientY - top));
    // Nothing is seen before the first picture, and where settings are refused.
    const tracks = this.seen?.tracks ?? [];
    const [nearest] = tracks.toSorted((one, other) => apart(one) - apart(other));
    if (nearest && apart(nearest) < NEAR && !target.closest("button")) this.choose(nearest.name);
  }

  // What is seen at a time.

  /** From what the camera sees at a time to a world that stands, if there is one. */
  worldOf(shown, functions) {
    const { lab, standing } = this;
    const { settings, time } = shown;
    const recorded = lab.model.recordings[settings.scenario];
    if (recorded) return derived(recorded, "way", () => wayOf(motionOf(lab.model, recorded)));
    if (varies(settings, lab.model)) return derived(shown, "way", () => wayOf(motionAt(lab, shown, functions, time)));
    return isRigid(settings.A) ? (when) => standing.toWorld(settings, when) : null;
  }

  /** Places in metres before the camera: of the point, of the estimate, and functions of the settings. */
  look(scene) {
    const { lab } = this;
    const { shown, chosen: run, at, now } = scene;
    const { settings, truth, width } = shown;
    const functions = lab.kernels.of(settings);
    const shape = shapeOf(settings);
    const placeOf = placesOf(lab, shown);
    const stateOf = (rows) => [0, 1, 2].map((c) => valueBetween(rows, width, c, at));
    const state = truth?.length ? stateOf(truth) : null;
    const estimate = stateOf(run.estimate);
    const recorded = lab.model.recordings[settings.scenario];
    const sample = recorded ? sampleOf(recorded, now) : [NaN];
    const y = state ?? (sample.some(Number.isNaN) ? estimate : sample);
    const motion = coefficientsAt(lab, shown, functions, at);
    const image = (copy) => Array.from(functions.project([...copy, ...shape], new Float64Array(3)));
    const speedsOf = (place, { A, b }) => imageVelocities(place, (copy) => affine(A, b, copy), image);
    const place = placeOf(state ?? estimate);
    const guessOf = (state) => (state[2] > 1e-4 ? placeOf(state) : null);
    const guess = guessOf(estimate);
    // The chosen one last, so that it lies on top.
    const beads = (this.bare ? [] : [...shown.runs.filter((each) => each !== run), run]).map((each, k, all) => {
      const at = stateOf(each.estimate);
      return { run: each, state: at, guess: guessOf(at), chosen: each === run, ring: 11 + 5 * (all.length - 1 - k) };
    });
    const expected = guess && placeOf([y[0], y[1], estimate[2]]);
    const toWorld = this.worldOf(shown, functions);
    const world = toWorld?.(now);
    const inWorld = (where) => (world ? apply(world, where) : where);
    const simulated = Boolean(world) && !recorded;
    const film = this.film.films[recorded?.film] ?? null;
    const rayOf = (seen) => Math.hypot(...functions.ray([seen[0], seen[1], ...shape], new Float64Array(3)));
    const other = recorded?.measured && derived(recorded, "other", () => otherOf(recorded, rayOf));
    this.whyButton.hidden = !state;
    this.seen = {
      ...{ state, estimate, y: y.slice(0, 2), motion, image, place, guess, beads, run, inWorld, functions },
      ...{ toWorld, simulated, recorded, other, ray: rayOf(estimate), tracks: [] },
      ...{ film, up: film && film.extent[2] > film.extent[3] ? -1 : 1 },
      ...{ camera: inWorld([0, 0, 0]), point: inWorld(place), truth: Boolean(state) },
      copies: state && speedsOf(place, motion),
      expects: !this.bare && expected && speedsOf(expected, settings.believed ?? motion)[1],
      toCamera: world && back(world),
      movable: (simulated || state) && !varies(settings, lab.model),
      foe: simulated ? inImage(functions, [...motion.A.flat(), ...motion.b, ...shape]) : shown.foe,
      radius: radiusOf({ ...shown, settings: { ...settings, b: motion.b } }, shown.radius * y[2]),
      size: shown.radius * y[2],
      single: shown.measured.length === 1 ? shown.measured[0] : null,
    };
    return this.seen;
  }

  drawWorld(...given) {
    this.showSide(this.seen);
    return super.drawWorld(...given);
  }
}

/** Where a recording sees its point at a time. */
function sampleOf(recorded, now) {
  const { time, outputs } = derived(recorded, "track", () => readTrack(recorded));
  return [0, 1].map((c) => valueBetween(outputs, 2, c, between(time, now)));
}

/** Another measurement of a recording's distance: its name, and metres along the ray at times. */
function otherOf(recorded, rayOf) {
  const { time, outputs } = derived(recorded, "track", () => readTrack(recorded));
  const [name, measured] = recorded.measured;
  return { name, time, values: time.map((_, k) => (measured[k] ?? NaN) * rayOf(outputs.subarray(2 * k))) };
}
