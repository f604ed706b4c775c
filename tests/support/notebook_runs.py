"""Each notebook run once for all tests, with all that is asked of a run; processes that test share what they ran."""

import pickle
from dataclasses import dataclass

import nbformat
import pytest
from jupyter_harness import execute, wait_until
from mistakes import MISTAKES
from notebook_exercises import asked, trials
from packages import modules, outside, required
from places import NOTEBOOKS

from percept_obs.recording.utias import UTIAS_CUT

OPENED_BY = ("percept-obs", "jupyterlab", "numba")
"""Packages that every notebook may use; for others its first cell asks."""


@dataclass(frozen=True)
class Ran:
    """A notebook with its outputs, the states of its widgets, and what went wrong."""

    text: str
    widgets: dict
    fault: str

    @property
    def notebook(self):
        return nbformat.reads(self.text, as_version=4)


def run(name, folder, recording=UTIAS_CUT):
    """Run a notebook with nothing but what its first cell asks for, all of which the extra "course" brings."""
    notebook, widgets, fault = nbformat.read(NOTEBOOKS / name, as_version=4), {}, ""
    brought = [*OPENED_BY, *(package for module in asked(notebook) for package in modules()[module])]
    assert required(*brought).keys() <= required("percept-obs[course]").keys()
    mistakes = trials(notebook, MISTAKES[name.removesuffix(".ipynb")])
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PERCEPT_OBS_UTIAS", str(recording))
        try:
            widgets = execute(notebook, folder, mistakes, outside(*brought))
        except Exception as error:  # which each test that asks for this run will tell
            fault = f"{type(error).__name__}: {error}"
    return Ran(nbformat.writes(notebook), widgets, fault)


def shared(base, name, make):
    """What the process that asked for it first made in a folder of its own, or its failure; the others wait for it."""
    folder, kept = base / name, base / f"{name}.pickle"
    try:
        folder.mkdir()
    except FileExistsError:
        wait_until(kept.exists, f"another process to make {name}", 900)
    else:
        try:
            made = make(folder)
        except Exception as error:
            made = AssertionError(f"{name} was not made: {error}")
        part = folder.with_suffix(".part")
        part.write_bytes(pickle.dumps(made))
        part.rename(kept)
    found = pickle.loads(kept.read_bytes())
    if isinstance(found, Exception):
        raise found
    return found


def shared_run(base, name):
    """The run of a notebook by the process that asked for it first."""
    return shared(base, name, lambda folder: run(name, folder))
