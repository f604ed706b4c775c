// A hand at the labs: what it drags stays under the finger and moves nothing else, what cannot be is refused with the
// reason, and a step back leads to what was there.

import assert from "node:assert/strict";
import { test } from "node:test";
import { opened, use } from "./scenes.js";

const near = (one, other, by = 1e-9) => one.flat(2).forEach((value, k) =>
  assert.ok(Math.abs(value - other.flat(2)[k]) <= by, `${value} instead of ${other.flat(2)[k]}`));
const length = (v) => Math.hypot(...v);
const textOf = ({ root }, selector) => root.querySelectorAll(selector).filter((node) => node.seen).map((node) => node.textContent).join(" ");
const drawnIn = (view) => view.texts.map(({ text }) => text).join();

/** A lab with what tests do with it. */
async function hand(name, options) {
  const open = await opened(name, options);
  const { lab, find, rest } = open;
  const handles = (control) => lab.screen.handles.find(({ node }) => node === find(control));
  return {
    ...open,
    said: () => lab.screen.says.textContent,
    at: (time) => {
      lab.screen.clock.pause();
      lab.point(time);
      lab.paint();
      return lab.screen.seen;
    },
    /** Drag a handle by pixels; it must stand where it was let go. */
    drag: async (control, x, y, free = false) => {
      const { node, ...handle } = handles(control);
      const from = handle.at;
      for (const [type, part] of [["pointerdown", 0], ["pointermove", 0.5], ["pointermove", 1]])
        node.tell(type, { clientX: 100 + part * x, clientY: 100 + part * y });
      const { at, scale } = handles(control);
      if (!free) near([at], [[from[0] + x / scale, from[1] - y / scale]], 1.5 / scale);
      node.tell("pointerup", { clientX: 100 + x, clientY: 100 + y });
      await rest();
      return lab.screen.seen;
    },
    press: async (...controls) => {
      for (const control of controls) use(find(control));
      await rest();
    },
    put: async (control, value, ...types) => {
      const node = find(control);
      node.focus();
      node.value = String(value);
      for (const type of types.length ? types : ["input", "change"]) node.tell(type);
      await rest();
      return node;
    },
    tick: async (control, on) => {
      const node = find(control);
      if (node.checked !== on) use(node);
      await rest();
      return node;
    },
    key: async (control, key) => {
      find(control).tell("keydown", { key });
      find(control).tell("keyup", { key });
      await rest();
      return lab.screen.seen;
    },
    answer: async (question) => {
      lab.screen.questions.ask(question);
      await rest();
      use(find("answer 0"));
      await rest();
    },
  };
}

test("a hand moves what it sees now, and the way back leads to it", async () => {
  const { lab, at, drag, key, rest } = await hand("observer");
  for (const time of [0, 2, 4]) {
    const before = { ...at(time), b: lab.settings.b };
    const after = { ...(await drag("foe", -40, 30)), b: lab.settings.b };
    near(after.place, before.place); // the present stays
    assert.notDeepEqual(after.foe, before.foe);
    near([length(after.b)], [length(before.b)], 1e-6);
    const farther = await key("distance", "ArrowUp");
    assert.ok(length(farther.place) > length(after.place));
    near(farther.y, after.y);
    lab.undo();
    await rest();
    near(lab.screen.seen.place, after.place);
  }
  lab.close();
});

test("the focus of expansion on the point hides its distance, and nothing gives an answer away before", async () => {
  const { lab, said, find, rest } = await hand("observer");
  let hatched = 0;
  for (const view of lab.screen.views) view.hatched = () => hatched++;
  lab.screen.questions.ask("straight");
  await rest();
  assert.equal(hatched, 0);
  use(find("answer 2"));
  await rest();
  assert.ok(hatched > 0);
  use(find("done"));
  await rest();
  lab.screen.steer(lab.screen.seen.y);
  await lab.rest();
  await rest();
  near(lab.screen.seen.copies, lab.screen.seen.copies.map((each) => each.map?.(() => 0) ?? 0), 1e-7);
  assert.match(said(), /[Tt]oo near|Not found/);
  lab.close();
});

