// Where everything stands: presets, pictures, words, controls, formulas. Words are put in only when they change.

import { button, element } from "./controls.js";
import { swatch } from "./lines.js";
import style from "./style.css";

/** Build the lab's page inside an element. */
export function build(lab, place, presets) {
  const { charts, panel, formulas } = lab;
  const problem = element("p", { class: "problem", role: "alert", hidden: true });
  const pythonError = element("p", { class: "problem percept-obs-error", role: "alert", hidden: true });
  const silence = element("p", { class: "silence", role: "status", hidden: true });
  const notice = element("p", { class: "notice", role: "status", hidden: true });
  const live = element("p", { class: "unseen", role: "status", "aria-live": "polite" });
  const verdicts = element("ul", { class: "verdicts" });
  const why = element("ul", { class: "why" });
  const analysis = element("ul", { class: "analysis" });
  const reading = element("p", { class: "reading" });
  const legend = element("ul", { class: "legend", "aria-label": "Lines" });
  const card = element("div", { class: "card", hidden: true });
  const code = element("pre", { class: "code", hidden: true, tabindex: 0, "aria-label": "Python code of this run" });
  const keep = button("Keep this run", () => lab.keep(), { "data-control": "keep", "aria-pressed": "false" });
  const back = button("Back", () => closeCard(), { "data-control": "back", hidden: true });
  const cursor = element("input", { type: "range", min: 0, max: 1, step: 0.001, value: 0, "data-control": "cursor" });
  cursor.setAttribute("aria-label", "Time at which values are read");

  function ask(preset) {
    const acts = preset.acts.map((act, number) =>
      button(act.button, () => show(preset, number), { class: "act", "data-control": `act ${preset.name} ${number}` }),
    );
    acts.slice(1).forEach((later) => (later.hidden = true));
    const answer = element("p", { class: "answer", role: "status" });
    const close = button("Back to my settings", closeCard, { "data-control": "way back" });
    card.replaceChildren(element("p", { class: "question" }, preset.question), answer, element("div", {}, ...acts, close));
    card.hidden = false;
    card.show = { acts, answer };
    mark(preset.name);
  }

  function show(preset, number) {
    lab.act(preset, number);
    card.show.answer.textContent = preset.acts[number].answer;
    card.show.acts.forEach((act, k) => (act.hidden = k > number + 1));
    back.hidden = false;
  }

  function mark(name) {
    for (const chip of chips) chip.setAttribute("aria-expanded", String(chip.dataset.preset === name));
  }

  function closeCard() {
    lab.goBack();
    forgetPreset();
  }

  function forgetPreset() {
    const inside = card.contains(document.activeElement);
    card.hidden = true;
    card.replaceChildren();
    back.hidden = true;
    mark("");
    // The button that had the focus is gone; without this the keyboard would start from the top of the page.
    if (inside) chips[0].focus();
  }

  const chips = presets.map((preset) =>
    button(preset.title, () => ask(preset), {
      class: "chip",
      "aria-expanded": "false",
      "data-preset": preset.name,
      "data-control": `preset ${preset.name}`,
    }),
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

  const said = element("span", { class: "said", role: "status" });
  const actions = element(
    "div",
    { class: "actions" },
    back,
    keep,
    button("Copy as code", copy, { "data-control": "copy" }),
    button("Reset", () => lab.reset(), { "data-control": "reset" }),
    said,
  );
  const chartBox = element("div", { class: "charts" }, ...Object.values(charts).map((chart) => chart.figure));
  const details = element("details", { class: "equations" }, element("summary", { "data-control": "equations" }, "Equations, with the present numbers"));
  details.append(formulas.body);
  const root = element(
    "div",
    { class: "percept-lab", "data-lm-suppress-shortcuts": "true" },
    element("style", {}, style),
    element("div", { class: "bar" }, element("div", { class: "chips", role: "group", "aria-label": "Questions" }, ...chips), actions),
    card,
    code,
    problem,
    pythonError,
    notice,
    ...(lab.head ? [lab.head] : []),
    element(
      "div",
      { class: "stage" },
      element("div", { class: "left" }, ...(lab.planes ?? [lab.plane]).map((plane) => plane.figure)),
      element("div", { class: "right" }, legend, chartBox, element("label", { class: "cursor" }, element("span", {}, "read at"), cursor), reading),
      element("div", { class: "words" }, verdicts, why),
    ),
    silence,
    live,
    panel.body,
    element("details", { class: "deeper", open: true }, element("summary", { "data-control": "deeper" }, "What Python adds"), analysis),
    details,
  );
  place.replaceChildren(root);

  // JupyterLab would take arrows, letters and Enter for commands of its own.
  for (const type of ["keydown", "keyup", "keypress"]) root.addEventListener(type, (event) => event.stopPropagation());
  cursor.addEventListener("input", () => {
    const { time } = lab.shown;
    if (time.length) lab.point(time[0] + Number(cursor.value) * (time.at(-1) - time[0]));
  });
  for (const chart of Object.values(charts)) {
    chart.canvas.addEventListener("pointermove", (event) => lab.point(chart.timeAt(event.clientX)));
    chart.canvas.addEventListener("pointerleave", () => lab.point(null));
  }

  let spoken = "";
  const view = {
    root,
    forgetPreset,
    words(found) {
      fillVerdicts(verdicts, found.verdicts);
      fill(why, found.reasons);
      put(reading, found.reading);
      spoken = found.problem ?? found.verdicts.map(({ title, text }) => `${title}: ${text}`).join(". ");
      const { settings } = lab;
      put(keep, settings.kept ? "Forget the kept run" : "Keep this run");
      keep.setAttribute("aria-pressed", String(Boolean(settings.kept)));
      code.hidden ||= code.textContent !== lab.copy();
      const key = JSON.stringify(found.legend);
      if (legend.dataset.key === key) return;
      legend.dataset.key = key;
      legend.replaceChildren(...found.legend.map(([which, text]) => element("li", {}, swatch(which), text)));
    },
    rested() {
      put(live, spoken);
    },
    notice(text) {
      put(notice, text);
      notice.hidden = !text;
    },
    analysis(sentences) {
      fill(analysis, sentences);
    },
    problem(text) {
      put(problem, text);
      problem.hidden = !text;
    },
    pythonError(text) {
      put(pythonError, text && `Python says: ${text}`);
      pythonError.hidden = !text;
    },
    silence(error) {
      silence.hidden = error === undefined;
      put(silence, error === undefined ? "" : "Python does not answer: it is busy or gone. The lab goes on without it.");
    },
    say(text) {
      put(said, text);
      clearTimeout(said.timer);
      said.timer = setTimeout(() => put(said, ""), 5000);
    },
  };
  return view;
}

function put(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** What happened in each run, beside a piece of its line. */
function fillVerdicts(list, found) {
  const key = JSON.stringify(found);
  if (list.dataset.key === key) return;
  list.dataset.key = key;
  list.replaceChildren(
    ...found.map(({ which, title, text }) => element("li", {}, swatch(which), element("strong", {}, `${title}:`), ` ${text}`)),
  );
}

function fill(list, texts) {
  texts.forEach((text, k) => {
    if (!list.children[k]) list.append(element("li"));
    put(list.children[k], text);
  });
  while (list.children.length > texts.length) list.lastChild.remove();
}
