// Where everything stands: presets, pictures, words, controls, formulas. Words are put in only when they change.

import { button, element } from "./controls.js";
import { Legend } from "./legend.js";
import { swatch } from "./lines.js";
import { Player } from "./player.js";
import { zoomable } from "./zooming.js";

/** What makes something else of the space bar. */
const OWN_SPACE = "input, select, button, summary, a, .player";
const CHIP = { class: "chip", "aria-expanded": "false" };

export function build(lab, place, presets) {
  const { planes, charts, panel, formulas } = lab;
  const { problem, pythonError, silence, notice, said, functions } = sayings();
  const history = ways(lab);
  const live = element("p", { class: "unseen", role: "status", "aria-live": "polite" });
  const verdicts = element("ul", { class: "verdicts" });
  const why = element("ul", { class: "why" });
  const analysis = element("ul", { class: "analysis" });
  const reading = element("p", { class: "reading" });
  const legend = new Legend(lab);
  const card = element("div", { class: "card", hidden: true });
  const code = element("pre", { class: "code", hidden: true, tabindex: 0, "aria-label": "Python code of this run" });
  const keep = button("Keep this run", () => lab.keep(), { "data-control": "keep", "aria-pressed": "false" });
  const back = button("Back", () => lab.goBack(), { "data-control": "back", hidden: true });
  const player = new Player(lab);

  /** Show the preset that is open, with its answer once it was asked for. */
  function preset() {
    const { name, act, before } = lab.state.preset ?? { act: -1, before: null };
    const open = presets.find((p) => p.name === name);
    const inside = card.contains(document.activeElement);
    back.hidden = !before;
    for (const chip of chips) chip.setAttribute("aria-expanded", String(chip.dataset.preset === name));
    if (card.dataset.preset !== (name ?? "")) {
      card.dataset.preset = name ?? "";
      card.hidden = !open;
      card.replaceChildren(...(open ? question(open) : []));
      // The button that had the focus is gone; without this the keyboard would start from the top of the page.
      if (inside && !open) chips[0].focus();
    }
    if (!open) return;
    put(card.querySelector(".answer"), open.acts[act]?.answer ?? "");
    card.querySelectorAll(".act").forEach((node, k) => (node.hidden = k > act + 1));
  }

  function question({ name, question: text, acts }) {
    const buttons = acts.map((act, number) =>
      button(act.button, () => lab.act(act, number), { class: "act", "data-control": `act ${name} ${number}` }),
    );
    const close = button("Back to my settings", () => lab.goBack(), { "data-control": "way back" });
    const answer = element("p", { class: "answer", role: "status" });
    return [element("p", { class: "question" }, text), answer, element("div", {}, ...buttons, close)];
  }

  const chips = presets.map(({ name, title }) =>
    button(title, () => lab.ask(name), { ...CHIP, "data-preset": name, "data-control": `preset ${name}` }),
  );

  async function copy() {
    code.textContent = lab.copy();
    code.hidden = false;
    try {
      await navigator.clipboard.writeText(code.textContent);
      view.say("Copied: paste it into a cell.");
    } catch {
      view.say("The browser does not let the lab copy; select the lines below.");
    }
  }

  const actions = element(
    "div",
    { class: "actions" },
    ...[history.undo, history.redo, back, keep],
    button("Copy as code", copy, { "data-control": "copy" }),
    button("Reset", () => lab.reset(), { "data-control": "reset" }),
    said,
  );
  const chartBox = element("div", { class: "charts" }, ...Object.values(charts).map((chart) => chart.figure));
  const unfolding = (name, title, open, inside) =>
    element("details", { class: name, open }, element("summary", { "data-control": name }, title), inside);
  const root = element(
    "div",
    { class: "percept-lab", "data-lm-suppress-shortcuts": "true" },
    element("div", { class: "bar" }, element("div", { class: "chips", role: "group", "aria-label": "Questions" }, ...chips), actions),
    ...[card, code, problem, pythonError, notice, lab.head ?? ""],
    element(
      "div",
      { class: "stage" },
      element("div", { class: "left" }, ...planes.map((plane) => plane.figure)),
      element("div", { class: "right" }, legend.body, chartBox, player.body, reading),
      element("div", { class: "words" }, verdicts, why),
    ),
    ...[silence, live, panel.body],
    unfolding("deeper", "What Python adds", true, analysis),
    unfolding("equations", "Equations, with the present numbers", false, formulas.body),
  );
  place.append(root);

  keys(root, lab);
  root.addEventListener("keydown", (event) => {
    if (event.key !== " " || event.defaultPrevented || event.target.closest(OWN_SPACE)) return;
    event.preventDefault();
    player.toggle();
  });
  for (const type of ["pointerdown", "pointerup", "pointercancel"]) {
    root.addEventListener(type, () => lab.hold(type === "pointerdown"), true);
  }
  for (const chart of Object.values(charts)) zoomable(lab, chart, player);

  let spoken = "";
  const view = {
    root,
    preset,
    steps: history.show,
    words(found) {
      const verdictOf = ({ which, title, text }) => [which, title, text];
      beside(verdicts, found.verdicts.map(verdictOf), (title, text) => [element("strong", {}, `${title}:`), ` ${text}`]);
      legend.show(found.legend);
      fill(why, found.reasons);
      spoken = found.problem ?? found.verdicts.map(({ title, text }) => `${title}: ${text}`).join(". ");
      const { settings } = lab;
      put(keep, settings.kept ? "Forget the kept run" : "Keep this run");
      keep.setAttribute("aria-pressed", String(Boolean(settings.kept)));
      code.hidden ||= code.textContent !== lab.copy();
    },
    rested: () => put(live, spoken),
    read: (text) => put(reading, text),
    time: (cursor) => player.show(cursor),
    playing: () => player.playing,
    close: () => player.close(),
    ...functions,
    analysis: (sentences) => fill(analysis, sentences),
    answered: (answer) => analysis.classList.toggle("of-others", !answer),
  };
  return view;
}

