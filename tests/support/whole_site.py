"""The whole site, made once for all tests from the runs of the notebooks, and its pages."""

import warnings

import pytest
from notebook_runs import shared

NOTEBOOK = "00_start.ipynb"
"""The notebook that the site runs itself; it gets a second lab."""
ADDRESS = "https://example.org/course"
EXERCISES = '<script src="../_static/exercises.js"></script></body>'


def shared_site(base, ran):
    """The folder of the site that the first process to ask makes; the others wait for it."""
    return shared(base, "site", lambda folder: made(folder, ran))


def made(target, ran):
    """Make the site in a folder, with the exam and without JupyterLite, which has tests of its own."""
    from percept_obs import cli, site
    from percept_obs.exercises import models

    copies, run_all = models.notebooks(), site.run_all
    second = "from percept_obs.labs import observer_lab\nobserver_lab(outputs=['y1'])"
    cell = {"cell_type": "code", "id": "second", "metadata": {}, "execution_count": None, "outputs": []}
    copies[NOTEBOOK]["cells"].append(cell | {"source": second})

    def taken(wanted, parallel):
        yield from run_all({NOTEBOOK: wanted.pop(NOTEBOOK)}, 1)
        for name in wanted:
            assert ran(name).fault == ""
            yield name, ran(name).notebook

    def no_lite(target, notebooks):
        page = target / site.lite.PLACES["app"]
        page.parent.mkdir(parents=True)
        page.touch()

    with warnings.catch_warnings(), pytest.MonkeyPatch.context() as patch:
        warnings.simplefilter("ignore")  # the generator's own
        patch.setattr(site, "run_all", taken)
        patch.setattr(site.lite, "write_lite", no_lite)
        patch.setattr(models, "notebooks", lambda: copies)
        assert cli.main(["site", "--for", "teachers", "--address", ADDRESS, "--python", str(target)]) == 0
    for path in (target / "notebooks").glob("[0-9]*.html"):  # as students get them: only teachers get the exam
        path.write_text(path.read_text("utf-8").replace("</body>", EXERCISES), "utf-8")
    return target


def written(pages):
    """The pages, in order; those of JupyterLite are no pages of ours."""
    return sorted(path for path in pages.rglob("*.html") if path.relative_to(pages).parts[0] != "lite")


def kind(page):
    """The kind of a page by its path below the site; each text and each notebook is a kind of its own."""
    folder, *rest = page.parts
    own = len(rest) < 2 and folder not in ("reference", "slides")
    return page if own else (folder, len(rest), page.stem == "index")


def of_each_kind(pages):
    """A page of each kind: the many pages of one kind, such as a paper's equations, are all made the same way."""
    return list({kind(path.relative_to(pages)): path for path in reversed(written(pages))}.values())
