"""Python as in a browser: no threads, processes or sockets, and of all packages only those that percept_obs requires.

    python without_threads.py FOLDER [EXTRA]
    python without_threads.py modules
    python without_threads.py NOTEBOOK.ipynb

builds labs and saves them in the folder, follows observers, draws, judges, and with the extra "data" also compares and
runs an ensemble, or says without it how to get it; imports every module; or runs a notebook.  Any warning is an error.
"""

import _thread
import importlib.metadata
import json
import multiprocessing.process
import os
import pkgutil
import socket
import subprocess
import sys
import sysconfig
import threading
import warnings
from pathlib import Path

import matplotlib
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

IN_LITE = ["filterpy", "xarray"]
"""Packages that the notebooks of the JupyterLite get besides."""


def required(name="percept-obs", extra=""):
    """Names of the packages that one requires in a browser, and of those that they require."""
    found = {}
    platform = {"sys_platform": "emscripten", "platform_system": "Emscripten", "extra": extra}

    def add(name):
        for text in importlib.metadata.requires(name) or ():
            wanted = Requirement(text)
            if (wanted.marker is None or wanted.marker.evaluate(platform)) and wanted.name not in found:
                found[wanted.name] = wanted.specifier
                add(wanted.name)

    add(name)
    return found


class Among:
    """A finder of modules that knows only some packages."""

    def __init__(self, finder, absent):
        self.finder, self.absent = finder, absent

    def __getattr__(self, name):
        return getattr(self.finder, name)

    def find_spec(self, name, path=None, target=None):
        return None if name.partition(".")[0] in self.absent else self.finder.find_spec(name, path, target)


def refuse(*args, **kwargs):
    raise RuntimeError("can't start what a browser does not have")


def as_in_a_browser(extra="", more=()):
    """Take away what a browser's Python does not have; `more` are packages that are there all the same."""
    there = {canonicalize_name(name) for name in [*required(extra=extra), "percept-obs", *more]}
    packages = importlib.metadata.packages_distributions().items()
    absent = {module for module, names in packages if not {canonicalize_name(name) for name in names} & there}
    sys.meta_path[:] = [Among(finder, absent) for finder in sys.meta_path]
    threading.Thread.start = _thread.start_new_thread = refuse
    multiprocessing.process.BaseProcess.start = subprocess.Popen.__init__ = os.fork = os.system = refuse
    socket.socket.connect = refuse
    warnings.simplefilter("error")


def work(folder):
    """Use the package as a course does."""
    import percept_obs as po
    from percept_obs import figures, labs, papers
    from percept_obs.recording import scenarios

    sys.platform = "emscripten"  # what asks, asks now; the packages below were made for this machine
    assert "numba" not in sys.modules
    scenario = scenarios.ma2005_eq35()
    form = po.PerspectiveSystem(po.affine(), po.pinhole()).measure("y1", "y2")
    recording = po.record(scenario, duration=3.0)
    run = po.track(recording, po.ibo(form))
    assert str(run.verdict()).startswith("converged")
    figures.runs_over_time(run).figure.savefig(folder / "run.svg")
    assert papers.judge([papers.DE_LUCA2008])
    assert po.check("a13 - a33 y1", "a13 - y1 a33")
    for make in (labs.observer_lab, labs.points_lab, labs.structure_lab):
        lab = make(duration=2.0)
        assert lab.analyse()["sentences"]
        lab.save(folder / f"{lab.kind}.html")
    assert labs.derivation_desk(student="Ada").analysis["steps"]
    return scenario, recording, form


def work_on_data(scenario, recording, form):
    """Make tables and an ensemble; return what is said if that cannot be done."""
    import percept_obs as po
    from percept_obs.studies.comparison import compare

    try:
        assert len(compare([recording], [po.ibo(form), po.ekf(form)])) == 2
        assert po.ensemble(scenario, po.ibo(form), seeds=3, duration=1.0, chunk=1).sizes["seed"] == 3
    except ModuleNotFoundError as error:
        return str(error)
    return ""


def import_all():
    """Import every module of the package and print how many there are."""
    import percept_obs

    found = [module.name for module in pkgutil.walk_packages(percept_obs.__path__, "percept_obs.")]
    found.remove("percept_obs.site.kernels")  # processes themselves
    for name in found:
        importlib.import_module(name)
    print(len(found))


def run(notebook):
    """Run the cells of a notebook."""
    from IPython.core.interactiveshell import InteractiveShell
    from traitlets.config import Config

    shell = InteractiveShell.instance(config=Config(HistoryManager={"enabled": False}))  # which has a thread of its own
    shell.display_formatter.active_types = shell.display_formatter.format_types  # pictures and markup, too
    warnings.simplefilter("error")
    sysconfig.get_config_vars()  # of this machine, for which the packages were made
    sys.platform = "emscripten"
    for cell in json.loads(notebook.read_bytes())["cells"]:
        if cell["cell_type"] == "code":
            shell.run_cell("".join(cell["source"])).raise_error()


if __name__ == "__main__":
    matplotlib.use("Agg")
    what, extra = Path(sys.argv[1]), "".join(sys.argv[2:])
    if what.suffix == ".ipynb" or what.name == "modules":
        as_in_a_browser("data", IN_LITE)
        run(what) if what.suffix else import_all()
    else:
        as_in_a_browser(extra, ["xarray"] if extra else [])  # which a browser's Python has, for who asks for ensembles
        missing = work_on_data(*work(what))
        assert missing == ("" if extra else 'pandas is missing; get it with: python -m pip install "percept-obs[data]"')
