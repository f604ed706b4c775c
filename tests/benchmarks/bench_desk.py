"""From a key at the desk to its feedback in JupyterLab, kernel idle.

    PYTHONPATH=tests/support python tests/benchmarks/bench_desk.py

A line is typed letter by letter.  The time runs from the key's event to the moment at which the frame has been handed
to the screen that shows, of the text with this letter, the formula as mathematics and what Python found of it.  What is
not right is put into words only after a pause, on purpose; the mark of a right line comes with the feedback.
"""

import statistics

from bench_lab import in_jupyterlab, rested
from lab_browser import open_lab

WATCH = """() => {
    const [lab] = window.perceptObsLabs;
    window.latencies = [];
    const waiting = [];
    lab.view.root.addEventListener("input", (event) => waiting.push(event.timeStamp), true);
    const paint = lab.paint.bind(lab);
    const handed = new MessageChannel();
    const done = [];
    handed.port1.onmessage = () => {
        const now = performance.now();
        for (const began of done.splice(0)) window.latencies.push(now - began);
    };
    lab.paint = () => {
        paint();
        if (lab.answer.settings !== lab.settings) return;
        done.push(...waiting.splice(0));
        requestAnimationFrame(() => handed.port2.postMessage(0));
    };
}"""

RIGHT = "a13 + (a11 - a33) y1 + a12 y2 - a31 y1^2 - a32 y1 y2 + b1 y3 - b3 y1 y3"
LONG = "-y3 (2 y1 (a11 y1 + a12 y2) / (1 + y1^2 + y2^2) + b3 y3 (1 - y1^2 - y2^2))"
EARLIER = "a21 y1 + a22 y2 + a23 - y2 (a31 y1 + a32 y2 + a33 - b3 y3) + b2 y3"
CASES = {
    "pinhole, a line that becomes right": ("step=6", "y1'", RIGHT),
    "pinhole, beside a wrong line": (f'step=6, typed={{"rate 6 y2\'": {EARLIER!r}}}', "y1'", RIGHT),
    "pinhole, beside a wrong line, one hint open": (
        f"step=6, typed={{\"rate 6 y2'\": {EARLIER!r}}}, hints={{'rate 6': 1}}",
        "y1'",
        RIGHT,
    ),
    "sphere, a line that stays wrong": ("step=6, surface='sphere'", "y3'", LONG),
}


def main(delays=(200, 100)):
    """Type each line at two paces, in milliseconds a letter, and report."""
    with in_jupyterlab() as (page, folder):
        for title, (arguments, name, text) in CASES.items():
            for delay in delays:
                open_lab(page, folder, "bench.ipynb", arguments, "derivation_desk")
                page.evaluate(WATCH)
                page.locator(f'[data-control="line rate 6 {name}"]').press_sequentially(text, delay=delay)
                rested(page)
                found = sorted(page.evaluate("window.latencies"))
                assert len(found) == len(text)
                middle, worst = statistics.median(found), found[int(0.95 * len(found))]
                print(f"{title:46} a letter each {delay} ms: key to feedback {middle:5.1f} ms, 95 % {worst:5.1f} ms")


if __name__ == "__main__":
    main()
