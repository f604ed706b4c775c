"""Notebooks as a student meets them: run in a kernel, moved by every control, and shown by JupyterLab in a browser."""

from __future__ import annotations

import asyncio
import importlib.util
import os
import re
import secrets
import signal
import socket
import subprocess
import sys
import threading
import time
import traceback
import urllib.request
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # it takes two seconds, which every process that collects tests and every kernel would pay
    import nbformat


ERROR_CLASS = "percept-obs-error"
"""DOM class of the message in which a lab shows an error of its own."""


# In the kernel.  `execute` imports this file there and calls the next functions.

SEEN: list[str] = []
"""Errors of this kernel that would otherwise stay unseen."""


def watch() -> None:
    """Make warnings errors, and write down every traceback that widgets or tasks show instead of raising."""
    from IPython import get_ipython

    warnings.simplefilter("error")
    warnings.filterwarnings("ignore", module=r"ipykernel\.")  # it warns of itself while it shuts down
    ip = get_ipython()
    shown = ip.showtraceback

    def showtraceback(*arguments, **options):
        SEEN.append(traceback.format_exc())
        shown(*arguments, **options)

    ip.showtraceback = showtraceback
    threading.excepthook = lambda hook: _write_down(hook.exc_value)
    asyncio.get_running_loop().set_exception_handler(lambda _, context: _write_down(context))


def move_every_control() -> None:
    """Move every control of this kernel to both ends, to every option, and press every button."""
    from ipywidgets.widgets.widget import _instances

    for widget in list(_instances.values()):
        for goal, move in _moves(widget):
            try:
                move()
            except Exception as error:
                _write_down(error)
            SEEN.extend(f"{message}\n  after {_called(widget)} was moved to {goal}" for message in _shown_errors())


def judge() -> None:
    """Raise with everything that was written down."""
    if SEEN:
        raise AssertionError("\n".join(SEEN))


def _moves(widget) -> Iterator[tuple[object, Callable[[], None]]]:
    """Where a control can be moved, and how; nothing for what only displays.  It is put back in the end."""
    import ipywidgets

    displays = ("HTML", "HTMLMath", "Label", "Image", "Audio", "Video", "Valid", "IntProgress", "FloatProgress")
    if isinstance(widget, ipywidgets.Button):
        yield "a click", widget.click
        return
    if not isinstance(widget, ipywidgets.ValueWidget) or type(widget).__name__ in displays:
        return  # layouts, containers, and anywidget labs, whose page has its own test
    trait = "index" if hasattr(widget, "options") else "value"
    first = getattr(widget, trait)
    for goal in [*_goals(widget), first]:
        yield goal, lambda goal=goal: setattr(widget, trait, goal)


def _goals(widget) -> list[object]:
    value = getattr(widget, "value", None)
    if hasattr(widget, "options"):
        several = isinstance(widget.index, tuple)
        return [(k,) if several else k for k in range(len(widget.options))]
    if isinstance(value, bool):
        return [not value]
    if hasattr(widget, "min") and hasattr(widget, "max"):
        low, high = widget.min, widget.max
        return [(low, low), (low, high), (high, high)] if isinstance(value, tuple) else [low, high]
    SEEN.append(f"how is a {type(widget).__name__} moved? Say so in {__name__}._goals")
    return []


def _shown_errors() -> list[str]:
    from ipywidgets.widgets.widget import _instances

    return [message for w in list(_instances.values()) for message in errors_in(w.get_state())]


def errors_in(state: dict) -> list[str]:
    """Errors that a widget shows, read from its state."""
    messages = [
        f"{o['ename']}: {o['evalue']}, in an Output widget"
        for o in state.get("outputs") or ()
        if isinstance(o, dict) and o.get("output_type") == "error"
    ]
    if ERROR_CLASS in (state.get("_dom_classes") or ()) and state.get("value"):
        messages.append(f"the lab says: {state['value']}")
    return messages


def _called(widget) -> str:
    return f"{type(widget).__name__} {getattr(widget, 'description', '')!r}"


def _write_down(what) -> None:
    error = what.get("exception") if isinstance(what, dict) else what
    SEEN.append("".join(traceback.format_exception(error)) if isinstance(error, BaseException) else str(what))


# Around the kernel.

