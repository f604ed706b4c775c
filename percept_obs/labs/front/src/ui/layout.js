// Where everything stands: pictures, and beside them controls and formulas; words below.

import { button, element, listen, setItems, setOptionalText, setText } from "./dom.js";
import { topic } from "./fieldsets.js";
import { Legend } from "../old/legend.js";
import { swatch } from "../old/line_styles.js";
import { Player } from "../old/player.js";
import { zoomByHand } from "../old/time_charts.js";
import { WhatIf } from "../old/what_if.js";

const WAITING = "Python has not answered yet: it is computing, or its kernel has ended. The lab works without it.";
const GONE = "There is no Python here. The lab works without it; run its cell to have Python's sentences as well.";
const NO_CLIPBOARD = "The browser does not let the lab copy; select the lines below.";

/** Elements that use the space bar themselves. */
const OWN_SPACE = "input, select, button, summary, a, .player";

/** Build the page of a lab, and return its view: the functions that bring the page to what is shown. */
export function build(lab, place) {
  const { planes, charts, panel, formulas } = lab;
  const messages = messagesOf();
  const history = historyButtons(lab);
  const live = element("p", { class: "unseen", role: "status", "aria-live": "polite" });
  const verdicts = element("ul", { class: "verdicts" });
  const why = element("ul", { class: "why" });
  const analysis = element("ul", { class: "analysis" });
  const reading = element("p", { class: "reading" });
  const legend = new Legend(lab);
  const player = new Player(lab);
  const whatIf = lab.parts.causesOf && new WhatIf(lab);
  const code = element("pre", { class: "code", hidden: true, tabindex: 0 });
  const keep = button("Keep", () => lab.keep(), {
    ...{ "data-control": "keep", "aria-pressed": "false", title: "Keep this run to compare with" },
  });

  async function copy(text, label, then) {
    code.textContent = text;
    code.setAttribute("aria-label", label);
    code.hidden = false;
    try {
      await navigator.clipboard.writeText(text);
      messages.say(then);
    } catch {
      messages.say(NO_CLIPBOARD);
    }
  }
  const copyCode = () => copy(lab.copy(), "Python code of this run", "Copied: paste it into a cell.");
  const copyLink = () => {
    const then = window.location.protocol === "file:" ? "it opens where this file is" : "it opens the lab as it is now";
    return copy(lab.address.link(), "Link to this lab as it is now", `Copied: ${then}.`);
  };
  const linkTitle = "The address of this page, with the settings of this lab";
  const actions = element(
    "div",
    { class: "actions" },
    ...[history.undo, history.redo, keep],
    button("Copy as code", copyCode, { "data-control": "copy" }),
    ...(lab.address ? [button("Copy link", copyLink, { "data-control": "copy link", title: linkTitle })] : []),
    button("Reset", () => lab.reset(), { "data-control": "reset" }),
    button("First screen", () => lab.turn("first"), { "data-control": "first screen" }),
  );
  const chartBox = element("div", { class: "charts", role: "group", "aria-label": "Charts", tabindex: 0 });
  for (const [name, chart] of Object.entries(charts)) {
    chart.figure.classList.add(`chart-${name}`);
    chartBox.append(chart.figure);
    zoomByHand(lab, chart, player);
  }
  const equations = topic("equations", "Equations, with the present numbers", formulas.body);
  const more = element("div", { class: "more" }, equations, symbolTable(lab.parts.symbols));
  const words = element("div", { class: "words" }, reading, verdicts, why, analysis);
  const sideTabs = tabs("Beside the pictures", [
    { name: "controls", title: "Controls", node: panel.body },
    ...(whatIf ? [{ name: "causes", title: "What if?", node: whatIf.body }] : []),
    { name: "words", title: "In words", node: words },
    { name: "equations", title: "Equations", node: more },
  ]);
  const pictures = planes.map(({ figure, label }) => {
    return { name: figure.className, title: label.split(",")[0], node: figure };
  });
  const eyes = element("div", { class: "eyes" }, tabs("Picture", pictures), ...planes.map((plane) => plane.figure));
  const scroll = element("div", { class: "scroll" }, ...(whatIf ? [whatIf.body] : []), panel.body, more);
  const root = element(
    "div",
    { class: "percept-lab", "data-face": lab.face },
    ...[messages.problem, messages.pythonError, messages.notice],
    lab.first.body,
    element(
      "div",
      { class: "stage" },
      eyes,
      element("div", { class: "graphs" }, legend.body, chartBox, player.body),
      element("div", { class: "side" }, actions, messages.said, sideTabs, scroll),
      words,
    ),
    ...[messages.silence, live, code],
  );
  place.append(root);

  keys(root, lab);
  listen(root, {
    keydown: (event) => {
      if (event.key !== " " || event.defaultPrevented || event.target.closest(OWN_SPACE)) return;
      event.preventDefault();
      (lab.face === "first" ? lab.first : player).toggle();
    },
    // Under a pointer nothing moves by itself; who comes by keys sees what the keys will change.
    focusin: () => lab.down || lab.face === "first" || eyes.scrollIntoView({ block: "nearest" }),
  });
  for (const type of ["pointerdown", "pointerup", "pointercancel"]) {
    root.addEventListener(type, () => lab.hold(type === "pointerdown"), true);
  }

  let spoken = "";
  return {
    root,
    ...messages.functions,
    turn: (face) => root.setAttribute("data-face", face),
    steps: history.show,
    words(found) {
      setVerdicts(verdicts, found.verdicts);
      legend.show(found.legend);
      setItems(why, found.reasons);
      spoken = found.problem ?? found.verdicts.map(({ title, text }) => `${title}: ${text}`).join(". ");
      const { kept } = lab.settings;
      setText(keep, kept ? "Forget" : "Keep");
      keep.setAttribute("aria-pressed", String(Boolean(kept)));
      code.hidden ||= code.textContent !== lab.copy();
    },
    rested() {
      setText(live, spoken);
      whatIf?.show();
    },
    read: (text) => setText(reading, text),
    time: (cursor) => player.show(cursor),
    playing: () => player.playing,
    close: () => player.pause(),
    analysis: (sentences) => setItems(analysis, sentences),
    answered: (answer) => analysis.classList.toggle("of-others", !answer),
  };
}

