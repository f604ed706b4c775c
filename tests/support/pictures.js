// What is written in the pictures of a lab, and how much of the first screen is what.
{
  const { first } = window.tests;
  const pen = CanvasRenderingContext2D.prototype;
  const isText = (node) => node.checkVisibility({ visibilityProperty: true }) && node.textContent.trim();

  /** Texts of all pictures in sight, on the canvas and above it, and those that a painter wrote without reporting. */
  function texts() {
    const lab = first();
    const { fillText } = pen;
    const drawn = [];
    pen.fillText = function (text, x, y) {
      drawn.push([this.canvas, text, x, y]);
      fillText.call(this, text, x, y);
    };
    if (lab.screen) lab.screen.draw(lab.shown, lab.ghost, lab.theme);
    pen.fillText = fillText;
    return lab.figures.filter(({ figure }) => figure.checkVisibility()).map((view) => {
      const { canvas, figure, width, height, texts: reported } = view;
      const told = ([, text, x, y]) => reported.some(({ text: other, box }) => text === other
        && box[0] <= x && x <= box[2] && box[1] <= y && y <= box[3]);
      const { left, top } = figure.getBoundingClientRect();
      const range = document.createRange();
      const above = [...figure.querySelectorAll("button, p, figcaption, text")].filter(isText).map((node) => {
        if (node.tagName === "BUTTON") range.selectNode(node);
        else range.selectNodeContents(node);
        const box = range.getBoundingClientRect();
        return { text: node.textContent, box: [box.left - left, box.top - top, box.right - left, box.bottom - top] };
      });
      const unknown = above.filter(({ text }) => !reported.some((each) => each.text === text));
      const secret = drawn.filter((each) => each[0] === canvas && !told(each)).map(([, text]) => text);
      return { width, height, texts: [...reported, ...unknown], secret };
    });
  }

  Object.assign(window.tests, {
    /** Texts of the pictures that are cut or not reported, and pairs that cover each other. */
    overlaps: () => texts().flatMap(({ width, height, texts: all, secret }) => [
      ...secret.map((text) => ["not reported", text]),
      ...all.flatMap(({ text, box: [left, top, right, bottom] }, k) => [
        ...(left < 0 || top < 0 || right > width || bottom > height ? [["cut", text]] : []),
        ...all.slice(k + 1).filter(({ box }) => left < box[2] && right > box[0] && top < box[3] && bottom > box[1])
          .map((other) => [text, other.text]),
      ]),
    ]),

    /** How many controls and words the first screen has, and how large the pictures are in it. */
    counts() {
      const { screen } = first();
      const words = (text) => text.split(/[^\p{L}\p{N}.]+/u).filter((word) => /[\p{L}]/u.test(word)).length;
      const nodes = [...screen.body.querySelectorAll("[data-control]")].filter((node) => node.checkVisibility());
      const said = [...screen.body.querySelectorAll("*")].filter((node) => node.checkVisibility()
        && !node.children.length && !node.closest(".unseen, .handle, canvas, svg")).map((node) => node.textContent);
      const own = [...screen.body.querySelectorAll("label, .sliding > span")].flatMap((node) =>
        [...node.childNodes].filter((child) => child.nodeType === 3).map((child) => child.textContent));
      const drawn = screen.views.flatMap((view) => view.texts.map(({ text }) => text));
      const { width, height } = screen.body.getBoundingClientRect();
      const area = screen.views.reduce((sum, { figure }) => {
        const box = figure.getBoundingClientRect();
        return sum + box.width * box.height;
      }, 0);
      const counted = words([...said, ...own, ...drawn].join(" "));
      return { controls: nodes.length, words: counted, share: area / (width * height) };
    },

    /** Words, controls and width of the desk. */
    desk() {
      for (const node of document.querySelectorAll(".unseen")) node.remove(); // it is heard
      const nodes = [...document.querySelectorAll("[data-control]")];
      const written = first().figures.flatMap((view) => view.texts.map(({ text }) => text));
      return {
        controls: nodes.filter((node) => node.checkVisibility({ visibilityProperty: true })).length,
        words: [document.querySelector(".percept-lab").innerText, ...written].join(" "),
        across: document.documentElement.scrollWidth,
      };
    },

    /** Set the first screen's controls, handles and time at random, the same for the same seed. */
    vary(seed) {
      const lab = first();
      let state = seed;
      const random = () => (state = (state * 16807) % 2147483647) / 2147483647;
      for (let k = 0; k < 5; k++) random();
      for (const box of lab.screen.body.querySelectorAll(".handy input[type=range], .handy input[type=checkbox]")) {
        if (box.type === "checkbox") {
          if (random() < 0.5) box.click();
          continue;
        }
        const [low, high, step] = [box.min, box.max, box.step].map(Number);
        box.value = low + Math.round((random() * (high - low)) / step) * step;
        box.dispatchEvent(new Event("input", { bubbles: true }));
      }
      for (const handle of lab.screen.handles) {
        if (handle.at) handle.move(handle.at.map((value) => value + (random() - 0.5) * handle.nudge * 60));
      }
      lab.screen.setWhy(random() < 0.3);
      lab.state.cursor = random() * lab.screen.clock.end;
      return lab.rest();
    },

    /** What is looked at: the drawer's group, and with one the first two charts. */
    look(more) {
      const lab = first();
      lab.look({ more, charts: more ? Object.keys(lab.parts.charts).slice(0, 2) : [] });
    },

    /** Colours of the picture at a film's track and beside it, once the frame of the time is there, and its texts. */
    async under() {
      const lab = first();
      const { film, image, clock } = lab.screen;
      const { time } = film.films[0];
      lab.paint();
      const { seen } = lab.screen;
      const off = (each) => Math.abs(each - seen.recorded.begin - clock.present());
      const key = `0 ${time.reduce((best, each, k) => (off(each) < off(time[best]) ? k : best), 0)}`;
      for (let tries = 0; film.last !== key && tries < 200; tries++) {
        lab.redraw();
        await new Promise((done) => setTimeout(done, 10));
      }
      const ratio = window.devicePixelRatio;
      const [c1, c2, scale] = image.at;
      const x = image.width / 2 + (seen.y[0] - c1) * scale;
      const y = image.height / 2 - seen.up * (seen.y[1] - c2) * scale;
      const at = (u, v) => Array.from(image.context.getImageData((x + u) * ratio, (y + v) * ratio, 1, 1).data);
      const [inside, outside] = [at(0, 6), at(-0.1 * scale, 0.1 * scale)];
      return { shown: film.last === key, above: y < image.height / 2, inside, outside, texts: image.texts };
    },

    /** What can be pressed, seen and read of a lab on paper. */
    onPaper() {
      const root = document.querySelector(".percept-lab");
      const count = (which) => [...root.querySelectorAll(which)].filter((node) => node.checkVisibility()).length;
      return { pressed: count("button, input, select, summary"), pictures: count("canvas"), said: count(".says") };
    },
  });
}