PRELUDE = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
import jupyter_harness, packages
sys.path.pop(0)
jupyter_harness.watch()
packages.hide(%r)
"""
MOVE = "jupyter_harness.move_every_control()"
SETTLE = "import asyncio\nawait asyncio.sleep(0.3)  # what a callback put off happens now"
JUDGE = "jupyter_harness.judge()"


def execute(
    notebook: nbformat.NotebookNode,
    folder: Path,
    beside: Mapping[int, Sequence[str]] = MappingProxyType({}),
    absent: Collection[str] = (),
) -> dict[str, dict]:
    """Run a notebook in a fresh kernel in a folder, move its controls, and return the states of its widgets.

    The outputs are put into the notebook, and figures are drawn as on the site.  Programs `beside` it run after the
    cell of their number.  Modules that are `absent` are there as little as if they were not installed.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        If a cell fails or warns, or a control's callback does.
    """
    from percept_obs.site.kernels import client_of  # only here, for notebooks' kernels import this module, too
    from percept_obs.site.notebooks import PREPARE

    client = client_of(notebook, kernel_name="python3", timeout=120, resources={"metadata": {"path": str(folder)}})
    with client.setup_kernel():
        for program in (PREPARE, PRELUDE % set(absent)):
            _execute_beside(client, program)
        for k, cell in enumerate(notebook.cells):
            client.execute_cell(cell, k)
            for program in beside.get(k, ()):
                _execute_beside(client, program)
        client.set_widgets_metadata()
        for program in (MOVE, SETTLE, JUDGE):
            _execute_beside(client, program)
    return client.widget_state


def _execute_beside(client, program: str) -> None:
    """Run a cell that is not in the notebook."""
    from nbformat.v4 import new_code_cell, new_notebook

    notebook, cell = client.nb, new_code_cell(program)
    client.nb = new_notebook(cells=[cell])
    try:
        client.execute_cell(cell, 0)
    finally:
        client.nb = notebook


def silent_pictures(notebook: dict, widgets: dict[str, dict]) -> list[str]:
    """Pictures of an executed notebook and its widgets that have no alternative text."""
    return [
        *(f"{cell['id']}: {words}" for cell in notebook["cells"] for words in _silent_in_cell(cell)),
        *(f"{state.get('_model_name')}: {words}" for state in widgets.values() for words in _silent_in_widget(state)),
    ]


def _silent_in_cell(cell: dict) -> Iterator[str]:
    if cell["cell_type"] == "markdown":
        yield from ("![] without a text" for _ in re.findall(r"!\[\s*\]\(", cell["source"]))
        yield from _Pictures(cell["source"]).silent
    for output in cell.get("outputs", ()):
        data = output.get("data", {})
        if "text/html" in data:  # what is shown where there is a choice
            yield from _Pictures("".join(data["text/html"])).silent
        else:
            images = (kind for kind in data if kind.startswith("image/"))
            yield from (f"{kind} without alt" for kind in images if not output["metadata"].get(kind, {}).get("alt"))


def _silent_in_widget(state: dict) -> Iterator[str]:
    if state.get("_model_name") == "ImageModel":
        yield "no alternative text; put an <img> into HTML"
    elif isinstance(state.get("value"), str):
        yield from _Pictures(state["value"]).silent


NAMED_BY = {"img": "alt", "svg": "aria-label", "canvas": "aria-label"}


class _Pictures(HTMLParser):
    """The pictures of a page, and which of them have no alternative text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.silent: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        name = NAMED_BY.get(tag)
        if name and not (dict(attributes).get(name) or "").strip():
            self.silent.append(f"<{tag}> without {name}")


# In the browser.

CHROMIUM_OPTIONS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
)

SETTINGS = {
    "apputils-extension/notification": '{"fetchNews": "false"}',  # its popup covers a corner
    "notebook-extension/tracker": '{"windowingMode": "none"}',  # cells out of sight are in the page too
}


@dataclass(frozen=True)
class Server:
    """A running JupyterLab."""

    url: str
    token: str
    folder: Path