test("an observer that is impossible is dropped and says why, and every surface has the outputs that it allows", async () => {
  const open = await hand("observer", { view: { more: "observers" } });
  const { lab, find, tick, put } = open;
  await tick("observer range_identification", true);
  await tick("observer identifier_based", false);
  await put("outputs", 0);
  assert.deepEqual(lab.settings.observers, ["identifier_based"]);
  assert.match(textOf(open, ".notice"), /measure every image coordinate/);
  assert.ok(find("observer range_identification").disabled);
  await put("outputs", 1);
  assert.ok(!find("observer range_identification").disabled && textOf(open, ".notice") === "");
  for (const surface of ["chained", "plane", "sphere", "unified"]) {
    lab.reset();
    await put("outputs", 2);
    lab.unfold("scene");
    await put("surface", surface, "change");
    const both = ["sphere", "unified"].includes(surface);
    assert.deepEqual(lab.settings.outputs, both ? ["y1", "y2"] : ["y2"]);
    assert.equal(/needs y1 and y2/.test(textOf(open, ".notice")), both);
    assert.equal(find("outputs").seen, !both);
  }
  lab.close();
});

for (const [control, wrong, told, good] of [
  ["period number", "7", /a number from 0.001 to 1/, "0.5"], ["seed number", "1.5", /a whole number/, "3"],
  ["identifier_based noise_variance number", "-3", />= 0/, "0.5"], ["A a11", "5000", /from -1000 to 1000/, "0.5"],
  ["identifier_based bound number", "-3", /> 0/, "12.5"],
]) {
  test(`what a field does not take is said, and what it takes is not: ${control}`, async () => {
    const open = await hand("observer");
    const { lab, find, put } = open;
    for (const group of lab.drawer.groups) if (!find(control).seen) lab.unfold(group.name);
    const before = lab.settings;
    const field = await put(control, wrong, "input");
    assert.equal(field.getAttribute("aria-invalid"), "true");
    assert.equal(lab.settings, before);
    field.tell("change");
    assert.match(textOf(open, ".range"), told);
    assert.notEqual(field.value, wrong);
    await put(control, good);
    assert.equal(textOf(open, ".range"), "");
    assert.notEqual(lab.settings, before);
    lab.close();
  });
}

test("steps go back and forth by keys and by buttons, and a letter is lit while the focus is at its slider", async () => {
  const { lab, find, put, press, rest, root } = await hand("observer", { view: { more: "equations" } });
  const opening = lab.settings;
  await put("identifier_based bound number", 4);
  const changed = lab.settings;
  const key = (shiftKey) => find("undo").tell("keydown", { key: "z", ctrlKey: true, shiftKey });
  key(false);
  assert.deepEqual(lab.settings, opening);
  key(true);
  assert.deepEqual(lab.settings, changed);
  await press("undo");
  assert.equal(find("undo").getAttribute("aria-disabled"), "true");
  await press("redo");
  assert.deepEqual(lab.settings, changed);
  find("b1").focus();
  assert.ok(root.querySelectorAll(".formulas .lit").length > 0);
  await rest();
  lab.close();
});

test("a kernel that fails to load is told, and so is what cannot be seen, while it is so", async () => {
  const { lab, rest, said, ...open } = await hand("observer");
  lab.model.forms["pinhole y2"].observers.sliding_mode.fraction.run = "function run( {";
  lab.change({ outputs: ["y2"], observers: ["sliding_mode"] }, true);
  await assert.rejects(rest);
  assert.match(textOf(open, ".problem"), /could not be loaded/);
  lab.reset();
  await rest();
  assert.equal(textOf(open, ".problem"), "");
  const [x, y, z] = lab.settings.X0;
  lab.change({ X0: [x, y, -3] }, true);
  await rest();
  assert.match(textOf(open, ".problem"), /starts behind the camera/);
  lab.change({ X0: [x, y, z] }, true);
  await rest();
  assert.equal(textOf(open, ".problem"), "");
  assert.match(said(), /\./);
  // A part of a pixel would move lines, and not the axes that are drawn below them once for many pictures.
  lab.screen.image.resize(300.4, 200.6);
  assert.deepEqual(lab.screen.image.size, { width: 300, height: 201 });
  lab.close();
});

