// The questions of a lab: one that is open, what one predicts, and the answer once it was asked for.

import { changesInWords, same } from "../model/settings.js";
import { button, element } from "./controls.js";
import { put } from "./put.js";

const CHIP = { class: "chip", "aria-expanded": "false" };
const BEFORE = "The pictures show the run before. The button makes the change, and shows what happens.";

export class Card {
  constructor(lab, presets, sketch) {
    this.lab = lab;
    this.presets = presets;
    this.sketch = sketch;
    this.body = element("div", { class: "card", hidden: true });
    this.chips = presets.map(({ name, title }) =>
      button(title, () => lab.ask(name), { ...CHIP, "data-preset": name, "data-control": `preset ${name}` }),
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
      if (inside && !open) chips[0].focus();
    }
    if (open) this.tell(open, lab.state.preset);
    this.sketch.show();
  }

  question({ name, question: text, answers, sketch, acts }) {
    const { lab } = this;
    const choice = (answer, k) => {
      const press = element("input", { type: "radio", name: `predict ${name}`, "data-control": `predict ${name} ${k}`, value: k });
      press.addEventListener("change", () => lab.predict({ said: k }));
      return element("label", { class: "choice" }, press, element("span", {}, answer));
    };
    const choices = element("div", { class: "predictions", role: "radiogroup", "aria-label": "Your prediction" }, ...answers.map(choice));
    const draw = sketch ? [button("Sketch the error", () => this.sketch.begin(), { "data-control": `sketch ${name}` })] : [];
    const buttons = acts.map((act, number) =>
      button(act.button, () => lab.act(act, number), { class: "act", "data-control": `act ${name} ${number}` }),
    );
    const close = button("Close", () => lab.goBack(), { class: "close", "data-control": "way back" });
    return [
      element("p", { class: "question" }, text),
      ...[choices, ...draw.map((press) => element("div", {}, press))],
      element("p", { class: "answer", role: "status" }),
      ...["since", "changes"].map((role) => element("p", { class: role })),
      element("div", {}, ...buttons, close),
    ];
  }

  tell({ answers, right, acts }, { act, said, before, of }) {
    const { body, lab } = this;
    const line = (which) => body.querySelector(`.${which}`);
    const here = said ?? null;
    for (const press of body.querySelectorAll(".predictions input")) {
      press.checked = Number(press.value) === here;
      press.disabled = act >= 0 && Number(press.value) !== here;
      press.parentElement.classList.toggle("right", act >= 0 && Number(press.value) === right);
    }
    const judged = here === null ? "" : here === right ? "You predicted it. " : `Not what you predicted: ${answers[right]}. `;
    put(line("answer"), act < 0 ? "" : act === 0 ? judged + acts[0].answer : acts[act].answer);
    const moved = of && !same(of, lab.settings);
    put(line("since"), moved ? "You have moved something since: this is about the settings before." : "");
    body.classList.toggle("moved", Boolean(moved));
    put(line("changes"), act < 0 && !moved ? BEFORE : before && !moved && !same(before, lab.settings) ? changesInWords(before, lab.settings, lab.parts.names) : "");
    put(line("close"), before && !same(before, lab.settings) ? "Back to my settings" : "Close");
    body.querySelectorAll(".act").forEach((node, k) => {
      node.hidden = k > act + 1;
      if (k === 0) put(node, act < 0 && here === null ? "Just show it" : acts[0].button);
    });
  }
}