@contextmanager
def jupyterlab(folder: Path, home: Path) -> Iterator[Server]:
    """JupyterLab on a folder, with everything else that it writes kept in an empty folder `home`."""
    if importlib.util.find_spec("jupyterlab") is None:
        from needs import missing  # only here, for notebooks' kernels import this module, too

        missing("jupyterlab", 'JupyterLab is missing; get it with: python -m pip install "percept-obs[course]".')
    for name, text in SETTINGS.items():
        file = home / f"settings/@jupyterlab/{name}.jupyterlab-settings"
        file.parent.mkdir(parents=True)
        file.write_text(text)
    places = {
        "JUPYTER_CONFIG_DIR": "config",
        "JUPYTER_DATA_DIR": "data",
        "JUPYTER_RUNTIME_DIR": "runtime",
        "JUPYTERLAB_SETTINGS_DIR": "settings",
        "JUPYTERLAB_WORKSPACES_DIR": "workspaces",
    }
    server = Server(f"http://127.0.0.1:{free_port()}", secrets.token_hex(16), folder)
    command = [
        *(sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--expose-app-in-browser"),
        f"--ServerApp.port={server.url.rpartition(':')[2]}",
        "--ServerApp.port_retries=0",
        f"--IdentityProvider.token={server.token}",
        f"--ServerApp.root_dir={folder}",
    ]
    environment = os.environ | {name: str(home / place) for name, place in places.items()}
    log = home / "server.log"
    with log.open("w") as file:
        process = subprocess.Popen(command, env=environment, stdout=file, stderr=file)
    try:
        address = f"{server.url}/api/status?token={server.token}"
        wait_until(lambda: is_up(address, process, log), "JupyterLab")
        yield server
    finally:
        process.send_signal(signal.SIGTERM)  # it ends its kernels first
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


@contextmanager
def lab_page(chromium: str, server: Server, home: Path, width: int = 1280, height: int = 900):
    """A page of a headless browser that is signed in to a server; playwright's, with the server as its base."""
    import browsers  # only here, for notebooks' kernels import this module, too

    with browsers.playwright() as playwright:
        browser = playwright.chromium.launch_persistent_context(
            home,
            executable_path=chromium,
            headless=True,
            args=list(CHROMIUM_OPTIONS),
            base_url=server.url,
            viewport={"width": width, "height": height},
        )
        browser.add_init_script(browsers.SCRIPTS)
        try:
            page = browser.pages[0]
            page.request.get(f"/lab?token={server.token}")  # leaves the cookie that signs in
            yield page
        finally:
            browser.close()


def open_notebook(page, name: str) -> None:
    """Show a notebook of the server's folder alone and wait for its kernel.

    JupyterLab begins anew: to close other notebooks it might ask whether to save, and wait for ever.
    """
    page.goto("about:blank")
    page.goto(f"/lab/tree/{name}?reset")
    page.wait_for_selector(IDLE, timeout=60_000)
    # The page says idle too while it knows no kernel yet, and would ask for one; so ask the server.
    wait_until(lambda: kernel_is_ready(page, name), "the kernel to be ready")


def kernel_is_ready(page, name: str) -> bool:
    """Return True if the kernel of a notebook of the server waits for code."""
    kernels = [s["kernel"] for s in page.request.get("/api/sessions").json() if s["path"] == name]
    return any(kernel["connections"] and kernel["execution_state"] == "idle" for kernel in kernels)


def run_all(page, patience: float = 60) -> None:
    """Run all cells and wait until the last one has run.

    Raises
    ------
    AssertionError
        If a cell fails or warns.
    """
    page.click(".lm-MenuBar-item:has-text('Run')")
    page.click(".lm-Menu-item[data-command='runmenu:run-all']")
    wait_until(lambda: complaints(page) or page.evaluate("tests.allRan()"), "all cells to run", patience)
    assert not complaints(page), "\n".join(complaints(page))
    page.wait_for_selector(IDLE, timeout=1000 * patience)


def complaints(page) -> list[str]:
    """Errors and warnings in the notebook's outputs."""
    return page.locator(".jp-OutputArea-output[data-mime-type$=stderr]").all_inner_texts()


def log_entries(page) -> str:
    """Text of JupyterLab's log console, where errors in callbacks go; empty without entries."""
    return page.evaluate("tests.log()") or ""


IDLE = ".jp-Notebook-ExecutionIndicator[data-status=idle]"


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return probe.getsockname()[1]


def wait_until(holds: Callable[[], object], what: str, patience: float = 60) -> None:
    """Wait until something holds.

    Raises
    ------
    TimeoutError
        If it does not within so many seconds.
    """
    end = time.monotonic() + patience
    while not holds():
        if time.monotonic() > end:
            raise TimeoutError(f"waited {patience:g} s for {what}")
        time.sleep(0.05)


def is_up(address: str, process: subprocess.Popen, log: Path) -> bool:
    """Return True if a server answers at an address."""
    if process.poll() is not None:
        raise RuntimeError(f"it did not start:\n{log.read_text('utf-8')}")
    try:
        with urllib.request.urlopen(address, timeout=5):
            return True
    except OSError:
        return False
