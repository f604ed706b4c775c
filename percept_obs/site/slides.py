"""Slides of the notebooks, turned by reveal.js: the title, cells with the tag ``slide``, exercises; labs are alive."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import nbformat

NEXT = "```{revealjs-break}\n:notitle:\n```"
KINDS = ("text/html", "image/svg+xml", "image/png", "text/latex", "text/markdown", "text/plain")

SETTINGS: dict[str, Any] = {
    "html_css_files": [],
    "revealjs_static_path": ["_static"],
    "revealjs_css_files": ["slides.css"],
    "revealjs_style_theme": "white",
    # Labs are drawn to scale, and their keys and drags turn no slide; reveal.js counts their sections as slides.  On a
    # telephone it would show all slides below one another, each cut to the height of the window.
    "revealjs_script_conf": "{width: '100%', height: '100%', margin: 0.02, center: false, hash: true, touch: false, "
    "progress: false, scrollActivationWidth: null, "
    "keyboardCondition: () => !document.activeElement.closest('.percept-lab')}",
    "nb_mime_priority_overrides": [("revealjs", kind, place) for place, kind in enumerate(KINDS, 1)],
}
"""Settings of Sphinx where they are not those of the site."""

# The theme's own page forbids its readers to zoom.
PAGE = '{% extends "!page.html" %}{% block extrahead %}{% endblock %}'


def prepare(folder: Path, style: str) -> None:
    """Write what all slides share into the folder of their source."""
    for name, text in (("_templates/page.html", PAGE), ("_static/slides.css", style)):
        (folder / name).parent.mkdir(parents=True)
        (folder / name).write_text(text, "utf-8")


def slides_of(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """Return a notebook of its title and the cells that are slides, of code only what it shows."""
    from nbformat.v4 import new_markdown_cell

    made = deepcopy(notebook)
    made.cells = []
    for k, cell in enumerate(deepcopy(notebook.cells)):
        tags = cell.metadata.get("tags", [])
        if k == 0 or "slide" in tags or ("exercise" in tags and cell.cell_type == "markdown"):
            begins = [] if cell.source.startswith("#") else [new_markdown_cell(NEXT)]
            cell.metadata["tags"] = [*tags, "remove-input"]
            made.cells += [*begins, cell]
    return made
