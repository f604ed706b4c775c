// Random events over every control of a lab, the same for the same seed; what went wrong and what was used is returned.
// Some of the events go to a control that was not used yet, of those that are wanted, so that all have their turn.  Now
// and then the lab may come to rest, and then all that it shows must be what a fresh engine makes of its settings.
window.tests.events = async (seed, count, most = 20000, wanted = []) => {
    const [lab] = window.perceptObsLabs;
    const { root } = lab.view;
    const wrong = [];
    const note = (text) => wrong.length < 20 && wrong.push(text);
    const onError = (event) => note(`exception: ${(event.error ?? event.reason)?.stack ?? event.message}`);
    window.addEventListener("error", onError);
    window.addEventListener("unhandledrejection", onError);
    const pen = CanvasRenderingContext2D.prototype;
    const originals = {};
    for (const name of ["moveTo", "lineTo", "arc", "fillText", "fillRect"]) {
        originals[name] = pen[name];
        pen[name] = function (...values) {
            if (values.some((v) => (typeof v === "number" && !Number.isFinite(v)) || String(v).includes("NaN"))) {
                note(`${name}(${values.join(", ")}) was drawn`);
            }
            return originals[name].apply(this, values);
        };
    }
    let state = seed;
    const random = () => {
        state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
        return state / 2 ** 32;
    };
    const pick = (list) => list[Math.floor(random() * list.length)];
    const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
    const tell = (target, type) => target.dispatchEvent(new Event(type, { bubbles: true }));
    const press = (target, key) => target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    const used = new Set();

    function next() {
        const controls = [...root.querySelectorAll("[data-control]")];
        const usable = (control) => !control.disabled && control.checkVisibility();
        const asked = (name) => !used.has(name) && (!wanted.length || wanted.includes(name));
        const unused = (control) => asked(control.dataset.control) && usable(control);
        let control = (random() < 0.5 && controls.find(unused)) || pick(controls);
        while (!usable(control)) control = pick(controls);  // asking all takes long
        return control;
    }

    function act() {
        const control = next();
        used.add(control.dataset.control);
        if (control.classList.contains("handle")) {
            const keys = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "+", "-", "Delete"];
            if (random() < 0.3) return press(control, pick(keys));
            const box = control.getBoundingClientRect();
            const tellPointer = (type, x, y) => control.dispatchEvent(
                new PointerEvent(type, { pointerId: 3, clientX: box.left + x, clientY: box.top + y, bubbles: true }));
            tellPointer("pointerdown", 14, 14);
            for (let k = 0; k < 3; k++) tellPointer("pointermove", 14 + 60 * (random() - 0.5), 14 + 60 * (random() - 0.5));
            return tellPointer("pointerup", 14, 14);
        }
        if (control.tagName === "SELECT") {
            control.value = pick([...control.options].filter((o) => !o.disabled)).value;
            return tell(control, "change");
        }
        if (control.type === "range") {
            const [low, high] = [Number(control.min), Number(control.max)];
            control.value = String(random() < 0.1 ? pick([low, high]) : low + random() * (high - low));
            tell(control, "input");
            return random() < 0.5 && tell(control, "change");
        }
        if (control.type === "number") {
            control.value = pick(["", "0", "1", "-1", "0.3", "2.5", "1e9", "-0.02", "10"]);
            tell(control, "input");
            return tell(control, "change");
        }
        return control.click();
    }

    const numbers = (values) => Array.from(values).join();
    const views = () => lab.screen.views.filter(({ figure }) => !figure.hidden);
    const pixelsOf = (canvas) => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    const moving = () => lab.screen.clock.playing;
    const atRest = () => lab.settled && lab.shown.whole && lab.resting === null && (!lab.pending || moving());

    /** Whether pictures and words are of the present settings: compared with what is computed and drawn anew. */
    async function compare(when) {
        const began = performance.now();
        for (let k = 0; k < 2; k++) await frame();  // pictures that are shown again are told their sizes
        while (!atRest() && performance.now() - began < 30000) await frame();
        if (!atRest()) return note(`event ${when}: the picture stays stale, of ${JSON.stringify(lab.settings)}`);
        const { Engine } = lab.constructor.computing;
        const fresh = (settings) => settings && new Engine(lab.model).run(settings, lab.kernels.of(settings), true);
        const { settings, theme, state: { view } } = lab;
        const [shown, kept] = [fresh(settings), fresh(settings.kept)];
        if (shown.problem || !shown.time.length) return undefined;
        const ghost = kept && !kept.problem && !kept.refusal ? kept : null;
        for (const [name, { figure }] of Object.entries(lab.screen.charts)) {
            if (figure.hidden === view.charts.includes(name)) note(`event ${when}: chart ${name} is ${figure.hidden ? "hidden" : "shown"}`);
        }
        const scene = { ...lab.screen.scene, shown, ghost, chosen: lab.chosenOf(shown) };
        for (const name of view.charts) {
            const wanted = lab.parts.chartOf(name, scene, lab.span, lab);
            const seen = lab.screen.charts[name].chart;
            wanted?.lines.forEach(({ id, values }, i) => {
                const there = seen?.lines[i];
                if (there?.id !== id || numbers(there.values) !== numbers(values)) note(`event ${when}: "${id}" of ${name} is stale`);
            });
        }
        const [before, pixels] = [lab.shown, views().map(({ canvas }) => pixelsOf(canvas))];
        Object.assign(lab, { shown, ghost });
        if (!moving()) {
            lab.screen.draw(shown, ghost, theme);
            views().forEach(({ canvas }, i) => {
                const drawn = pixelsOf(canvas);
                const off = drawn.length === pixels[i].length && drawn.reduce((sum, value, at) => sum + (value !== pixels[i][at]), 0);
                // Labels may look for another place, which is a small part of a picture.
                if (off === false || off > 0.03 * drawn.length) note(`event ${when}: the picture "${canvas.ariaLabel.slice(0, 40)}" is stale`);
            });
        }
        lab.shown = before;
        return undefined;
    }

    for (let k = 0; k < count; k++) {
        try {
            // Long recordings at short periods only make the test slow.
            const { duration, period, step = period } = lab.settings;
            const finest = Math.min(period, step);
            if (duration / finest > most) lab.change({ duration: Math.max(1, (most / 10) * finest) }, true);
            act();
        } catch (error) {
            note(`exception: ${error.message}`);
        }
        if (random() < 0.01) root.parentElement.style.width = pick(["400px", "640px", ""]);
        if (k % 8 === 0) await frame();
        const text = root.querySelector(".says").textContent + root.querySelector(".drawer").textContent;
        if (/NaN|undefined|null|\[object/.test(text)) note(`text: ${text}`);
        for (const { textContent } of root.querySelectorAll(".problem:not([hidden])")) {
            // That nothing can be seen, as of a point behind the camera, is no fault.
            if (textContent !== lab.shown?.problem) note(`event ${k}: ${textContent}`);
        }
        if (k % 50 === 49 && lab.results) await compare(k);
    }
    // What still moves is stopped, as a hand would.
    lab.screen.clock.pause();
    root.parentElement.style.width = "";
    Object.assign(pen, originals);
    window.removeEventListener("error", onError);
    window.removeEventListener("unhandledrejection", onError);
    return { wrong, used: [...used] };
};
