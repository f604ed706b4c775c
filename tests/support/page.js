// What tests ask of a page with labs and do with it, in a word each: `tests.rested()`.  It stands in every page that
// they open, before anything else.
{
  const labs = () => [...(window.perceptObsLabs ?? [])];
  const first = () => labs()[0];
  const numbers = (values) => Array.from(values, (v) => (Number.isFinite(v) ? v : null));
  const named = (names, of) => Object.fromEntries(names.map((name) => [name, of(name)]));
  const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
  const isShown = (lab) => lab.shown && lab.shown.settings === lab.settings && !lab.pending && lab.settled !== false;
  const controls = () => [...document.querySelectorAll(".percept-lab [data-control]")];
  const usable = (control) => !control.disabled && control.checkVisibility();

  window.tests = {
    labs,
    first,
    frame,
    usable,

    // Where a lab is.

    /** True once pictures and words of the first lab are of the present settings. */
    drawn: () => Boolean(first() && isShown(first())),
    /** True once every lab shows its latest settings and Python has answered. */
    rested: () => labs().length > 0 && labs().every((lab) => isShown(lab) && lab.resting === null
      && lab.link.waitingFor === null && lab.link.sent?.settings === lab.settings),
    /** True once so many labs have come to rest, with Python or without. */
    settled: (count) => labs().length === count && labs().every((lab) => lab.settled && !lab.pending
      && (!lab.widget.save_changes || lab.link.waitingFor === null)),
    /** True once every place of a lab in the page has one that has drawn. */
    allDrawn: () => document.querySelectorAll("[data-percept-obs]").length === labs().length
      && labs().every((lab) => lab.shown && lab.settled !== false && !lab.pending),
    ready: () => labs().some((lab) => lab.screen?.scene),
    played: () => !first().screen.clock.playing && !first().screen.clock.secret,
    watched: () => !first().late && !first().screen.clock.playing && !first().screen.clock.waiting
      && first().screen.questions.telling,
    /** Wait until what has changed is laid out and handed to the screen, and what that changes as well. */
    async painted() {
      for (let k = 0; k < 3; k++) await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
    },
    /** Wait until no view is on its way. */
    async still() {
      for (let calm = 0, tries = 0; calm < 3 && tries < 300; tries++) {
        calm = first().pending || first().late ? 0 : calm + 1;
        await frame();
      }
    },

    // What a hand does.

    reset: () => first().screen.again(),
    /** Show the end of the run at once, as if it had been played. */
    finish() {
      const { clock } = first().screen;
      clock.begun = true;
      clock.finish();
    },
    point(time) {
      first().screen.clock.pause();
      first().point(time);
      first().paint();
    },
    ask: (name) => first().screen.questions.ask(name),
    width(width) {
      document.querySelector(".percept-lab").parentElement.style.width = width;
    },
    /** Open the drawers with all their groups at once, so that every control can be tried. */
    unfold() {
      for (const lab of labs()) {
        const { drawer } = lab;
        for (const fold of lab.view.root.querySelectorAll("details")) fold.open = true;
        if (!drawer || drawer.unfolded) continue;
        const show = drawer.show.bind(drawer);
        drawer.unfolded = true;
        drawer.show = () => {
          show();
          drawer.body.hidden = false;
          drawer.panel.show();
          for (const fold of drawer.folds) fold.open = true;
          if (lab.shown?.whole && !lab.shown.problem) for (const group of drawer.groups) group.show?.();
        };
        lab.state.amend({ view: { ...lab.state.view, more: "words" } });
        lab.looked();
      }
    },

    // What a lab has.

    settings: (which = 0) => labs()[which].settings,
    /** Settings of all labs as they stand in the page. */
    allSettings: () => [...document.querySelectorAll(".percept-lab")].map((root) =>
      labs().find((lab) => lab.view.root === root).settings),
    /** Numbers of the labs from above: which opens first is the front end's affair. */
    order() {
      const tops = labs().map((lab) => lab.view.root.getBoundingClientRect().top);
      return tops.map((_, k) => k).sort((a, b) => tops[a] - tops[b]);
    },
    /** Settings, estimates, lines and words of a lab. */
    state(which = 0) {
      const lab = labs()[which];
      const { settings, shown, screen, state, view: { root } } = lab;
      const runs = shown.runs ?? [{ ...shown, name: "points" }]; // many points are one run
      const by = (pick) => Object.fromEntries(runs.map((run) => [run.name, pick(run)]));
      const charts = { first: screen.chart, ...named(state.view.charts, (name) => screen.charts[name]) };
      const shownOnes = Object.entries(charts).filter(([, { chart }]) => chart && !shown.problem);
      const of = (pick) => Object.fromEntries(shownOnes.map(([name, { chart }]) => [name, pick(chart)]));
      const told = shown.problem ? { verdicts: [], reasons: [] } : lab.told();
      const verdicts = told.verdicts.map(({ title, text }) => `${title}: ${text}`);
      return {
        settings,
        runs: by((run) => numbers(run.estimate)),
        divergedAt: by((run) => run.divergedAt),
        drawn: of(({ lines }) => lines.map(({ id, values }) => ({ name: id, values: numbers(values) }))),
        bars: of(({ bars }) => bars?.rows.flat().length ?? 0),
        verdicts,
        words: [...verdicts, ...told.reasons, ...(lab.answered()?.sentences ?? [])].join(" "),
        labels: screen.views.filter(({ figure }) => !figure.hidden).map(({ canvas }) => canvas.ariaLabel),
        problems: [...root.querySelectorAll(".problem:not([hidden])")].map((node) => node.textContent),
        notice: root.querySelector(".notice").textContent,
        silent: !root.querySelector(".silence").hidden,
      };
    },
    colours: () => first().theme?.lines.join(),
    /** Names of the controls of the first lab that can be used now. */
    controls: () => [...first().view.root.querySelectorAll("[data-control]")].filter(usable)
      .map((control) => control.dataset.control),
    /** Names of the controls on which the Tab key comes by. */
    stops: () => controls().filter((node) => usable(node) && (node.type !== "radio" || node.checked))
      .map((control) => control.dataset.control),
    /** Parts of a lab that are wider than it. */
    outside() {
      const lab = document.querySelector(".percept-lab");
      return [...lab.querySelectorAll("canvas, .actions, .control")].filter((node) =>
        node.getBoundingClientRect().right > lab.getBoundingClientRect().right + 1).map((node) => node.className);
    },
    /** Serious and critical findings of axe-core, and how many rules hold. */
    async violations() {
      // Of rules that hold only one place is told: thousands of places would take longer than the search.
      const { passes, violations } = await window.axe.run(".percept-lab", { resultTypes: ["violations"] });
      const serious = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
      return [passes.length, serious.map(({ id, nodes }) => [id, nodes.map(({ html }) => html)])];
    },

    // The keyboard.

    /** Note whether keys move what has the focus. */
    listen() {
      window.moved = false;
      const value = (node) => `${node.value} ${node.checked}`;
      window.tests.value = value;
      document.addEventListener("keyup", ({ target }) => {
        window.moved ||= target !== window.focused || target.opening !== value(target);
      }, true);
    },
    /** What has the focus, whether it stands as it did when it first had it, and whether keys have moved it since. */
    async focused() {
      await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
      const node = document.activeElement;
      const { value } = window.tests;
      node.opening ??= value(node);
      const [there, back] = [Boolean(node.closest(".percept-lab")), node.opening === value(node)];
      const found = { name: node.dataset.control ?? "", kind: node.type, there, back, moved: window.moved };
      Object.assign(window, { focused: node, moved: false });
      return found;
    },

    // JupyterLab.

    allRan() {
      const prompts = [...document.querySelectorAll(".jp-CodeCell .jp-InputPrompt")];
      return prompts.length > 0 && prompts.every((prompt) => /\[\d+\]/.test(prompt.textContent));
    },
    /** What JupyterLab's log console has; empty without entries. */
    log() {
      const item = document.querySelector(".jp-LogConsoleStatusItem");
      return item && /[1-9]/.test(item.textContent) ? item.title || item.textContent : "";
    },
  };
}
