"""Speed of labs that draw while the hand drags, and that open, in JupyterLab.

    PYTHONPATH=tests/support python tests/benchmarks/bench_lab.py [--alone | --opening] [part of a name]

With the part of a name only the configurations that hold it are measured, with ``--alone`` in a page without
JupyterLab, and with ``--opening`` only how long a lab takes to open: from the key that runs a cell to the first
picture, and to the answer to the first switch, which asks for texts that nothing has needed before.

A configuration is dragged five times, and medians are told.  Before each drag the lab is put back to what it opened
with and shows all of its time, so that each drag begins where the one before it did, and where it is dear.
Pointer events are made in the page, one a frame, since a driver's own moves wait for the page.  A picture counts when
the frame that holds it has been handed to the screen; its latency runs from the event to that moment.  Between the
drags a page that draws six lines of 8,000 samples and nothing else is dragged in the same way: the ratio to it tells
of the lab, as far as the machine has time for both.  Milliseconds of a picture are those for which the page's main
thread computed, while a shorter drag waits for each picture before its next event: they do not depend on the load.
"""

import json
import os
import shutil
import statistics
import sys
import tempfile
from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import lab_alone
from browsers import knowing
from jupyter_harness import CHROMIUM_OPTIONS, IDLE, jupyterlab, lab_page, open_notebook
from lab_browser import OPEN, rested, write_notebook
from needs import found_chromium

from percept_obs import labs
from percept_obs.labs.observer.texts import BY_NAME
from percept_obs.labs.points.texts import MOST_POINTS

ROUNDS, SECONDS, SHORTER = 5, 3, 1.5
SOON = 34
"""Milliseconds in which nearly every picture is to follow its event."""

BUSY = f"import time\nend = time.monotonic() + {SECONDS + 1}\nwhile time.monotonic() < end:\n    pass"
DRAG = Path(__file__).with_name("lab_drag.js").read_text("utf-8")
REFERENCE = Path(__file__).with_name("reference.js").read_text("utf-8")
RESET = "() => [...window.perceptObsLabs][0].reset()"
ALL_OF_ITS_TIME = """() => {
    const [lab] = window.perceptObsLabs;
    lab.showAll();
    lab.screen.clock.begun = true;
    lab.screen.clock.finish();  // where the camera has come far enough to be a handle
}"""

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

HANDLES = {"observer_lab": "foe", "structure_lab": "camera", "points_lab": "mark 1"}
"""Handle that is dragged in each lab; each of its moves makes a new run."""

SWITCH = {
    "observer_lab": {"surface": "plane", "outputs": ["y1"], "observers": ["extended_kalman", "linear_approximation"]},
    "structure_lab": {"unknown": ["v_p1", "v_p2"], "observers": ["extended_kalman", "layer"]},
    "points_lab": {"state": "origin", "weight": "riccati"},
}
"""First switch in each lab."""


class Case(NamedTuple):
    """A lab, and what it opens with."""

    lab: str
    settings: dict[str, Any]
    scenario: str = ""

    def opened(self) -> Any:
        """The lab, opened by Python."""
        return getattr(labs, self.lab)(*filter(None, [self.scenario]), **self.settings)

    @property
    def handle(self) -> str:
        """Handle that is dragged."""
        return HANDLES[self.lab]


TWO = ["identifier_based", "sliding_mode"]
THREE = [*TWO, "extended_kalman"]
OPEN_DRAWER = {"more": "observers", "charts": ["error", "inverse"]}
"""The drawer, and two charts below the first."""
CHARTS = {"charts": ["error", "inverse"]}
NOISY = {"outputs": ["y1"], "noise": {"kind": "uniform", "size": 0.05}}
RICCATI = {"weight": "riccati", "size": 0.01}


def _places(count: int) -> dict[str, Any]:
    return {"points": [[0.15 * k - 0.7, 1.2 - 0.1 * k, 2.5 + 0.1 * k] for k in range(count)]}


