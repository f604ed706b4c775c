"""How fast the labs open, and draw while the hand drags, in JupyterLab: python tests/benchmarks/bench_lab.py.

With ``--opening`` it only measures that: from the key that runs a cell to the first picture, and to the answer to the
first switch, which asks for texts that nothing has needed before.

Pointer events are made in the page, one a frame, since a driver's own moves wait for the page.  A picture counts when
the frame that holds it has been handed to the screen; its latency runs from the event to that moment.
"""

import json
import shutil
import statistics
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from jupyter_harness import IDLE, jupyterlab, lab_page, open_notebook
from lab_browser import OPEN, rested, write_notebook

from percept_obs.labs.observer.texts import BY_NAME

SECONDS = 5
BUSY = f"import time\nend = time.monotonic() + {SECONDS + 1}\nwhile time.monotonic() < end:\n    pass"

DRAG = """([seconds, control]) => new Promise((resolve) => {
    const [lab] = window.perceptObsLabs;
    const handle = document.querySelector(`[data-control="${control}"]`);
    const box = handle.getBoundingClientRect();
    const [x, y] = [box.left + box.width / 2, box.top + box.height / 2];
    const tell = (type, k) => handle.dispatchEvent(new PointerEvent(type, {
        pointerId: 7, clientX: x + 20 * Math.sin(k / 9), clientY: y + 16 * Math.cos(k / 9), bubbles: true,
    }));
    const latencies = [];
    let pictures = 0;
    let before = "";
    const waiting = [];
    const draw = lab.draw.bind(lab);
    lab.draw = () => {
        draw();
        const { estimate } = lab.shown.runs?.[0] ?? lab.shown;
        const key = [0.1, 0.3, 0.5, 0.9].map((part) => estimate[Math.floor(part * estimate.length)]).join();
        if (key !== before) pictures += 1;
        before = key;
        const answered = waiting.splice(0);
        const channel = new MessageChannel();
        // Runs after the frame in which it was posted.
        channel.port1.onmessage = () => latencies.push(...answered.map((event) => performance.now() - event));
        channel.port2.postMessage(0);
    };
    let k = 0;
    tell("pointerdown", 0);
    const began = performance.now();
    const finish = () => {
        tell("pointerup", k);
        delete lab.draw;
        const lines = Object.values(lab.drawn).map((chart) => chart.lines.map((line) => line.values.length));
        resolve({ rate: pictures / seconds, latencies, lines });
    };
    // One event a frame, once the frame has been handed over: as a mouse's, which a browser aligns with its frames.
    const after = new MessageChannel();
    after.port1.onmessage = () => {
        if (performance.now() - began > 1000 * seconds) return finish();
        waiting.push(performance.now());
        tell("pointermove", ++k);
        requestAnimationFrame(() => after.port2.postMessage(0));
    };
    after.port2.postMessage(0);
})"""

OPENING = """() => {
    const began = performance.now();
    window.opening = {};
    const look = () => {
        const [lab] = window.perceptObsLabs ?? [];
        if (lab?.pictures) window.opening.picture ??= (performance.now() - began) / 1000;
        if (lab?.pictures && !window.opening.asked) {
            window.opening.asked = lab.pictures;
            lab.change({ ...lab.settings, ...SWITCH }, true);
        }
        const answered = lab?.shown?.settings === lab?.settings && lab?.pictures > window.opening.asked;
        if (answered) window.opening.whole = (performance.now() - began) / 1000;
        else requestAnimationFrame(look);
    };
    look();
}"""

SWITCH = {
    "observer_lab": {"surface": "plane", "outputs": ["y1"], "observers": ["extended_kalman", "linear_approximation"]},
    "structure_lab": {"unknown": ["v_p1", "v_p2"], "observers": ["extended_kalman", "layer"]},
    "points_lab": {"state": "origin", "weight": "riccati"},
}
"""What is switched to first in each lab."""

