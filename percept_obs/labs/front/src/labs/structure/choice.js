// What is known and what is not: boxes to tick, the cases of the paper in its table, and the determinant that decides.

import { readable } from "../../draw/scales.js";
import { tick } from "../../ui/controls.js";
import { button, element, setText } from "../../draw/dom.js";
import { FormulaSheet, lettered } from "../../ui/formulas.js";
import { isZero, keyOf } from "./kernels.js";

const GROUPS = [
  { title: "Scale", names: ["d_s"] },
  { title: "Camera's velocity", names: ["v_c1", "v_c2", "v_c3"] },
  { title: "Object's velocity", names: ["v_p1", "v_p2", "v_p3"] },
];
const KINDS = { dynamic: "Camera partly unknown", general: "Range known" };
const OBJECTS = { semigeneral: "Object still, then moving", general: "Object moving" };

export class ChoiceOfUnknowns {
  constructor(model, lab) {
    this.model = model;
    this.lab = lab;
    this.shownFor = "";
    /** @type {[number, Element][]} */
    this.cases = [];
    this.value = element("span", { class: "value" });
    this.determinant = new FormulaSheet();
    /** @type {ReturnType<typeof tick>[]} */
    this.boxes = [];
    this.earlier = tick({
      name: "earlier",
      label: "d_s was estimated before, so θ holds d_s v",
      get: () => lab.settings.earlier,
      set: (on) => lab.change({ earlier: on }, true),
    });
    this.told = element("div", { class: "told" });
    this.body = element(
      "section",
      { class: "unknowns", role: "group", "aria-label": "What is known" },
      element("h4", {}, "Tick what you know"),
      ...[...this.groups(), this.earlier.row, this.told, this.table()],
    );
  }

  /** The boxes, which follow the settings. */
  get controls() {
    return [...this.boxes, this.earlier];
  }

  groups() {
    return GROUPS.map(({ title, names }) => {
      const boxes = names.map((name) => this.box(name));
      const attributes = { class: "ticked", role: "group", "aria-label": title };
      return element("div", attributes, element("span", {}, title), ...boxes);
    });
  }

  box(name) {
    const { lab, model } = this;
    const box = tick({
      name: `known ${name}`,
      label: "",
      get: () => !lab.settings.unknown.includes(name),
      set: (known) => {
        const { unknown } = lab.settings;
        lab.change({ unknown: model.quantities.filter((q) => (q === name ? !known : unknown.includes(q))) }, true);
      },
    });
    const [letter, index] = name.split("_");
    box.row.lastChild.innerHTML = `<math><msub><mi>${letter}</mi><mi>${index}</mi></msub></math>`;
    box.parts[0].setAttribute("aria-label", `${name} is known`);
    this.boxes.push(box);
    return box.row;
  }

  /** Table 1: how the camera and the object move, with the corollaries of each cell. */
  table() {
    const { corollaries } = this.model;
    const cell = (camera, object) => {
      const inside = corollaries.filter((c) => c.camera === camera && c.object === object);
      const presses = inside.map(({ number, words, settings }) => {
        const said = { "data-control": `corollary ${number}`, "aria-label": `Corollary ${number}`, title: words };
        const choose = () => this.lab.changeAndSay(`Corollary ${number}`, structuredClone(settings));
        const press = button(String(number), choose, { class: "case", ...said });
        this.cases.push([number, press]);
        return press;
      });
      return element("td", {}, ...presses);
    };
    const header = (scope, words) => element("th", { scope }, words);
    const row = (camera) => Object.keys(OBJECTS).map((object) => cell(camera, object));
    return element(
      "table",
      { class: "cases" },
      element("caption", {}, "The paper's cases, corollaries 1 to 7"),
      element("tr", {}, element("td"), ...Object.values(OBJECTS).map((words) => header("col", words))),
      ...Object.entries(KINDS).map(([camera, words]) => element("tr", {}, header("row", words), ...row(camera))),
    );
  }

  /** Bring boxes, table and words to what is shown. */
  show(shown) {
    const { settings, refusal } = shown;
    const corollary = refusal ? null : this.lab.kernels.corollary(settings);
    const key = JSON.stringify([keyOf(settings), refusal, corollary]);
    if (key !== this.shownFor) {
      this.shownFor = key;
      this.earlier.row.hidden = settings.unknown.includes("d_s");
      for (const [number, press] of this.cases) press.setAttribute("aria-pressed", String(number === corollary));
      this.tell(settings, refusal, corollary);
    }
    if (!refusal) this.fill(shown);
  }

  tell(settings, refusal, corollary) {
    this.determinant.clear();
    if (refusal) {
      const head = element("p", {}, element("strong", {}, "Impossible."));
      const why = `${refusal[0].toUpperCase()}${refusal.slice(1)}.`;
      this.told.replaceChildren(head, element("p", { class: "refused" }, why));
      return;
    }
    const choice = this.model.unknowns[keyOf(settings)];
    const column = choice.theta.map((entry) => `<mtr><mtd>${entry}</mtd></mtr>`).join("");
    const [theta, letters, numbers] = ["", "", " with-numbers"].map((kind) => element("div", { class: `line${kind}` }));
    theta.innerHTML = `<math><mi>θ</mi><mo>=</mo><mtable class="matrix">${column}</mtable></math>`;
    letters.innerHTML = `<math displaystyle="true">${choice.determinant}</math>`;
    const right = choice.determinant.replace(/^<mrow>.*?<mo>=<\/mo>/, "<mrow><mo>=</mo>");
    if (choice.square) numbers.innerHTML = `<math displaystyle="true">${right}</math>`;
    this.determinant.replaceLetters(numbers, "");
    numbers.append(this.value);
    const attributes = { class: "determinant", role: "group", "aria-label": "Determinant", tabindex: 0 };
    this.told.replaceChildren(
      element("p", {}, element("strong", {}, this.nameOf(corollary)), ` ${this.kindOf(choice)}`),
      element("div", attributes, theta, element("div", {}, letters, numbers)),
      element("p", { class: "where" }, `Not observable ${choice.zeroSet}.`),
    );
  }

  nameOf(number) {
    const found = this.model.corollaries.find((c) => c.number === number);
    return found ? `Corollary ${number}, section ${found.section}.` : "Possible, though not a case of the paper.";
  }

  kindOf({ unknown, square, alone }) {
    const count = unknown.length === 1 ? "one unknown" : "two unknowns";
    const few = square ? "" : `There are three equations for ${count}: they are solved by least squares.`;
    const metres = alone.filter((name) => !isZero(this.lab.settings, name, this.model));
    const carried = metres.length ? `The known ${metres.join(", ")} tells the scale in metres.` : "";
    return [few, carried].filter(Boolean).join(" ");
  }

  /** The determinant's number at the start of the run. */
  fill({ settings, guard, problem }) {
    const { ybar, scale } = settings;
    const at = { d_s: scale, ybar3: ybar[2], y1: ybar[0], y2: ybar[1], ...lettered(this.lab.startOf(settings)) };
    this.determinant.setNumbers((_, letter) => at[letter]);
    const text = problem ? "" : ` = ${readable(guard.determinants[0])} at the start`;
    setText(this.value, text);
  }
}