OBSERVER = {
    "three observers, drawer, two charts": Case(
        "observer_lab", {**OPEN_DRAWER, "observers": THREE, "duration": 4.0}, "drive"
    ),
    "the same on 80 s of (35)": Case("observer_lab", {**OPEN_DRAWER, "observers": THREE}, "ma2005_eq35"),
    "thousands of resets": Case("observer_lab", {**CHARTS, **NOISY, "observers": TWO}, "ma2005_eq35"),
    **{f"{name} alone, two charts": Case("observer_lab", {**CHARTS, "observers": [name]}) for name in BY_NAME},
}
STRUCTURE = {
    "seven lines, a kept run": {"observers": ["ideal", "layer", "extended_kalman"], "kept": {}},
    "velocities that vary, corollary 5": {
        "unknown": ["v_p1", "v_p2", "v_p3"],
        "v_c_swing": [0.3, 0.3, -0.1],
        "v_p_swing": [0.2, 0.2, 0.1],
    },
}
POINTS = {
    "three, Riccati, a kept run, four charts": {
        **RICCATI,
        "charts": ["error", "depth", "points", "gramian"],
        "kept": {},
    },
    "eight, 24 states": _places(8),
    "eight, 24 states, Riccati": {**_places(8), **RICCATI},
    f"{MOST_POINTS}, {3 * MOST_POINTS} states, Riccati": {**_places(MOST_POINTS), **RICCATI},
}
CASES = {
    **{f"opening, {lab}": Case(lab, {}) for lab in HANDLES},
    **OBSERVER,
    **{f"structure, {name}": Case("structure_lab", settings) for name, settings in STRUCTURE.items()},
    **{f"points, {name}": Case("points_lab", settings) for name, settings in POINTS.items()},
}
BESIDE_A_BUSY_KERNEL = [name for name in CASES if name.startswith("three observers")]


def drag(page: Any, handle: str, seconds: float) -> dict[str, Any]:
    """Drag a handle for some seconds; the pictures a second, and how long they were waited for."""
    page.bring_to_front()
    page.locator(f"[data-control='{handle}']").scroll_into_view_if_needed()
    found = page.evaluate(DRAG, [seconds, handle, False])
    latencies = sorted(found["latencies"])
    return {
        "rate": found["pictures"] / found["took"],
        "median": statistics.median(latencies),
        "soon": 100 * sum(latency <= SOON for latency in latencies) / len(latencies),
        **{name: found[name] for name in ("samples", "resets", "lines")},
    }


def drag_patiently(page: Any, handle: str, seconds: float) -> dict[str, Any]:
    """Drag a handle, each event after the picture of the last one; milliseconds of the main thread a picture."""
    page.bring_to_front()
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    before = spent(session)
    pictures = max(1, page.evaluate(DRAG, [seconds, handle, True])["pictures"])
    after = spent(session)
    session.detach()
    return {
        name: 1000 * (after[metric] - before[metric]) / pictures
        for name, metric in (("task", "TaskDuration"), ("script", "ScriptDuration"))
    }


def spent(session: Any) -> dict[str, float]:
    """Times that a page has computed so far, in seconds."""
    return {m["name"]: m["value"] for m in session.send("Performance.getMetrics")["metrics"]}


def put_back(page: Any) -> None:
    """Let a lab show what it opened with, over all of its time."""
    # The part of the time that is shown belongs to what is shown: one that is chosen before it is there is lost.
    for step in (RESET, ALL_OF_ITS_TIME):
        rested(page, 60)
        page.evaluate(step)
    rested(page, 60)


def measure(title: str, page: Any, reference: Any, handle: str, prepare: Callable[[], object] = lambda: None) -> None:
    """Drag a lab five times and the reference page in between, and say what was found in a line."""
    drags, references = [], []
    for _ in range(ROUNDS):
        patient = drag_patiently(reference, "reference", SHORTER)
        references.append(drag(reference, "reference", SHORTER) | patient)
        page.bring_to_front()
        put_back(page)
        patient = drag_patiently(page, handle, SHORTER)
        put_back(page)
        prepare()
        drags.append(drag(page, handle, SECONDS) | patient)
        rested(page, 60)
    found = {name: statistics.median(one[name] for one in drags) for name in drags[0] if name != "lines"}
    usual = {name: statistics.median(one[name] for one in references) for name in ("rate", "task")}
    lines = "+".join(map(str, drags[0]["lines"]))
    print(
        f"{title:52} {found['rate']:5.1f} pictures/s, {found['rate'] / usual['rate']:4.2f} of the reference's "
        f"{usual['rate']:4.1f}; main thread {found['task']:5.1f} ms (script {found['script']:5.1f}, reference "
        f"{usual['task']:4.1f}); event to picture {found['median']:5.1f} ms, {found['soon']:5.1f} % within {SOON}; "
        f"lines {lines}, samples {found['samples']:.0f}, resets {found['resets']:.0f}; load {os.getloadavg()[0]:.1f}",
        flush=True,
    )


@contextmanager
def reference_page(context: Any) -> Any:
    """The page that draws six lines and nothing else."""
    page = context.new_page()
    page.set_content("<!doctype html><body>")
    page.add_script_tag(content=REFERENCE)
    yield page
    page.close()


