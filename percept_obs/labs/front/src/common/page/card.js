// The questions of a lab: one that is open, what one predicts, and the answer once it was asked for.

import { changesInWords, same } from "../model/settings.js";
import { button, element, setText } from "./dom.js";

const BEFORE = "The pictures show the run before. The button makes the change, and shows what happens.";
const MOVED = "You have moved something since: this is about the settings before.";

export class Card {
  constructor(lab, presets, sketch) {
    this.lab = lab;
    this.presets = presets;
    this.sketch = sketch;
    this.body = element("div", { class: "card", hidden: true });
    this.chips = presets.map(({ name, title }) =>
      button(title, () => lab.ask(name), {
        ...{ class: "chip", "aria-expanded": "false", "data-preset": name, "data-control": `preset ${name}` },
      }),
    );
    this.list = element("div", { class: "chips", role: "group", "aria-label": "Questions" }, ...this.chips);
  }

  /** Show the question that is open, with its answer once it was asked for. */
  show() {
    const { body, chips, lab } = this;
    const open = this.presets.find((preset) => preset.name === lab.state.preset?.name);
    const name = open?.name ?? "";
    for (const chip of chips) chip.setAttribute("aria-expanded", String(chip.dataset.preset === name));
    if (body.dataset.preset !== name) {
      const inside = body.contains(document.activeElement);
      body.dataset.preset = name;
      body.hidden = !open;
      body.replaceChildren(...(open ? this.question(open) : []));
      // The button that had the focus is gone; without this the keyboard would start from the top of the page.
      if (inside && !open) chips[0]?.focus();
    }
    if (open) this.tell(open, lab.state.preset);
    this.sketch.show();
  }

  question({ name, question: text, answers, sketch, acts }) {
    const { lab } = this;
    const choice = (answer, k) => {
      const attributes = { type: "radio", name: `predict ${name}`, "data-control": `predict ${name} ${k}`, value: k };
      const press = element("input", { ...attributes, onchange: () => lab.predict({ said: k }) });
      return element("label", { class: "choice" }, press, element("span", {}, answer));
    };
    const group = { class: "predictions", role: "radiogroup", "aria-label": "Your prediction" };
    const begin = () => button("Sketch the error", () => this.sketch.begin(), { "data-control": `sketch ${name}` });
    const buttons = acts.map((act, k) =>
      button(act.button, () => lab.act(act, k), { class: "act", "data-control": `act ${name} ${k}` }),
    );
    const close = button("Close", () => lab.goBack(), { class: "close", "data-control": "way back" });
    return [
      element("p", { class: "question" }, text),
      element("div", group, ...answers.map(choice)),
      ...(sketch ? [element("div", {}, begin())] : []),
      element("p", { class: "answer", role: "status" }),
      ...["since", "changes"].map((role) => element("p", { class: role })),
      element("div", {}, ...buttons, close),
    ];
  }

  tell({ answers, right, acts }, { act, said, before, of }) {
    const { body, lab } = this;
    const set = (which, text) => setText(body.querySelector(`.${which}`), text);
    const predicted = said ?? null;
    for (const press of body.querySelectorAll(".predictions input")) {
      const mine = Number(press.value) === predicted;
      press.checked = mine;
      press.disabled = act >= 0 && !mine;
      press.parentElement.classList.toggle("right", act >= 0 && Number(press.value) === right);
    }
    const judged = predicted === right ? "You predicted it. " : `Not what you predicted: ${answers[right]}. `;
    set("answer", act < 0 ? "" : (act === 0 && predicted !== null ? judged : "") + acts[act].answer);
    const moved = Boolean(of && !same(of, lab.settings));
    const away = before && !same(before, lab.settings);
    set("since", moved ? MOVED : "");
    body.classList.toggle("moved", moved);
    const changes = () => (away ? changesInWords(before, lab.settings, lab.parts.names) : "");
    set("changes", moved ? "" : act < 0 ? BEFORE : changes());
    set("close", away ? "Back to my settings" : "Close");
    body.querySelectorAll(".act").forEach((node, k) => {
      node.hidden = k > act + 1;
      if (k === 0) setText(node, act < 0 && predicted === null ? "Just show it" : acts[0].button);
    });
  }
}
