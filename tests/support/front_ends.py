"""Two labs as each front end shows them in a browser, and a way to end the Python behind them."""

import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass

from jupyter_harness import free_port, is_up, kernel_is_ready, open_notebook, run_all, wait_until
from lab_browser import assert_equals_python, control, drag_by_keys, drag_by_mouse, state, write_notebook
from places import NOTEBOOKS

from percept_obs.labs import observer_lab

OPENED = "observer_lab('ma2005_eq35')", 'observer_lab(outputs=["y1"])'
LABS = f"from percept_obs.labs import observer_lab\n{OPENED[0]}", OPENED[1]
FOE = control("foe")


@dataclass(frozen=True)
class Shown:
    """Labs in a page: the browser's page, how many they are, and what ends Python."""

    page: object
    labs: int
    end_python: Callable[[], object] | None = None

    def settle(self, patience=60):
        """Wait until every lab shows its latest settings and Python, where there is one, has answered."""
        self.page.wait_for_function("(count) => tests.settled(count)", arg=self.labs, timeout=1000 * patience)

    def opening(self):
        """State of the first lab when it is put back, all its topics open."""
        self.settle()
        self.page.evaluate("tests.unfold()")
        self.page.evaluate("tests.reset()")
        self.settle()
        self.page.evaluate("tests.painted()")
        return self.first()

    def first(self):
        """State of the first lab when it has come to rest."""
        self.settle()
        return self.state(0)

    def state(self, place):
        """State of the lab at a place, counted from above: which opens first is the front end's affair."""
        return state(self.page, self.page.evaluate("tests.order()")[place])


# What is tried, by the names of the table.


def _draws(shown):
    shown.settle(patience=120)  # Python begins here
    for which in range(shown.labs):
        assert_equals_python(shown.state(which))
    assert shown.page.locator("[data-percept-obs-error]:visible, .problem:visible, .silence:visible").count() == 0


def _follows_the_mouse(shown):
    before = shown.opening()
    shown.page.locator(FOE).first.scroll_into_view_if_needed()
    drag_by_mouse(shown.page, FOE)
    _has_moved(shown, before)


def _follows_keys(shown):
    before = shown.opening()
    shown.page.locator(FOE).first.scroll_into_view_if_needed()
    drag_by_keys(shown.page, FOE)
    for key in ("d", "d", "x", "b"):  # JupyterLab's own: delete, cut, add
        shown.page.keyboard.press(key)
    assert shown.page.locator(FOE).first.evaluate("(foe) => foe.getRootNode().activeElement === foe")
    _has_moved(shown, before)


def _has_moved(shown, before):
    after = shown.first()
    assert after["settings"]["b"] != before["settings"]["b"]
    assert after["runs"] != before["runs"]
    assert after["drawn"] != before["drawn"]


def _switches(shown):
    shown.opening()
    shown.page.locator(control("outputs")).first.fill("0")
    shown.page.locator(control("observer spica")).first.check()
    after = shown.first()
    assert after["settings"]["outputs"] == ["y1"]
    assert list(after["runs"]) == ["identifier_based", "spica"]
    assert_equals_python(after)


def _are_two(shown):
    before = shown.opening()
    if shown.labs == 1:  # the rule of a saved file
        assert shown.page.locator("[data-percept-obs]").count() == 1
        return
    other = shown.state(1)
    shown.page.locator(control("seed number")).nth(1).fill("9")
    shown.settle()
    assert shown.state(0) == before
    assert shown.state(1)["settings"] == {**other["settings"], "seed": 9}


def _outlives_python(shown):
    shown.opening()
    if shown.end_python:
        shown.end_python()
    shown.page.locator(control("gain")).first.fill("0.6")
    if shown.end_python:
        shown.page.locator(".silence:visible").first.wait_for()
    shown.page.locator(control("outputs")).first.fill("0")
    shown.page.wait_for_function(
        """() => [...window.perceptObsLabs].some(({ shown: { settings, whole }, pending }) => whole &&
            settings.outputs.length === 1 && settings.gains.identifier_based.gain === 3.98 && !pending)"""
    )
    after = shown.state(0)
    assert after["silent"] == bool(shown.end_python)
    assert after["settings"]["gains"]["identifier_based"]["gain"] == 3.98
    assert_equals_python(after)


TRIALS = {
    "load": _draws,
    "drag": _follows_the_mouse,
    "keys": _follows_keys,
    "switch": _switches,
    "two labs": _are_two,
    "kernel gone": _outlives_python,
}


# The front ends.


def in_jupyterlab(page, server):
    """A notebook of JupyterLab, its cells run by the menu."""
    open_notebook(page, _notebook(page, server, "jupyterlab.ipynb"))
    run_all(page)
    return Shown(page, 2, lambda: _end_kernels(page, server))


def in_notebook(page, server):
    """A notebook of Notebook 7, its cells run by the menu."""
    name = _notebook(page, server, "notebook.ipynb")
    page.goto(f"/notebooks/{name}")
    wait_until(lambda: kernel_is_ready(page, name), "the kernel to be ready")
    run_all(page)
    return Shown(page, 2, lambda: _end_kernels(page, server))


def in_voila(page, server):
    """A notebook as Voila's page."""
    page.goto(f"/voila/render/{_notebook(page, server, 'voila.ipynb')}", timeout=120_000)
    return Shown(page, 2, lambda: _end_kernels(page, server))


def _notebook(page, server, name):
    """A notebook with two labs in the folder of a server, which the page is signed in to."""
    write_notebook(server.folder, name, *LABS)
    page.request.get(f"{server.url}/lab?token={server.token}")  # leaves the cookie
    return name


def _end_kernels(page, server):
    cookies = {cookie["name"]: cookie["value"] for cookie in page.context.cookies()}
    headers = {"X-XSRFToken": cookies.get("_xsrf", ""), "Referer": server.url}
    for kernel in page.request.get("/api/kernels").json():
        page.request.delete(f"/api/kernels/{kernel['id']}", headers=headers)


@contextmanager
def marimo(home):
    """A server of the example app for marimo; what it writes stays in a folder."""
    app = home / "marimo_lab.py"
    text = (NOTEBOOKS / "marimo_lab.py").read_text("utf-8")
    for own, opened in zip(("observer_lab()", 'observer_lab(outputs=["y1"])'), OPENED, strict=True):
        assert own in text
        text = text.replace(own, opened)
    app.write_text(text, "utf-8")
    address = f"http://127.0.0.1:{free_port()}"
    command = [sys.executable, "-m", "marimo", "run", "--headless", "--no-token", "--port", address.rpartition(":")[2]]
    places = {f"XDG_{kind}_HOME": str(home / kind) for kind in ("CONFIG", "STATE", "CACHE", "DATA")}
    with (home / "log").open("w") as log:
        process = subprocess.Popen([*command, app], env=os.environ | places, stdout=log, stderr=log, cwd=home)
    try:
        wait_until(lambda: is_up(f"{address}/health", process, home / "log"), "marimo")
        yield address, process
    finally:
        process.terminate()
        process.wait(20)


def in_marimo(page, start):
    """The example app for marimo."""
    address, process = start()
    page.goto(address)
    return Shown(page, 2, process.terminate)


def in_a_saved_file(page, folder):
    """A lab's own page, opened from the disk."""
    observer_lab("ma2005_eq35").save(folder / "lab.html")
    page.goto((folder / "lab.html").as_uri())
    return Shown(page, 1)
