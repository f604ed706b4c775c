// Where everything stands at the desk: one sentence, the steps, the lines of one, what is given, picture and chart.

import { button, element, formula, setText } from "../../../draw/dom.js";
import { keys, messagesOf } from "../../../ui/messages.js";

export function build(lab, place) {
  const { panel, sheet, picture, replay } = lab;
  const { problem, pythonError, silence, notice, functions } = messagesOf();
  const live = element("p", { class: "unseen", role: "status", "aria-live": "polite" });
  const says = element("p", { class: "says" });
  const steps = element("ol", { class: "steps" });
  const reason = element("h3", {});
  const premises = element("div", { class: "premises", tabindex: 0, role: "group", "aria-label": "What is known" });
  const screen = element(
    "section",
    { class: "sheets", "aria-label": "Derivation" },
    ...[says, element("nav", { "aria-label": "Steps" }, steps, reason)],
    ...[sheet.body, premises, picture.figure, replay.body, element("div", { class: "handy" }, panel.more)],
  );
  const body = element("div", { class: "lab" }, screen, panel.body);
  const messages = [problem, pythonError, notice, live];
  const root = element("div", { class: "percept-lab desk" }, ...messages, body, silence);
  place.append(root);
  keys(root, lab);

  let shown = "";
  return {
    root,
    ...functions,
    says: (text) => setText(says, text),
    announce: (text) => setText(live, text),
    marked: (classes) => Object.entries(classes).forEach(([name, on]) => root.classList.toggle(name, on)),
    show(answer) {
      const { title, given, step } = answer;
      const now = JSON.stringify([title, given, step, answer.steps]);
      if (now === shown) return;
      shown = now;
      premises.replaceChildren(title, ...given.map((text) => formula("span", text)));
      setText(reason, `${step}. ${answer.steps[step - 1].reason}`);
      const inside = steps.contains(document.activeElement);
      steps.replaceChildren(...answer.steps.map((each, k) => entryOf(each, k + 1, step)));
      if (inside) steps.querySelector("[aria-current]").focus({ preventScroll: true });
    },
  };

  function entryOf({ name, reason: why, mark, given, asked }, number, step) {
    const done = mark === "right" && given === asked;
    const turn = button("", () => lab.turnTo(number), {
      ...{ "data-control": `step ${number}`, "aria-current": number === step && "step", class: done ? "done" : "" },
      title: why,
    });
    const how = done ? ", done" : given ? `, ${given} of ${asked} lines typed` : "";
    turn.append(element("i", { "aria-hidden": "true" }, done ? "✓" : String(number)), element("span", {}, name));
    turn.append(element("span", { class: "unseen" }, how));
    return element("li", {}, turn);
  }
}
