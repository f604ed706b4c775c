"""Static site of the course: notebooks with live labs, the papers' equations, the reference, the teacher's guide.

Sphinx builds it, with MyST-NB.  It needs no network, neither to be built nor to be read, and opens from a disk.
"""

from __future__ import annotations

import io
import re
import shutil
import tempfile
from collections.abc import Collection, Mapping
from importlib import metadata, resources
from itertools import chain
from pathlib import Path
from typing import Any

from percept_obs.exercises import COPIES
from percept_obs.labs.shared.saved import STARTER, library_of
from percept_obs.papers import NAMED
from percept_obs.site import front_ends, lite, slides
from percept_obs.site.addresses import CARD, above_versions, card, write_sitemap
from percept_obs.site.exercises import on_a_page
from percept_obs.site.faults import faults_of
from percept_obs.site.front import PLAYER, front, tree
from percept_obs.site.named import named
from percept_obs.site.notebooks import SiteFault, labs_of, not_run, run_all, without_widgets
from percept_obs.site.pages import Pages, contents, ledger_pages, reference
from percept_obs.validation import needed

__all__ = ["SiteFault", "build"]

NEEDS = ("sphinx", "myst_nb", "furo", "sphinx_revealjs", "latex2mathml", "nbclient")
"""Modules of the extra "site"."""

TEXTS = resources.files("percept_obs.site") / "texts"
SCRIPTS = "".join(f'<script defer src="../_static/{name}"></script>' for name in ("labs.js", "alone.js"))

SETTINGS: dict[str, Any] = {
    "project": "percept_obs",
    "release": metadata.version("percept_obs"),
    "language": "en",
    "extensions": ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "percept_obs.site.extension"],
    "html_title": "percept_obs",
    "html_theme": "furo",
    "html_math_renderer": "mathml",
    "html_static_path": ["_static"],
    "templates_path": ["_templates"],
    "html_css_files": ["look.css"],
    "html_copy_source": False,
    "html_show_sphinx": False,
    "html_show_copyright": False,
    "nb_execution_mode": "off",
    "nb_merge_streams": True,
    "nb_render_markdown_format": "myst",
    "myst_enable_extensions": ["dollarmath", "amsmath", "substitution"],
    "napoleon_google_docstring": False,
    "autodoc_typehints": "none",
    "autodoc_preserve_defaults": True,  # written out, all ledgers are a default of 600 kB
    "add_module_names": False,
}

PROCESSES = 2
"""Notebooks that run at once, then pages that are written at once."""