test("several observers are named in pictures and chart, and one is chosen by its line", async () => {
  const { lab, rest, root } = await hand("observer", { settings: { observers: ["identifier_based", "sliding_mode", "extended_kalman"] } });
  const { chart, world } = lab.screen;
  for (const title of ["identifier-based", "sliding mode", "extended Kalman"])
    assert.ok(drawnIn(world).includes(title) || drawnIn(chart).includes(title), title);
  const line = chart.chart.lines.find(({ run }) => run === "sliding_mode");
  const k = line.time.findIndex((time) => time > 0.9);
  root.querySelector(".first-chart .scrub").tell("pointerdown", { clientX: chart.x(line.time[k]), clientY: chart.y(line.values[k]) });
  await rest();
  assert.equal(lab.screen.scene.chosen.name, "sliding_mode");
  lab.undo();
  await rest();
  assert.equal(lab.screen.scene.chosen.name, "identifier_based");
  lab.close();
});

test("a mark is moved at the depth that it has now, and the others stay", async () => {
  const { lab, at, drag } = await hand("points");
  for (const [time, mark] of [[0, 0], [3.3, 2], [10, 0]]) {
    const { places } = structuredClone({ places: at(time).places });
    const after = await drag(`mark ${mark + 1}`, 20, 15);
    near([[after.places[mark][2]]], [[places[mark][2]]], 1e-6);
    const others = [0, 1, 2].filter((k) => k !== mark);
    near(others.map((k) => after.places[k]), others.map((k) => places[k]));
  }
  lab.close();
});

test("a mark that is pressed is hidden from now on and shown again, and late marks are left alone", async () => {
  const { lab, at, key, find, rest } = await hand("points");
  const end = lab.screen.clock.end + 1;
  const press = async () => {
    for (const type of ["pointerdown", "pointerup"]) find("mark 2").tell(type, { clientX: 9, clientY: 9 });
    await rest();
  };
  at(4);
  await press();
  assert.deepEqual(lab.settings.hidden, [null, [4, end], null]);
  assert.deepEqual(lab.screen.seen.hidden, [false, true, false]);
  at(6);
  await key("mark 2", "Enter");
  near(lab.settings.hidden[1], [4, 6]);
  at(lab.screen.clock.end);
  await key("mark 2", " ");
  near(lab.settings.hidden[1], [0, end]);
  lab.change({ points: lab.settings.points.slice(0, 1), hidden: [null] }, true);
  lab.screen.aim(0, [0.1, 0.1]); // of three marks, which are still drawn
  lab.screen.hide(2);
  assert.deepEqual([lab.settings.points.length, lab.settings.hidden.length], [1, 1]);
  lab.close();
});

test("a copy that is dragged moves no image at any time, and there is none where the camera travels", async () => {
  const { lab, at, drag, answer, said, put } = await hand("points");
  assert.equal(lab.screen.seen.copy, null);
  assert.match(said(), /^Found/);
  await answer("travel");
  const before = structuredClone(lab.screen.seen.copyInWorld);
  await drag("copy", 0, 30, true);
  for (const time of [0, 4.1, 10]) {
    const { copy, places } = at(time);
    const images = (all) => all.map(([x, y, z]) => [x / z, y / z]);
    near(images(copy), images(places), 1e-6);
  }
  assert.ok(Math.abs(lab.screen.seen.copyInWorld.flat()[0] - before.flat()[0]) + Math.abs(lab.screen.seen.copyInWorld.flat()[2] - before.flat()[2]) > 0.01);
  lab.screen.again();
  await put("travel", 0);
  assert.ok(lab.screen.seen.copy !== null);
  assert.match(said(), /^Still/);
  lab.close();
});