/** Set the items of a list, each a title and a text after a sample of its line. */
function setVerdicts(list, verdicts) {
  const key = JSON.stringify(verdicts);
  if (list.dataset.key === key) return;
  list.dataset.key = key;
  const item = ({ which, title, text }) =>
    element("li", {}, swatch(which), element("strong", {}, `${title}:`), ` ${text}`);
  list.replaceChildren(...verdicts.map(item));
}

/** A row of buttons for parts of which a small screen shows one at a time; where there is room all are in sight. */
function tabs(label, parts) {
  const choose = (chosen) => {
    parts.forEach(({ name, node }, k) => {
      node.classList.toggle("away", name !== chosen);
      presses[k].setAttribute("aria-pressed", String(name === chosen));
    });
  };
  const presses = parts.map(({ name, title }) => button(title, () => choose(name), { "data-control": `tab ${name}` }));
  choose(parts[0].name);
  return element("div", { class: "tabs", role: "group", "aria-label": label }, ...presses);
}

/** Table of symbols and their meaning. */
function symbolTable(entries) {
  const rows = entries.map(([symbol, meaning]) => {
    const term = element("th", { scope: "row" });
    term.innerHTML = symbol;
    return element("tr", {}, term, element("td", {}, meaning));
  });
  return topic("symbols", "Symbols and words", element("table", { class: "symbols" }, ...rows));
}

/** Take the keys of undo and redo, and keep all from Jupyter, which has commands on arrows, letters and Enter. */
export function keys(root, lab) {
  // It looks for commands from the focus outwards up to this attribute, and finds some at the focus itself.
  root.addEventListener("focusin", ({ target }) => target.setAttribute("data-lm-suppress-shortcuts", "true"));
  root.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.key.toLowerCase() !== "z") return;
    event.preventDefault();
    if (event.shiftKey) lab.redo();
    else lab.undo();
  });
  listen(root, { "keydown keyup keypress": (event) => event.stopPropagation() });
}

/** The buttons of undo and redo, and the function that brings them to the history. */
export function historyButtons(lab) {
  const undo = button("Undo", () => lab.undo(), { "data-control": "undo", title: "Ctrl+Z" });
  const redo = button("Redo", () => lab.redo(), { "data-control": "redo", title: "Ctrl+Shift+Z" });
  const show = ({ past, future }) => {
    // Not disabled, which would take the focus away from the last step.
    undo.setAttribute("aria-disabled", String(!past.length));
    redo.setAttribute("aria-disabled", String(!future.length));
  };
  return { undo, redo, show };
}

/** Elements for what the page says of Python and of itself, with the functions that say it. */
export function messagesOf() {
  const paragraph = (className, role) => element("p", { class: className, role, hidden: true });
  const problem = paragraph("problem", "alert");
  const pythonError = paragraph("problem percept-obs-error", "alert");
  const silence = paragraph("silence", "status");
  const notice = paragraph("notice", "status");
  const said = element("span", { class: "said", role: "status" });
  const say = (text) => {
    setText(said, text);
    clearTimeout(said.timer);
    said.timer = setTimeout(() => setText(said, ""), 5000);
  };
  const functions = {
    say,
    notice: (text) => setOptionalText(notice, text),
    problem: (text) => setOptionalText(problem, text),
    pythonError: (text) => setOptionalText(pythonError, text && `Python says: ${text}`),
    silence: (error) => setOptionalText(silence, error === undefined ? "" : error ? GONE : WAITING),
  };
  return { problem, pythonError, silence, notice, said, say, functions };
}
