"""Notebooks as pages: run, their figures drawn for light and dark, their labs alive without Python."""

from __future__ import annotations

import io
import json
import re
from base64 import b64decode
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from copy import deepcopy
from functools import reduce
from html import escape
from operator import getitem
from typing import TYPE_CHECKING, Any

from percept_obs.checking import Review
from percept_obs.figures.base import Figure
from percept_obs.labs.shared.saved import ENDED, SHOWN, place_of
from percept_obs.site.exercises import SHEET, sheet_of
from percept_obs.site.extension import displayed

if TYPE_CHECKING:
    import nbformat

VIEW = "application/vnd.jupyter.widget-view+json"
COLOURS = {
    "#000000": "currentColor",
    "#ffffff": "var(--color-background-primary, white)",
    "#e6e6e6": "var(--color-background-border, #e6e6e6)",
    "#ededed": "var(--color-background-secondary, #ededed)",
}
"""Colours of figures and the page's colours that replace them, light or dark."""


class SiteFault(RuntimeError):
    """Raised when a page cannot be built, or would have a fault."""


NOT_RUN = "This site was written without running, to look at its texts."
NEEDS_PYTHON = "This control needs Python: run the notebook to move it."
PREPARE = "from percept_obs.site.notebooks import draw_for_pages\ndraw_for_pages()"


def draw_for_pages() -> None:
    """Show figures of the running kernel as drawings in the page's colours, and reviews with what a page judges by."""
    from IPython import get_ipython

    formatters = get_ipython().display_formatter.formatters
    formatters["text/html"].for_type(Figure, drawing)
    formatters[SHEET].for_type(Review, sheet_of)


def drawing(figure: Figure) -> str:
    """Return a figure as SVG within a page, with its text equivalent."""
    import matplotlib

    written = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": figure.text}):
        figure.figure.savefig(written, format="svg", transparent=True, metadata={"Date": None})
    text = written.getvalue()
    text = text[text.index("<svg") :]
    # Its style rules would hold for the whole page.
    text = re.sub(r"<style[^>]*>.*?</style>|<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    for colour, of_the_page in COLOURS.items():
        text = text.replace(colour, of_the_page)
    style = "max-width: 100%; height: auto; fill: currentColor"
    return text.replace("<svg", f'<svg role="img" aria-label="{escape(figure.text)}" style="{style}"', 1)


def run_all(notebooks: Mapping[str, Mapping[str, Any]], parallel: int) -> Iterator[tuple[str, nbformat.NotebookNode]]:
    """Run notebooks, some at once, and yield each with its name in their order; SiteFault if a cell fails."""
    with ThreadPoolExecutor(parallel) as several:
        yield from zip(notebooks, several.map(_run, notebooks, notebooks.values()), strict=True)


def not_run(notebook: Mapping[str, Any]) -> nbformat.NotebookNode:
    """Return a notebook that says below its title why it shows no results."""
    import nbformat

    whole = nbformat.reads(json.dumps(notebook), as_version=4)
    whole.cells.insert(
        1, nbformat.v4.new_markdown_cell(f"*{NOT_RUN} So no cell of this page was run: it has no results.*")
    )
    return whole


def _run(name: str, notebook: Mapping[str, Any]) -> nbformat.NotebookNode:
    import nbformat
    from nbclient.exceptions import CellExecutionError

    from percept_obs.site.kernels import client_of

    whole = nbformat.reads(json.dumps(notebook), as_version=4)
    whole.cells.insert(0, nbformat.v4.new_code_cell(PREPARE))
    try:
        client_of(whole, timeout=600, startup_timeout=600, kernel_name="python3").execute()
    except CellExecutionError as error:
        raise SiteFault(f"{name} does not run: {error.ename}: {error.evalue}") from None
    except (TimeoutError, RuntimeError) as error:  # a cell without an end, or a kernel that does not start or dies
        raise SiteFault(f"{name} does not run: {error}") from None
    del whole.cells[0]
    return whole


def labs_of(notebook: nbformat.NotebookNode) -> dict[str, dict[str, Any]]:
    """Return the states of the labs of a notebook that was run, by the names of their models."""
    return {name: _whole(model) for name, model in _models(notebook).items() if "_esm" in model["state"]}


def without_widgets(notebook: nbformat.NotebookNode, script: str) -> nbformat.NotebookNode:
    """Replace widgets by labs that need no Python, and other widgets by their last outputs, in a notebook that was run.

    The script, HTML that loads the labs' scripts, is put before the first one.
    """
    from nbformat.v4 import new_output

    models, labs = _models(notebook), labs_of(notebook)
    for cell in notebook.cells:
        outputs = cell.get("outputs", [])
        outputs[:] = [output for output in outputs if ENDED not in output.get("data", {}).get("text/html", "")]
        for k, output in enumerate(outputs):
            if VIEW not in output.get("data", {}):
                continue
            name = output["data"][VIEW]["model_id"]
            if name in labs:
                html, script = script + place_of(labs[name]), ""
            else:
                html = f"<p><em>{NEEDS_PYTHON}</em></p>" + "".join(_last_shown(models, name))
            outputs[k] = new_output("display_data", {"text/html": html})
    notebook.metadata.pop("widgets", None)
    return notebook


def _models(notebook: nbformat.NotebookNode) -> Mapping[str, Any]:
    widgets: Mapping[str, Any] = notebook.metadata.get("widgets", {})
    return {name: model for kept in widgets.values() for name, model in kept["state"].items()}


def _whole(model: Mapping[str, Any]) -> dict[str, Any]:
    """Return the state of a lab with its bytes, which a notebook keeps apart."""
    whole: dict[str, Any] = {name: deepcopy(model["state"][name]) for name in SHOWN if name in model["state"]}
    for buffer in model["buffers"]:
        *path, last = buffer["path"]
        reduce(getitem, path, whole)[last] = b64decode(buffer["data"])
    return whole


def _last_shown(models: Mapping[str, Any], name: str) -> Iterator[str]:
    """Yield the outputs of a widget and of the widgets in it as HTML."""
    state = models[name]["state"]
    for output in state.get("outputs", ()):
        data = output.get("data", {})
        if "text/html" in data:
            yield "".join(data["text/html"])  # text, or a list of lines
        elif "text/latex" in data:
            yield displayed("".join(data["text/latex"]))
        else:
            yield f"<pre>{escape(''.join(data.get('text/plain', output.get('text', ''))))}</pre>"
    for child in state.get("children", ()):
        yield from _last_shown(models, child.removeprefix("IPY_MODEL_"))