test("the estimate starts where it is dragged along its error, and the world rests while the camera travels", async () => {
  const { lab, at, drag } = await hand("points");
  const way = ({ foundInWorld: [one], inWorld: [other] }) => one.map((value, c) => (value - other[c]) / lab.settings.error);
  const [error, before] = [lab.settings.error, way(at(0))];
  const worlds = [0, 2.34, 10].map((time) => structuredClone(at(time).inWorld));
  for (const world of worlds) near(world, lab.settings.points, 1e-6);
  at(0);
  const after = await drag("estimate", 0, -12, true);
  assert.ok(lab.settings.error < error);
  near(way(after), before, 1e-6);
  lab.close();
});

test("points are added up to the most and removed down to one, and what is lost is said", async () => {
  const open = await hand("points", { settings: { duration: 2, window: 1 }, view: { more: "points" } });
  const { lab, find, press } = open;
  while (!find("add point").disabled) await press("add point");
  assert.equal(lab.settings.points.length, 12);
  while (!find("remove 1").disabled) await press("remove 1");
  assert.equal(lab.settings.points.length, 1);
  lab.unfold("motion");
  await press("no input");
  lab.unfold("words");
  await open.rest();
  assert.match(textOf(open, ".verdicts, .why"), /images do not tell its scale/);
  lab.close();
});

for (const [names, unknown, free] of [
  [[], "d_s v_c1 v_c2 v_c3", true], [["ahead"], "d_s v_c1 v_c2", false], [["sideways"], "d_s v_c2 v_c3", false],
  [["ahead", "sideways"], "d_s", false], [["size"], "v_c1 v_c2 v_c3", false], [["size", "ahead", "sideways"], "", false],
  [["rests", "size"], "v_c1 v_c2 v_c3 v_p1 v_p2 v_p3", true],
  [["rests", "size", "ahead", "sideways"], "v_p1 v_p2 v_p3", false],
  [["rests", "ahead", "sideways"], "d_s v_p1 v_p2 v_p3", true],
]) {
  test(`ticks decide what the observer seeks: ${names}`, async () => {
    const { lab, press, said } = await hand("structure");
    await press(...names);
    assert.equal(lab.settings.unknown.join(" "), unknown);
    assert.equal(lab.screen.seen.free, free);
    assert.equal(Boolean(lab.shown.refusal), free || !unknown);
    assert.equal(/annot tell|annot be told|family/.test(said()), free);
    if (!lab.shown.refusal) {
      assert.match(said(), /Found/);
      assert.ok(Math.abs(lab.screen.seen.ratio - 1) < 0.02);
    }
    lab.close();
  });
}

test("a hand scales a world and the film stands still, and lets the camera have come elsewhere", async () => {
  const { lab, drag, key, press } = await hand("structure");
  const different = () => lab.screen.worlds.difference({ size: lab.screen.size, share: null });
  const { settings } = lab;
  assert.ok(different() < 1e-12);
  await drag("world", 24, -31, true);
  const { size } = lab.screen;
  assert.ok(size > 2.1 && different() < 1e-12);
  assert.equal(lab.settings, settings);
  await key("world", "ArrowDown");
  assert.ok(lab.screen.size < size);
  await press("again");
  assert.equal(lab.screen.size, 2);
  await press("ahead");
  const [x, , z] = lab.settings.v_c;
  await drag("camera", 20, 25, true);
  assert.ok(lab.settings.v_c[0] > x && lab.settings.v_c[2] < z);
  assert.ok(Math.abs(lab.screen.seen.ratio - 1) < 0.05);
  lab.close();
});

test("nothing is found while the known speed passes zero, and no future is given away", async () => {
  const { lab, answer, at } = await hand("structure");
  await answer("zero");
  for (const [time, there] of [[1.5, true], [2.1, false], [3, true]]) {
    at(time);
    assert.equal(Number.isFinite(lab.screen.seen.ratio), there, String(time));
    assert.equal(/(^|,)estimate/.test(drawnIn(lab.screen.world)), there);
    assert.equal(/(^|,)found/.test(drawnIn(lab.screen.chart)), there);
  }
  lab.close();
  const moving = await hand("structure", { still: false });
  use(moving.find("ahead"));
  while (!moving.lab.screen.clock.playing) {
    await new Promise((resolve) => setImmediate(resolve));
    moving.page.pass(20);
  }
  assert.ok(!/(^|,)found/.test(drawnIn(moving.lab.screen.chart)));
  moving.lab.close();
});

