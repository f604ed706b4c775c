// Random events over every control of a lab, the same for the same seed; what went wrong and what was used is returned.
// Some of the events go to a control that was not used yet, so that all have their turn.
async ([seed, count, most = 20000]) => {
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
        const unused = (control) => !used.has(control.dataset.control) && usable(control);
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
        const text = root.querySelector(".words").textContent + root.querySelector(".reading").textContent;
        if (/NaN|undefined|null|\[object/.test(text)) note(`text: ${text}`);
        for (const problem of root.querySelectorAll(".problem:not([hidden])")) note(problem.textContent);
    }
    // What still moves is stopped, as a hand would.
    if (lab.view.playing()) root.querySelector('[data-control="play"]').click();
    root.querySelector('[data-control="swing"][aria-pressed="true"]')?.click();
    root.parentElement.style.width = "";
    Object.assign(pen, originals);
    window.removeEventListener("error", onError);
    window.removeEventListener("unhandledrejection", onError);
    return { wrong, used: [...used] };
}
