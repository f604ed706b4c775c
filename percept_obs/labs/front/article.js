// The article: the scene that is read sets the lab, its question runs it, and its words wait for the run.
(() => {
  const SCENES = JSON.parse(document.getElementById("scenes").textContent);
  const ABOVE = window.matchMedia("(max-width: 760px), (max-width: 1000px) and (orientation: portrait)");
  /** Milliseconds of a change between two settings, and between looks at a run that plays. */
  const [CHANGE, LOOK] = [700, 80];
  /** Part of the window at which the scene stands that is read: beside the lab, and below it. */
  const [BESIDE, BELOW] = [0.5, 0.72];

  const isGroup = (value) => value !== null && typeof value === "object" && !Array.isArray(value);

  /** Settings with changes, which in groups are of their parts. */
  const merged = (settings, changes) => {
    const whole = { ...settings };
    for (const [name, value] of Object.entries(changes))
      whole[name] = isGroup(value) && isGroup(whole[name]) ? merged(whole[name], value) : value;
    return whole;
  };

  /** Settings on the way between two: numbers go along, all else is already there. */
  const between = (from, to, part) => {
    if (typeof from === "number" && typeof to === "number") return from + part * (to - from);
    if (Array.isArray(from) && Array.isArray(to) && from.length === to.length)
      return to.map((value, k) => between(from[k], value, part));
    if (!isGroup(from) || !isGroup(to)) return to;
    return Object.fromEntries(Object.entries(to).map(([name, value]) => [name, between(from[name], value, part)]));
  };

  const labOf = () =>
    new Promise((resolve) => {
      const look = () => {
        const [lab] = window.perceptObsLabs ?? [];
        if (lab?.latest.shown) resolve(lab);
        else requestAnimationFrame(look);
      };
      look();
    });

  /** A scene as a question of the lab. */
  const questionOf = ({ name, before, after, kept, right, note }) => ({
    ...{ name, chip: "", ask: "", answers: ["", "", ""], right, tells: "", holds: () => true },
    ...{ before: () => before, after: () => after, kept, on: note?.on, note: note?.text },
    spot: () => ({}),
  });

  /** Let a lab have the questions of the scenes, and none of its own. */
  const ask = ({ screen: { questions } }, scenes) => Object.assign(questions, { all: scenes.map(questionOf), queue: [] });

  /** What the lab shows of a scene. */
  const put = (lab, scene, settings) => {
    const { screen } = lab;
    screen.clock.pause();
    screen.bare = Boolean(scene.bare);
    screen.room = scene.play === false ? scene.after.X0 : null;
    lab.visit(settings, { ...lab.state.view, charts: scene.charts ?? [] });
    screen.turned();
    screen.moved = true;
    screen.clock.rewind();
    if (scene.end) screen.clock.finish();
  };

  class Article {
    constructor(lab) {
      this.lab = lab;
      this.screen = lab.screen;
      this.aloud = document.querySelector("[role=status].unseen");
      this.scene = null;
      this.timer = 0;
      this.frame = 0;
      lab.address?.close();
      lab.address = null;
      const opening = lab.settings;
      this.scenes = SCENES.map((given) => {
        const before = merged(opening, given.settings);
        const node = document.getElementById(given.name);
        return { ...given, node, before, after: merged(before, given.after) };
      });
      ask(lab, this.scenes);
      this.screen.clock.begun = true;
      for (const scene of this.scenes) this.listen(scene);
      let waiting = false;
      const moved = () => {
        waiting ||= Boolean(requestAnimationFrame(() => this.follow((waiting = false))));
      };
      for (const type of ["scroll", "resize"]) window.addEventListener(type, moved, { passive: true });
      document.documentElement.classList.add("alive");
      this.follow();
    }

    /** Set the scene that is read. */
    follow() {
      const line = (ABOVE.matches ? BELOW : BESIDE) * window.innerHeight;
      const read = this.scenes.findLast(({ node }) => node.getBoundingClientRect().top < line) ?? this.scenes[0];
      this.enter(read);
    }

    enter(scene) {
      if (this.scene === scene) return;
      this.leave();
      this.scene = scene;
      document.body.dataset.scene = scene.name;
      put(this.lab, scene, structuredClone(scene.before));
      this.showHand(scene, scene.before);
    }

    /** Nobody waits for a run that is not looked at: its answer is told. */
    leave() {
      cancelAnimationFrame(this.frame);
      if (this.timer) this.tell(this.scene, false);
    }

    listen(scene) {
      const { node, hand } = scene;
      const answers = [...node.querySelectorAll("fieldset button")];
      answers.forEach((button, k) => button.addEventListener("click", () => this.answer(scene, answers, k)));
      node.addEventListener("focusin", () => this.enter(scene));
      node.querySelector(".grab")?.addEventListener("click", () => {
        this.enter(scene);
        this.screen.handles.find((handle) => handle.node.dataset.control === hand).node.focus({ focusVisible: true });
      });
      const slider = node.querySelector(".hand input");
      slider?.addEventListener("input", () => this.move(scene, hand.stops[slider.value].changes));
      slider?.addEventListener("change", () => this.release(scene));
      node.querySelectorAll(".choices button").forEach((button, k) =>
        button.addEventListener("click", () => {
          this.move(scene, hand.stops[k].changes);
          this.release(scene);
        }),
      );
    }

    /** Bring a scene's slider or choices to settings. */
    showHand({ node, before, hand: { stops = [] } }, settings) {
      const plain = (given) => JSON.stringify({ ...given, kept: null });
      const at = stops.findIndex(({ changes }) => plain(merged(before, changes)) === plain(settings));
      const slider = node.querySelector(".hand input");
      node.querySelectorAll(".choices button").forEach((button, k) => {
        button.setAttribute("aria-pressed", String(k === at));
      });
      if (!slider || at < 0) return;
      const { text } = stops[at];
      // Under a hand it stays where it is.
      if (Number(slider.value) !== at) slider.value = at;
      slider.setAttribute("aria-valuetext", text);
      node.querySelector("output").textContent = text;
    }

    /** The hand changes what its scene is about, and nothing else. */
    move(scene, changes) {
      this.enter(scene);
      this.settle(scene);
      this.screen.touch();
      const settings = merged(scene.before, changes);
      this.lab.change(settings);
      this.showHand(scene, settings);
    }

    /** Let go of it: where the run is not seen from its end, it plays. */
    release({ end }) {
      if (!end) this.screen.clock.rewind(true);
      this.lab.rest();
    }

    answer(scene, buttons, k) {
      this.enter(scene);
      this.settle(scene);
      buttons.forEach((button, other) => {
        button.setAttribute("aria-pressed", String(other === k));
        button.classList.toggle("right", other === scene.right);
      });
      scene.node.classList.remove("answered");
      this.timer = setInterval(() => this.played(scene), LOOK);
      if (scene.play === false) this.change(scene);
      else {
        const { questions } = this.screen;
        questions.ask(scene.name);
        questions.answer(k);
      }
      this.showHand(scene, scene.after);
      buttons[k].focus({ preventScroll: true });
    }

    /** Go from the settings before to those after, through those between. */
    change(scene) {
      const { lab, screen } = this;
      const begun = performance.now();
      const step = () => {
        const part = screen.clock.still.matches ? 1 : Math.min(1, (performance.now() - begun) / CHANGE);
        lab.change(between(scene.before, scene.after, part));
        if (part < 1) this.frame = requestAnimationFrame(step);
        else {
          screen.setWhy(Boolean(scene.why));
          lab.rest();
          this.tell(scene);
        }
      };
      step();
    }

    /** Tell the answer once its run was watched, or a hand has broken it off. */
    played(scene) {
      const { questions } = this.screen;
      if (scene.play !== false && (questions.telling || !questions.answered)) this.tell(scene);
    }

    tell(scene, inSight = true) {
      clearInterval(this.timer);
      this.timer = 0;
      scene.node.classList.add("answered");
      const told = scene.node.querySelector(".told");
      this.aloud.textContent = told.textContent;
      if (inSight) told.scrollIntoView({ block: "nearest" });
    }

    /** End what an answer has begun. */
    settle(scene) {
      cancelAnimationFrame(this.frame);
      if (this.timer) this.tell(scene, false);
      this.screen.clock.pause();
      if (this.screen.why) this.screen.setWhy(false);
      this.lab.state.amend({ question: null });
    }
  }

  // On paper each scene has a picture: a second lab draws them all, out of sight, once the first one rests.

  const drawn = (lab) =>
    new Promise((resolve) => {
      const look = () => {
        if (lab.settled && !lab.pending && !lab.late) resolve();
        else setTimeout(look, 20);
      };
      look();
    });

  /** One picture of all that a lab draws. */
  const pictureOf = (lab) => {
    const { root } = lab.view;
    const around = root.getBoundingClientRect();
    const canvas = document.createElement("canvas");
    const pen = canvas.getContext("2d");
    const ratio = 2;
    [canvas.width, canvas.height] = [ratio * around.width, ratio * around.height];
    pen.scale(ratio, ratio);
    for (const { figure, canvas: picture, caption } of lab.figures.filter(({ figure }) => !figure.hidden)) {
      const { left, top, width, height } = figure.getBoundingClientRect();
      const [x, y] = [left - around.left, top - around.top];
      pen.fillStyle = getComputedStyle(figure).backgroundColor;
      pen.fillRect(x, y, width, height);
      pen.drawImage(picture, x, y, width, height);
      if (!caption) continue;
      const { font, color } = getComputedStyle(caption);
      const at = caption.getBoundingClientRect();
      Object.assign(pen, { font, fillStyle: color, textBaseline: "top" });
      pen.fillText(caption.textContent, at.left - around.left, at.top - around.top);
    }
    return canvas.toDataURL();
  };

  const drawStills = async ({ lab, scenes }) => {
    const place = document.createElement("div");
    Object.assign(place, { className: "stage", inert: true });
    place.style.cssText = "position: absolute; left: -2000px; top: 0; width: 860px; height: 560px; padding: 0";
    document.body.append(place);
    const widget = { ...lab.widget, get: (name) => (name === "address" ? undefined : lab.widget.get(name)) };
    const copy = new lab.constructor(widget, place, lab.model);
    copy.openWorker = () => {};
    copy.screen.clock.still = { matches: true };
    ask(copy, scenes);
    copy.view.root.classList.remove("dark");
    for (const scene of scenes) {
      const { after, play, why, node } = scene;
      put(copy, scene, structuredClone(after));
      copy.screen.setWhy(Boolean(why));
      if (play !== false) copy.screen.clock.finish();
      await drawn(copy);
      node.querySelector(".still").src = pictureOf(copy);
    }
    copy.close();
    place.remove();
  };

  labOf().then((lab) => {
    const article = new Article(lab);
    const idle = window.requestIdleCallback ?? ((act) => setTimeout(act, 1000));
    idle(() => drawStills(article));
  });
})();