test("the button of the time is called what a press does, also while it plays", async () => {
  const { lab, page, find } = await hand("observer", { still: false });
  const called = async (word) => {
    for (let k = 0; k < 20; k++) {
      await new Promise((resolve) => setImmediate(resolve));
      page.pass(20);
    }
    assert.match(find("play").getAttribute("aria-label"), word);
  };
  for (let turn = 0; turn < 2; turn++) {
    lab.screen.clock.play();
    await called(/^Pause;/);
    assert.ok(lab.screen.clock.playing);
    use(find("play"));
    await called(/^Play, /);
    assert.ok(!lab.screen.clock.playing);
  }
  lab.close();
});

test("a choice of unknowns says its corollary, its determinant, and why it is refused", async () => {
  const open = await hand("structure", { view: { more: "known" } });
  const { lab, press, tick, put } = open;
  const told = () => textOf(open, ".unknowns .told");
  for (const number of [3, 5]) {
    await press(`corollary ${number}`);
    assert.match(told(), new RegExp(`Corollary ${number},`));
    assert.match(textOf(open, ".notice"), new RegExp(`^Corollary ${number}\\. Changed: .*All else is as it was\\.$`));
  }
  await tick("earlier", true);
  assert.match(told(), /Corollary 2,/);
  lab.reset();
  await open.rest();
  await tick("known v_c3", true);
  await tick("known d_s", true);
  assert.match(told(), /least squares/);
  await tick("known v_c2", true);
  await tick("known v_c1", true);
  assert.ok(lab.shown.refusal && told().toLowerCase().includes(lab.shown.refusal.toLowerCase()));
  lab.unfold("run");
  await put("duration number", 21);
  const { step } = lab.settings;
  const field = await put("step number", 0.0001, "input");
  assert.equal(field.getAttribute("aria-invalid"), "true");
  assert.equal(lab.settings.step, step);
  lab.close();
});

test("a link opens the lab as it was, the address follows the hand, and a hostile one changes nothing", async () => {
  const open = await hand("points", { hash: "#points=1;spin=0.5" });
  const { lab, page, rest } = open;
  const { location } = page.window;
  const go = async (to) => {
    page.go(to);
    await rest();
  };
  assert.equal(lab.settings.spin, 0.5);
  await go("#points=1;spin=0.7");
  assert.equal(lab.settings.spin, 0.7);
  lab.change({ hold: "exact" }, true);
  await rest();
  assert.match(location.hash, /^#points=1;.*hold=exact/);
  const [link, there] = [location.hash, lab.settings];
  for (const hostile of ["#points=1;spin=x", "#observer=1;seed=3", "#points=9;spin=1", `#points=1;spin=${"3".repeat(1e6)}`]) {
    await go(hostile);
    assert.match(textOf(open, ".notice"), /^The link in this page's address is not followed: /);
    assert.equal(lab.settings, there);
  }
  lab.undo();
  await rest();
  assert.equal(lab.settings.hold, "zero");
  await go(link);
  assert.deepEqual(lab.settings, there);
  lab.close();
});

for (const name of ["observer", "points", "structure"]) {
  test(`a setting stands in the group of its topic, and one group is open at a time: ${name}`, async () => {
    const { lab, find, root, seen } = await hand(name);
    use(find("more"));
    const placed = Object.entries(lab.model.schema).filter(([, { topic }]) => topic);
    assert.ok(placed.length > 3);
    for (const [setting, { topic }] of placed)
      assert.ok(root.querySelector(`.group-${topic} [data-control="${setting}"]`), `${setting} is not in ${topic}`);
    for (const title of seen("summary")) {
      if (!title.parentElement.open) title.tell("click");
      assert.deepEqual(root.querySelectorAll("details").filter(({ open }) => open), [title.parentElement]);
    }
    use(find("more"));
    assert.equal(find("undo").seen, false);
    lab.close();
  });
}
