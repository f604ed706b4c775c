// What a page can do that draws six lines of 8,000 samples in three canvases, a picture an event, and nothing else.
const [LINES, SAMPLES, WIDTH, HEIGHT] = [6, 8000, 780, 170];
const pens = [0, 1, 2].map(() => {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [WIDTH, HEIGHT];
    document.body.append(canvas);
    return canvas.getContext("2d");
});
const handle = document.createElement("div");
handle.dataset.control = "reference";
handle.textContent = "reference";
document.body.prepend(handle);
const lines = Array.from({ length: LINES }, (_, n) => Float64Array.from({ length: SAMPLES }, (_, k) => Math.sin(k / 400 + n) / (1 + k / 2000)));
class Reference {
    settings = { shift: 0 };
    shown = { settings: null, time: lines[0] };
    pending = false;

    paint() {
        const { settings } = this;
        this.shown = { settings, time: lines[0] };
        pens.forEach((pen) => pen.clearRect(0, 0, WIDTH, HEIGHT));
        lines.forEach((values, n) => {
            const pen = pens[n % pens.length];
            pen.beginPath();
            for (let k = 0; k < SAMPLES; k++) pen.lineTo((k * WIDTH) / SAMPLES, HEIGHT * (0.5 + 0.4 * values[k]) + settings.shift);
            pen.stroke();
        });
    }
}
const lab = new Reference();
handle.addEventListener("pointermove", (event) => {
    lab.settings = { shift: event.clientX / 20 };
    if (!lab.pending) requestAnimationFrame(() => {
        lab.pending = false;
        lab.paint();
    });
    lab.pending = true;
});
window.perceptObsLabs = new Set([lab]);