/** The keys of undo and redo; JupyterLab would take arrows, letters and Enter for commands of its own. */
export function keys(root, lab) {
  root.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.key.toLowerCase() !== "z") return;
    event.preventDefault();
    if (event.shiftKey) lab.redo();
    else lab.undo();
  });
  for (const type of ["keydown", "keyup", "keypress"]) root.addEventListener(type, (event) => event.stopPropagation());
}

/** The buttons of undo and redo, and what brings them to the history. */
export function ways(lab) {
  const undo = button("Undo", () => lab.undo(), { "data-control": "undo", title: "Ctrl+Z" });
  const redo = button("Redo", () => lab.redo(), { "data-control": "redo", title: "Ctrl+Shift+Z" });
  const show = ({ past, future }) => {
    // Not disabled, which would take the focus away from the last step.
    undo.setAttribute("aria-disabled", String(!past.length));
    redo.setAttribute("aria-disabled", String(!future.length));
  };
  return { undo, redo, show };
}

/** What the page says of Python and of itself, with the functions that say it. */
export function sayings() {
  const paragraph = (className, role) => element("p", { class: className, role, hidden: true });
  const problem = paragraph("problem", "alert");
  const pythonError = paragraph("problem percept-obs-error", "alert");
  const silence = paragraph("silence", "status");
  const notice = paragraph("notice", "status");
  const said = element("span", { class: "said", role: "status" });
  const functions = {
    notice: (text) => show(notice, text),
    problem: (text) => show(problem, text),
    pythonError: (text) => show(pythonError, text && `Python says: ${text}`),
    silence: (error) =>
      show(silence, error === undefined ? "" : "Python does not answer: it is busy or gone. The lab goes on without it."),
    say(text) {
      put(said, text);
      clearTimeout(said.timer);
      said.timer = setTimeout(() => put(said, ""), 5000);
    },
  };
  return { problem, pythonError, silence, notice, said, functions };
}

export function put(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Put in a text that is there only if it says something. */
export function show(node, text) {
  put(node, text);
  node.hidden = !text;
}

/** Put in entries, each beside a piece of its line. */
function beside(list, found, entryOf) {
  const key = JSON.stringify(found);
  if (list.dataset.key === key) return;
  list.dataset.key = key;
  list.replaceChildren(...found.map(([which, ...words]) => element("li", {}, swatch(which), ...entryOf(...words))));
}

function fill(list, texts) {
  texts.forEach((text, k) => {
    if (!list.children[k]) list.append(element("li"));
    put(list.children[k], text);
  });
  while (list.children.length > texts.length) list.lastChild.remove();
}
