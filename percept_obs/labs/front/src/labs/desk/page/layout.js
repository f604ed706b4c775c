// Where everything stands at the desk: choices, what is given, the steps, the lines of one, the picture.

import { button, element, formula, setText } from "../../../draw/dom.js";
import { historyButtons, keys, messagesOf } from "../../../ui/messages.js";

export function build(lab, place) {
  const { panel, sheet, picture, replay } = lab;
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
  const says = element("p", { class: "says" });
  const otherOf = (face) => (face === "first" ? "Workbench" : "First screen");
  const other = button(otherOf(lab.face), () => lab.turn(lab.face === "first" ? "workbench" : "first"), {
    ...{ class: "link", "data-control": "workbench" },
  });
  const premises = element("div", { class: "premises" }, title, given, letters);
  const root = element(
    "div",
    { class: "percept-lab desk", "data-face": lab.face },
    ...[problem, pythonError, notice, silence, live],
    element("div", { class: "bar" }, panel.body, actions),
    element(
      "div",
      { class: "bench" },
      element(
        "section",
        { class: "first-screen sheets", "aria-label": "Derivation" },
        element("div", { class: "heading" }, says),
        element(
          "div",
          { class: "views" },
          element("nav", { class: "path", "aria-label": "Steps" }, steps),
          element("div", { class: "work" }, reason, sheet.body, premises),
          element("div", { class: "seen" }, picture.figure, panel.inverse),
        ),
        replay.body,
        element("div", { class: "handy" }, other),
      ),
    ),
  );
  place.append(root);
  keys(root, lab);

  let drawn = "";
  let named = "";
  return {
    root,
    ...functions,
    turn(face) {
      root.setAttribute("data-face", face);
      setText(other, otherOf(face));
    },
    says: (text) => setText(says, text),
    marked(classes) {
      for (const [name, on] of Object.entries(classes)) root.classList.toggle(name, on);
    },
    steps: history.show,
    announce: (text) => setText(live, text),
    show(answer, ofThisSheet) {
      root.querySelector(".bench").classList.toggle("waiting", !ofThisSheet);
      if (!answer?.steps || answer.problem) return;
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

  function entryOf({ name, reason: why, mark, given: filled, asked }, number, step) {
    const done = mark === "right" && filled === asked;
    const how = done ? "done" : filled ? `${filled} of ${asked} lines typed` : "";
    const attributes = {
      ...{ "data-control": `step ${number}`, "aria-current": number === step && "step", class: done ? "done" : "" },
      title: why,
    };
    const turn = button("", () => lab.turnTo(number), attributes);
    turn.append(element("i", { "aria-hidden": "true" }, done ? "✓" : String(number)), element("span", {}, name));
    if (how) turn.append(element("span", { class: "unseen" }, `, ${how}`));
    return element("li", {}, turn);
  }
}