def open_in_jupyterlab(page: Any, folder: Path, case: Case) -> None:
    """Open a lab in a notebook with a busy cell, and leave it at rest."""
    scenario = f"{case.scenario!r}, " if case.scenario else ""
    arguments = f"{scenario}**json.loads({json.dumps(case.settings)!r})"
    opening = OPEN.replace("observer_lab", case.lab)
    imports, _, cell = opening.format(arguments=arguments).partition("lab = ")
    write_notebook(folder, "bench.ipynb", imports, f"lab = {cell}", "ready = True", BUSY)
    page.bring_to_front()
    page.goto("about:blank")  # so that JupyterLab opens anew
    open_notebook(page, "bench.ipynb")
    page.locator(".jp-Cell").first.click()
    page.keyboard.press("Shift+Enter")
    page.wait_for_function("/[0-9]/.test(document.querySelector('.jp-InputPrompt').textContent)", timeout=120_000)
    page.wait_for_selector(IDLE)
    page.evaluate(OPENING.replace("SWITCH", json.dumps(SWITCH[case.lab])))
    page.keyboard.press("Shift+Enter")
    page.wait_for_function("window.opening.whole", timeout=120_000)
    put_back(page)
    drag(page, case.handle, 1)


def run_busy_cell(page: Any) -> None:
    """Keep the kernel busy for as long as a drag takes."""
    page.locator(".jp-Cell").nth(3).locator(".cm-content").click()
    page.keyboard.press("Shift+Enter")


def measure_opening(page: Any, folder: Path) -> None:
    """Say how long each lab takes to open."""
    for lab in HANDLES:
        open_in_jupyterlab(page, folder, Case(lab, {}))
        times = page.evaluate("window.opening")
        print(
            f"{lab}: first picture {times['picture']:.2f} s after its cell was run, first switch answered after "
            f"{times['whole']:.2f} s"
        )


@contextmanager
def in_jupyterlab() -> Any:
    """A page of a JupyterLab of its own, and the folder of its notebooks."""
    places = [Path(tempfile.mkdtemp()) for _ in range(3)]
    try:
        with jupyterlab(*places[:2]) as server, lab_page(found_chromium(), server, places[2]) as page:
            yield page, places[0]
    finally:
        for place in places:
            shutil.rmtree(place, ignore_errors=True)


def measure_in_jupyterlab(wanted: dict[str, Case], opening: bool) -> None:
    """Measure configurations with an idle kernel, and some with a busy one."""
    with in_jupyterlab() as (page, folder):
        if opening:
            measure_opening(page, folder)
        with reference_page(page.context) as reference:
            for title, case in wanted.items():
                open_in_jupyterlab(page, folder, case)
                handle = case.handle
                measure(title, page, reference, handle)
                if title in BESIDE_A_BUSY_KERNEL:
                    measure(f"{title}, kernel busy", page, reference, handle, lambda: run_busy_cell(page))


def open_alone(browser: Any, lab: Any) -> Any:
    """A lab at rest in a page without JupyterLab, and without Python but for an answer."""
    options = {"reduced_motion": "no-preference", "viewport": {"width": 1280, "height": 900}}
    page = lab_alone.opened(browser, lab, answers=lambda told: {"analysis": {**told["summary"]}}, **options)
    page.wait_for_function(lab_alone.DRAWN)
    rested(page, 60)
    return page


@contextmanager
def launched() -> Any:
    """A browser that pages without JupyterLab are opened in."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found_chromium(), args=list(CHROMIUM_OPTIONS))
        yield knowing(browser)
        browser.close()


def measure_alone(wanted: dict[str, Case]) -> None:
    """Measure configurations in pages without JupyterLab, which open at once."""
    with launched() as browser, reference_page(browser) as reference:
        for title, case in wanted.items():
            page = open_alone(browser, case.opened())
            measure(title, page, reference, case.handle)
            page.close()


def main(*arguments: str) -> None:
    """Measure what the arguments ask for."""
    names = [argument for argument in arguments if not argument.startswith("--")]
    wanted = {title: case for title, case in CASES.items() if all(name in title for name in names)}
    if not wanted:
        raise SystemExit(f"nothing is called {' '.join(names)!r}; there are:\n" + "\n".join(CASES))
    if "--alone" in arguments:
        measure_alone(wanted)
    elif "--opening" in arguments:
        measure_in_jupyterlab({}, opening=True)
    else:
        measure_in_jupyterlab(wanted, opening=not names)


if __name__ == "__main__":
    main(*sys.argv[1:])