def build(
    target: Path,
    notebooks: Mapping[str, Mapping[str, Any]],
    exam: bool = False,
    address: str = "",
    python: bool = False,
    run: Collection[str] | None = None,
) -> None:
    """Build the site.

    Parameters
    ----------
    target : path
        Folder of the site; pages of an earlier one are replaced.
    notebooks : mapping of str to notebook
        Files with their solutions and answers, by their names.
    exam : bool
        Whether the site is for teachers: the exam's questions, with their solutions, have a page, and answers are
        unfolded at once, without a field for one's own.
    address : str, optional
        Where the site will stand, ``"https://example.org/course/"``; with it pages say their own address, and there is
        a list of them all for search engines.  If it ends with a version, as ``".../course/1.2/"``, pages lead to the
        folder above, where the others stand.
    python : bool
        Whether JupyterLite stands beside the pages, with the notebooks and a Python that runs in the reader's browser.
    run : collection of str, optional
        Names of the notebooks that are run and of the papers that are judged; all, when left out.  The pages of the
        others have no results, and say so.

    Raises
    ------
    ValueError
        If the address is none of a site.
    SiteFault
        If a notebook does not run, a page has a fault such as a link that leads nowhere, or JupyterLite cannot be
        built.  What can be known without running is asked before any work starts, and told at once.
    ModuleNotFoundError
        If a package that builds the site is missing; it says how to get it.
    """
    if address and not re.match("https?://[^/]", address):
        raise ValueError(f"the address is {address!r}; it begins with https://, as https://example.org/course/")
    address = address and address.rstrip("/") + "/"
    run = {*notebooks, *NAMED} if run is None else {*run}
    names = named(notebooks, exam)
    texts = {path: text for path, text in _texts(exam) if path.endswith(".md")}
    if found := [*faults_of(notebooks, texts, names, run)]:
        raise SiteFault("\n".join(("the site has faults:", *found)))
    needed("site", *NEEDS)
    if python:
        needed("lite", *lite.NEEDS)
    with tempfile.TemporaryDirectory() as folder:
        source, shown = Path(folder) / "site", Path(folder) / "slides"
        article, lab = front(notebooks)
        _notebooks(source, shown, notebooks, run)
        _write(source / "_static" / "first.js", library_of([lab.get_state()]))
        print("writing the papers' equations")
        for path, text in [
            *ledger_pages(run & {*NAMED}),
            *reference(),
            *_texts(exam),
            ("index.md", tree()),
        ]:
            _write(source / path, text)
        print("writing the pages")
        (source / "_static" / CARD).write_bytes(card())
        with resources.as_file(TEXTS / "pictures") as pictures:
            shutil.copytree(pictures, source / "pictures")
        context = {
            **{"versions": above_versions(address), "python": lite.PLACES if python else {}},
            **{"fields": not exam, "article": article},
        }
        in_place = {"index": "article.html"}
        settings = {"html_baseurl": address, "html_context": context, "html_additional_pages": in_place}
        _generate(source, target, {"myst_substitutions": names, **settings}, parallel=PROCESSES)
        slides.prepare(shown, (TEXTS / "slides.css").read_text("utf-8"))
        extensions = [*SETTINGS["extensions"], "sphinx_revealjs"]
        _generate(shown, target / "slides", {**slides.SETTINGS, "extensions": extensions}, "revealjs")
        shutil.rmtree(target / "slides" / "_static" / "revealjs" / "plugin")  # none is used
    if address:
        write_sitemap(target, address)
    if python:
        print("building JupyterLite")
        copies = COPIES["teachers" if exam else "students"]
        lite.write_lite(target, {name: copies(notebook) for name, notebook in notebooks.items()})
    print(f"wrote {target / 'index.html'}")


def _notebooks(
    source: Path,
    shown: Path,
    notebooks: Mapping[str, Mapping[str, Any]],
    run: set[str],
) -> None:
    """Run notebooks, and write all and their slides, with the scripts of their labs."""
    import nbformat

    states: dict[bytes, Mapping[str, Any]] = {}
    wanted = {name: notebook for name, notebook in notebooks.items() if name in run}
    kept = ((name, not_run(notebook)) for name, notebook in notebooks.items() if name not in run)
    for name, notebook in chain(run_all(wanted, PROCESSES), kept):
        print(f"{'ran' if name in run else 'wrote'} {name}")
        states |= {state["texts"]: state for state in labs_of(notebook).values()}
        notebook = on_a_page(notebook)
        _write(shown / name, nbformat.writes(without_widgets(slides.slides_of(notebook), SCRIPTS)))
        _write(source / "notebooks" / name, nbformat.writes(without_widgets(notebook, SCRIPTS)))
    stems = [name.removesuffix(".ipynb") for name in notebooks]
    _write(source / "notebooks" / "index.md", contents("The course", "Read the notebooks in this order.", stems))
    _write(shown / "index.md", contents("Slides", "The notebooks as slides; the arrow keys turn them.", stems))
    _write(source / "_static" / "labs.js", library_of(states.values()))
    for script in (STARTER, STARTER.with_name("exercises.js"), PLAYER):
        shutil.copy(script, source / "_static")


def _texts(exam: bool) -> Pages:
    """Yield the texts written by hand, and the table of front ends."""
    yield "front_ends.md", front_ends.page()
    for text in (
        each
        for each in TEXTS.iterdir()
        if not each.name.endswith(".toml") and each.is_file() and (exam or each.name != "exam.md")
    ):
        folder = {".css": "_static/", ".html": "_templates/"}.get(Path(text.name).suffix, "")
        yield folder + text.name, text.read_text("utf-8")


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def _generate(source: Path, target: Path, names: Mapping[str, Any], builder: str = "html", parallel: int = 1) -> None:
    from sphinx.application import Sphinx
    from sphinx.util.docutils import docutils_namespace

    faults, settings, trees = io.StringIO(), {**SETTINGS, **names}, source / ".doctrees"
    with docutils_namespace():
        app = Sphinx(source, None, target, trees, builder, settings, None, faults, True, parallel=parallel)
        app.build(force_all=True)
    if faults.getvalue():
        raise SiteFault(f"the site has faults:\n{faults.getvalue()}")
