// What is measured while a lab computes in a worker or plays, and a lab as a notebook's page keeps it.
{
  const { first, frame } = window.tests;
  const handleOf = (name) => first().screen.handles.find(({ node }) => node.dataset.control === name);

  Object.assign(window.tests, {
    /** True where a worker computes. */
    beside: () => Boolean(first().latest.beside),
    touch: () => first().change({ duration: first().settings.duration - 1 }),
    /** Count the runs of the page's own engines in `window.runs`. */
    countRuns() {
      window.runs = 0;
      for (const engine of first().results.engines) {
        const own = engine.run.bind(engine);
        engine.run = (...given) => {
          window.runs += 1;
          return own(...given);
        };
      }
    },
    /** Change settings; how long the picture takes, and how long the page was blocked at most. */
    blocked: (changes) => new Promise((resolve) => {
      const lab = first();
      let [longest, turns] = [0, 0];
      const tasks = new PerformanceObserver((list) => {
        for (const { duration } of list.getEntries()) longest = Math.max(longest, duration);
      });
      tasks.observe({ type: "longtask" });
      const began = performance.now();
      lab.change(changes);
      const look = () => {
        turns += 1;
        if (lab.shown.settings !== lab.settings) return setTimeout(look);
        tasks.disconnect();
        return resolve({ took: performance.now() - began, longest, turns });
      };
      look();
    }),
    async steer(count) {
      for (let k = 0; k < count; k++) {
        first().screen.steer([0.1 + 0.05 * Math.sin(k / 9), 0]);
        await frame();
      }
    },
    place: (name) => handleOf(name).at,
    /** Press keys on a handle while pictures are of the settings before. */
    keysFasterThanPictures(name) {
      const { node } = handleOf(name);
      for (const key of ["ArrowRight", "ArrowRight", "ArrowUp"]) {
        node.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
        first().paint();
      }
      node.dispatchEvent(new KeyboardEvent("keyup", { key: "ArrowUp", bubbles: true }));
    },
    /** Play for so many seconds, from the start again at the end: frames of the screen, and pictures that were drawn. */
    async play(seconds) {
      const lab = first();
      const play = document.querySelector('[data-control="play"]');
      const [began, before] = [performance.now(), lab.pictures];
      let frames = 0;
      for (; performance.now() - began < 1000 * seconds; frames++) {
        if (!lab.screen.clock.playing) play.click();
        await frame();
      }
      if (lab.screen.clock.playing) play.click();
      return { frames, pictures: lab.pictures - before };
    },

    /** Show a lab from the state that a notebook's page keeps of it, as nbconvert writes it. */
    async showSaved({ state, buffers }) {
      for (const { path, data } of buffers) {
        state[path[0]] = new DataView(Uint8Array.from(atob(data), (c) => c.charCodeAt(0)).buffer);
      }
      const model = {
        get: (name) => state[name],
        set: (name, value) => (state[name] = value),
        save_changes: () => {
          throw new Error("there is no Python");
        },
        on: () => {},
        off: () => {},
      };
      const text = new Blob([state._esm], { type: "text/javascript" });
      const bundle = await import(URL.createObjectURL(text));
      await bundle.default.render({ model, el: document.body });
    },
    /** Tick every observer that can be. */
    tickAll() {
      for (const box of document.querySelectorAll("[data-control^='observer ']")) if (!box.disabled && !box.checked) box.click();
    },
    /** Names of observers that have an estimate, and of those that are refused. */
    observers: () => [
      ...first().shown.runs.filter((run) => run.estimate.some((v) => Number.isFinite(v))).map((run) => run.name),
      ...Object.keys(first().kernels.refused(first().settings)),
    ],
  });
}
