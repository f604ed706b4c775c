// Drags a handle of a lab for some seconds, an event a frame, or one only when the one before it has been drawn; what was
// drawn of it, and how long each event waited.
([seconds, control, patient]) => new Promise((resolve) => {
    const [lab] = window.perceptObsLabs;
    const handle = document.querySelector(`[data-control="${control}"]`);
    const box = handle.getBoundingClientRect();
    const [x, y] = [box.left + box.width / 2, box.top + box.height / 2];
    const tell = (type, k) => handle.dispatchEvent(new PointerEvent(type, {
        pointerId: 7, clientX: x + 20 * Math.sin(k / 9), clientY: y + 16 * Math.cos(k / 9), bubbles: true,
    }));
    const latencies = [];
    const waiting = [];
    let [pictures, before, samples] = [0, null, Infinity];
    const paint = lab.paint.bind(lab);
    lab.paint = () => {
        paint();
        const { shown } = lab;
        if (shown.settings === before) return;
        before = shown.settings;
        pictures += 1;
        samples = Math.min(samples, shown.time.length);
        // A picture answers the event that led to its settings, and those before it that got none of their own.
        const answered = waiting.splice(0, 1 + waiting.findLastIndex(({ settings }) => settings === before));
        const channel = new MessageChannel();
        // Runs after the frame in which it was posted.
        channel.port1.onmessage = () => {
            latencies.push(...answered.map(({ at }) => performance.now() - at));
            if (patient && !waiting.length) after.port2.postMessage(0);
        };
        channel.port2.postMessage(0);
    };
    let k = 0;
    tell("pointerdown", 0);
    const began = performance.now();
    const finish = () => {
        const took = (performance.now() - began) / 1000;
        delete lab.paint;
        const { runs = [] } = lab.shown;
        const resets = runs.reduce((sum, run) => sum + run.resets.length, 0);
        const lines = !lab.screen ? [] : [lab.screen.chart, ...lab.state.view.charts.map((name) => lab.screen.charts[name])]
            .map(({ chart }) => chart.lines.length);
        tell("pointerup", k);
        resolve({ pictures, took, latencies, samples, resets, lines });
    };
    // One event a frame, once the frame has been handed over: as a mouse's, which a browser aligns with its frames.
    const after = new MessageChannel();
    after.port1.onmessage = () => {
        if (performance.now() - began > 1000 * seconds) return finish();
        const at = performance.now();
        const { settings } = lab;
        tell("pointermove", ++k);
        // A place that is impossible changes nothing.
        if (lab.settings !== settings) waiting.push({ at, settings: lab.settings });
        if (!patient || !waiting.length) requestAnimationFrame(() => after.port2.postMessage(0));
    };
    after.port2.postMessage(0);
})
