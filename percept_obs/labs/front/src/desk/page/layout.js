// Where everything stands at the desk: choices, what is given, the steps, the lines of one, the picture.

import { button, element, formula, setText } from "../../common/page/dom.js";
import { historyButtons, keys, messagesOf } from "../../common/page/layout.js";

export function build(lab, place) {
  const { panel, sheet, picture } = lab;
  const { problem, pythonError, silence, notice, said, functions } = messagesOf();
  const history = historyButtons(lab);
  const live = element("p", { class: "unseen", role: "status", "aria-live": "polite" });
  const title = element("h4", { class: "whose" });
  const given = element("div", { class: "given", role: "group", "aria-label": "What is given", tabindex: 0 });
  const letters = element("p", { class: "letters" });
  const steps = element("ol", { class: "steps" });
  const reason = element("h3", {});
  const actions = element(
    "div",
    { class: "actions" },
    ...[history.undo, history.redo],
    button("Clear all lines", () => lab.clear(), { "data-control": "clear" }),
    button("Reset", () => lab.reset(), { "data-control": "reset" }),
    said,
  );
  const root = element(
    "div",
    { class: "percept-lab desk" },
    element("div", { class: "bar" }, panel.body, actions),
    ...[problem, pythonError, notice, silence, live],
    element(
      "div",
      { class: "stage" },
      element("div", { class: "task" }, title, given, letters, element("nav", { "aria-label": "Steps" }, steps)),
      element("div", { class: "work" }, reason, sheet.body),
      element("div", { class: "seen" }, picture.body),
    ),
  );
  picture.body.append(panel.inverse);
  place.append(root);
  keys(root, lab);

  let drawn = "";
  let named = "";
  return {
    root,
    ...functions,
    steps: history.show,
    announce: (text) => setText(live, text),
    show(answer, ofThisSheet) {
      root.querySelector(".stage").classList.toggle("waiting", !ofThisSheet);
      if (!answer.steps || answer.problem) return;
      setText(title, answer.title);
      root.dataset.part = answer.settings.part;
      const known = JSON.stringify([answer.given, answer.letters]);
      if (known !== drawn) {
        drawn = known;
        given.replaceChildren(...answer.given.map((text) => formula("div", text, { class: "line" }, true)));
        const each = answer.letters.flatMap((letter, k) => [k ? ", " : "", formula("span", letter)]);
        letters.replaceChildren("Letters: ", ...each);
      }
      const { step } = answer;
      const now = JSON.stringify([answer.steps, step]);
      if (now === named) return;
      named = now;
      setText(reason, `${step}. ${answer.steps[step - 1].reason}`);
      const inside = steps.contains(document.activeElement);
      steps.replaceChildren(...answer.steps.map((each, k) => entryOf(each, k + 1, step)));
      if (inside) steps.querySelector("[aria-current]").focus({ preventScroll: true });
    },
  };

  function entryOf({ reason: why, mark, given: filled, asked }, number, step) {
    const done = mark === "right" && filled === asked;
    const how = done ? "done" : filled ? `${filled} of ${asked}` : "";
    const found = element("span", { class: `how ${mark}` }, done ? `✓ ${how}` : how);
    const attributes = { "data-control": `step ${number}`, "aria-current": number === step && "step" };
    const turn = button("", () => lab.turnTo(number), attributes);
    turn.append(element("span", { class: "why-step" }, why), found);
    return element("li", {}, turn);
  }
}