THREE = "pictures=['inverse', 'distance', 'error']"
TWO = "['identifier_based', 'sliding_mode']"
ALL = "['identifier_based', 'sliding_mode', 'extended_kalman']"
CASES = {
    "three charts of two and three lines": f"{THREE}, kept=observer_lab().settings",
    "three charts of five and six lines": f"{THREE}, observers={ALL}, kept=observer_lab(observers={TWO}).settings",
}
STRUCTURE = {
    "opening, 3000 steps": "",
    "seven lines, a kept run": "observers=['ideal', 'layer', 'extended_kalman'], kept=structure_lab().settings",
    "velocities that vary, corollary 5": (
        "unknown=['v_p1', 'v_p2', 'v_p3'], v_c_swing=[0.3, 0.3, -0.1], v_p_swing=[0.2, 0.2, 0.1]"
    ),
}
EIGHT = "points=[[0.2 * k - 0.7, 1.2 - 0.1 * k, 2.5 + 0.1 * k] for k in range(8)]"
RICCATI = "weight='riccati', size=0.01"
POINTS = {
    "three points, three charts": "",
    "three points, Riccati, a kept run, four charts": (
        f"{RICCATI}, pictures=['error', 'depth', 'points', 'gramian'], kept=points_lab().settings"
    ),
    "eight points, 24 states": EIGHT,
    "eight points, 24 states, Riccati": f"{EIGHT}, {RICCATI}",
}
ALONE = {name: f"{THREE}, observers=['{name}']" for name in BY_NAME}


def report(title, found):
    """One line of figures."""
    latencies = sorted(found["latencies"])
    worst = latencies[int(0.95 * len(latencies))]
    lines = "+".join(str(len(chart)) for chart in found["lines"])
    print(
        f"{title:52} {found['rate']:5.1f} pictures/s, event to picture {statistics.median(latencies):5.1f} ms, "
        f"95 % {worst:5.1f} ms; lines {lines}"
    )


def opened(page, folder, arguments, lab="observer_lab", handle="foe"):
    """Open a lab in a notebook with a busy cell, and leave it at rest after a short drag of a handle."""
    imports, _, cell = OPEN.replace("observer_lab", lab).format(arguments=arguments).partition("lab = ")
    write_notebook(folder, "bench.ipynb", imports, f"lab = {cell}", "ready = True", BUSY)
    open_notebook(page, "bench.ipynb")
    page.locator(".jp-Cell").first.click()
    page.keyboard.press("Shift+Enter")
    page.wait_for_function("/[0-9]/.test(document.querySelector('.jp-InputPrompt').textContent)", timeout=120_000)
    page.wait_for_selector(IDLE)
    page.evaluate(OPENING.replace("SWITCH", json.dumps(SWITCH[lab])))
    page.keyboard.press("Shift+Enter")
    page.wait_for_function("window.opening.whole", timeout=120_000)
    page.evaluate("() => { const [lab] = window.perceptObsLabs; lab.reset(); }")
    rested(page, 60)
    drag(page, handle, 1)


def drag(page, handle="foe", seconds=SECONDS):
    """Drag a handle for some seconds; the pictures drawn, and how long each event waited for its own."""
    page.locator(f"[data-control='{handle}']").scroll_into_view_if_needed()
    return page.evaluate(DRAG, [seconds, handle])


def measure_opening(page, folder):
    """Say how long each lab takes to open."""
    for lab, handle in (("observer_lab", "foe"), ("structure_lab", "ybar"), ("points_lab", "point 1")):
        opened(page, folder, "", lab, handle)
        times = page.evaluate("window.opening")
        print(
            f"{lab}: first picture {times['picture']:.2f} s after its cell was run, first switch answered after "
            f"{times['whole']:.2f} s"
        )


def main(only_opening=False):
    """Measure the opening; then, unless that is all, drags with an idle and a busy kernel, and every observer alone."""
    places = [Path(tempfile.mkdtemp()) for _ in range(3)]
    try:
        with jupyterlab(*places[:2]) as server, lab_page(shutil.which("chromium"), server, places[2]) as page:
            measure_opening(page, places[0])
            for title, arguments in ({} if only_opening else CASES).items():
                opened(page, places[0], arguments)
                report(f"{title}, kernel idle", drag(page))
                rested(page)
                page.locator(".jp-Cell").nth(3).locator(".cm-content").click()
                page.keyboard.press("Shift+Enter")
                report(f"{title}, kernel busy", drag(page))
            for title, arguments in ({} if only_opening else STRUCTURE).items():
                opened(page, places[0], arguments, "structure_lab", "ybar")
                report(f"structure and motion: {title}", drag(page, "ybar"))
            for title, arguments in ({} if only_opening else POINTS).items():
                opened(page, places[0], arguments, "points_lab", "point 1")
                report(f"many points: {title}", drag(page, "point 1"))
            for name, arguments in ({} if only_opening else ALONE).items():
                opened(page, places[0], arguments)
                report(f"{name}, three charts, kernel idle", drag(page))
    finally:
        for place in places:
            shutil.rmtree(place, ignore_errors=True)


if __name__ == "__main__":
    main("--opening" in sys.argv)
