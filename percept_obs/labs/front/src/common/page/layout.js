// Where everything stands: pictures, and beside them questions, controls and formulas; words below.

import { Card } from "./card.js";
import { button, element } from "./controls.js";
import { topic } from "./fieldsets.js";
import { Legend } from "./legend.js";
import { Paper } from "./paper.js";
import { Player } from "./player.js";
import { beside, fill, put, show } from "./put.js";
import { Sketch } from "./sketch.js";
import { tabs } from "./tabs.js";
import { WhatIf } from "./what_if.js";
import { zoomable } from "./zooming.js";

const WAITING = "Python has not answered yet: it is computing, or its kernel has ended. The lab works without it.";
const GONE = "There is no Python here. The lab works without it; run its cell to have Python's sentences as well.";

/** What makes something else of the space bar. */
const OWN_SPACE = "input, select, button, summary, a, .player";

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
  const player = new Player(lab);
  const sketch = new Sketch(lab);
  const whatIf = lab.parts.causesOf && new WhatIf(lab);
  const card = new Card(lab, presets, sketch);
  const paper = new Paper(lab, presets);
  const code = element("pre", { class: "code", hidden: true, tabindex: 0 });
  const keep = button("Keep", () => lab.keep(), { "data-control": "keep", "aria-pressed": "false", title: "Keep this run to compare with" });

  async function copy(text, what, then) {
    code.textContent = text;
    code.setAttribute("aria-label", what);
    code.hidden = false;
    try {
      await navigator.clipboard.writeText(text);
      view.say(then);
    } catch {
      view.say("The browser does not let the lab copy; select the lines below.");
    }
  }
  const copyLink = () => copy(lab.address.link(), "Link to this lab as it is now", window.location.protocol === "file:" ? "Copied: it opens where this file is." : "Copied: it opens the lab as it is now.");

  const actions = element(
    "div",
    { class: "actions" },
    ...[history.undo, history.redo, keep],
    button("Copy as code", () => copy(lab.copy(), "Python code of this run", "Copied: paste it into a cell."), { "data-control": "copy" }),
    ...(lab.address ? [button("Copy link", copyLink, { "data-control": "copy link", title: "The address of this page, with the settings of this lab" })] : []),
    button("Reset", () => lab.reset(), { "data-control": "reset" }),
  );
  const chartBox = element("div", { class: "charts", role: "group", "aria-label": "Charts", tabindex: 0 });
  for (const [name, { figure }] of Object.entries(charts)) {
    figure.classList.add(`chart-${name}`);
    chartBox.append(figure);
  }
  const asked = element("div", { class: "asked" }, card.list, card.body, ...(whatIf ? [whatIf.body] : []));
  const more = element("div", { class: "more" }, topic("equations", "Equations, with the present numbers", formulas.body), symbols(lab.parts.symbols));
  const words = element("div", { class: "words" }, reading, verdicts, why, analysis);
  const parts = [
    { name: "question", title: "Question", nodes: [asked] },
    { name: "controls", title: "Controls", nodes: [panel.body] },
    { name: "words", title: "In words", nodes: [words] },
    { name: "equations", title: "Equations", nodes: [more] },
  ];
  const views = planes.map(({ figure, label }) => ({ name: figure.className, title: label.split(",")[0], nodes: [figure] }));
  const eyes = element("div", { class: "eyes" }, tabs("Picture", views), ...planes.map((plane) => plane.figure));
  const root = element(
    "div",
    { class: "percept-lab" },
    ...[problem, pythonError, notice],
    element(
      "div",
      { class: "stage" },
      eyes,
      element("div", { class: "graphs" }, legend.body, chartBox, player.body),
      element("div", { class: "side" }, actions, said, tabs("Beside the pictures", parts), element("div", { class: "scroll" }, asked, panel.body, more)),
      words,
    ),
    ...[silence, live, code],
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
  // Under a pointer nothing moves by itself; who comes by keys sees what the keys will change.
  root.addEventListener("focusin", () => lab.down || eyes.scrollIntoView({ block: "nearest" }));
  for (const chart of Object.values(charts)) zoomable(lab, chart, player);

  let spoken = "";
  const view = {
    root,
    preset: () => card.show(),
    steps: history.show,
    words(found) {
      const verdictOf = ({ which, title, text }) => [which, title, text];
      beside(verdicts, found.verdicts.map(verdictOf), (title, text) => [element("strong", {}, `${title}:`), ` ${text}`]);
      legend.show(found.legend);
      fill(why, found.reasons);
      spoken = found.problem ?? found.verdicts.map(({ title, text }) => `${title}: ${text}`).join(". ");
      const { settings } = lab;
      put(keep, settings.kept ? "Forget" : "Keep");
      keep.setAttribute("aria-pressed", String(Boolean(settings.kept)));
      code.hidden ||= code.textContent !== lab.copy();
    },
    rested() {
      put(live, spoken);
      whatIf?.show();
    },
    read: (text) => put(reading, text),
    time(cursor) {
      player.show(cursor);
      sketch.show();
    },
    playing: () => player.playing,
    close() {
      player.close();
      paper.close();
    },
    ...functions,
    analysis: (sentences) => fill(analysis, sentences),
    answered: (answer) => analysis.classList.toggle("of-others", !answer),
  };
  return view;
}

/** What the letters and words of a lab stand for. */
function symbols(entries) {
  const rows = entries.map(([symbol, meaning]) => {
    const term = element("th", { scope: "row" });
    term.innerHTML = symbol;
    return element("tr", {}, term, element("td", {}, meaning));
  });
  return topic("symbols", "Symbols and words", element("table", { class: "symbols" }, ...rows));
}

/** The keys of undo and redo; Jupyter would take arrows, letters and Enter for commands of its own. */
export function keys(root, lab) {
  // It looks for commands from the focus outwards up to this attribute, and finds some at the focus itself.
  root.addEventListener("focusin", ({ target }) => target.setAttribute("data-lm-suppress-shortcuts", "true"));
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
      show(silence, error === undefined ? "" : error ? GONE : WAITING),
    say(text) {
      put(said, text);
      clearTimeout(said.timer);
      said.timer = setTimeout(() => put(said, ""), 5000);
    },
  };
  return { problem, pythonError, silence, notice, said, functions };
}
