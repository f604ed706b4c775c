"""Python as in a browser: no threads, processes or sockets, and of all packages only those that percept_obs requires.

    python without_threads.py FOLDER [EXTRA]
    python without_threads.py modules
    python without_threads.py NOTEBOOK.ipynb

builds labs and saves them in the folder, follows observers, draws, judges, and with the extra "data" also compares and
runs an ensemble, or says without it how to get it; imports every module; or runs a notebook.  Any warning is an error.
"""

import _thread
import importlib
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
from packages import hide, outside

IN_LITE = ("filterpy", "xarray")
"""Packages that the notebooks of the JupyterLite get besides."""

PLATFORM = {"sys_platform": "emscripten", "platform_system": "Emscripten"}
"""A browser, as requirements call it."""


def refuse(*args, **kwargs):
    raise RuntimeError("can't start what a browser does not have")


def as_in_a_browser(*asked):
    """Take away what a browser's Python does not have, and packages that no requirement brings."""
    hide(outside(*asked, **PLATFORM))
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
    assert papers.judge(papers.find(["(10)"], paper="Ma"))
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
        assert len(compare([recording], [po.ibo(form), po.ekf(form)]).table) == 2
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
        as_in_a_browser("percept-obs[data]", *IN_LITE)
        run(what) if what.suffix else import_all()
    else:
        # A browser's Python has xarray, for who asks for ensembles.
        as_in_a_browser(*([f"percept-obs[{extra}]", "xarray"] if extra else ["percept-obs"]))
        missing = work_on_data(*work(what))
        assert missing == ("" if extra else 'pandas is missing; get it with: python -m pip install "percept-obs[data]"')
