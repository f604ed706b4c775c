"""The package does in a browser's Python what it does elsewhere: no threads, no processes, no extras."""

import importlib.metadata
import subprocess
import sys

import pytest
from packages import required
from packaging.utils import canonicalize_name
from places import NOTEBOOKS, ROOT, SUPPORT
from without_threads import IN_LITE, PLATFORM

from percept_obs.exercises.models import notebooks
from percept_obs.site.lite import BESIDE

BUILT_FOR_PYODIDE = {
    "contourpy": "1.3.3",
    "fonttools": "4.62.1",
    "kiwisolver": "1.5.0",
    "matplotlib": "3.10.8",
    "numpy": "2.4.6",
    "pandas": "3.0.2",
    "pillow": "12.2.0",
    "pyyaml": "6.0.3",
    "scipy": "1.18.0",
}
"""Packages with compiled parts, as Pyodide 314.0.6 builds them for Python 3.14: pyodide-lock.json of npm's pyodide."""

IN_PYODIDE = {
    *("asttokens", "cycler", "executing", "ipython", "jedi", "matplotlib-inline", "mpmath", "packaging", "parso"),
    *("platformdirs", "prompt-toolkit", "pure-eval", "pygments", "pyparsing", "python-dateutil", "six", "stack-data"),
    *("sympy", "tqdm", "traitlets", "typing-extensions", "tzdata", "wcwidth", "xarray", *BUILT_FOR_PYODIDE),
}
"""Packages that Pyodide 314.0.6 has, of those that are required here."""

OF_THE_KERNEL = {"widgetsnbextension"}
"""Packages that come with JupyterLite's Python."""

FROM_PYPI = {"ipython-pygments-lexers", "psygnal", "pytz"}
"""Packages that a reader's browser fetches from PyPI; psygnal has, besides wheels for machines, one for any.

pytz is asked for by pandas before version 3."""


FIRST, *FURTHER = sorted(notebooks())


@pytest.mark.night
@pytest.mark.slow
@pytest.mark.parametrize("extra", [[], ["data"]], ids=str)
def test_a_course_runs_without_threads_processes_and_other_extras(tmp_path, extra):
    """It takes the night for its twenty seconds: every run imports all modules so, and runs a notebook."""
    command = [sys.executable, SUPPORT / "without_threads.py", tmp_path, *extra]
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    assert {path.name for path in tmp_path.iterdir()} == {
        *("run.svg", "observer_lab.html", "points_lab.html", "structure_lab.html")
    }


def is_pure(name):
    return "Root-Is-Purelib: true" in (importlib.metadata.distribution(name).read_text("WHEEL") or "")


def test_every_package_that_is_required_is_pure_or_built_for_the_browser():
    found = required("percept-obs[data]", **PLATFORM)
    assert not {"pandas", "pyyaml"} & set(required("percept-obs", **PLATFORM)), "a plain install has grown"
    assert {"numpy", "sympy", "anywidget", "ipython", "traitlets"} <= set(found)
    assert {name for name in found if not is_pure(name)} <= {*BUILT_FOR_PYODIDE, "psygnal", "wcwidth"}
    assert not {"numba", "psutil", "pyzmq", "tornado", "jupyterlab"} & set(found)
    for name, version in BUILT_FOR_PYODIDE.items():
        assert version in found[name], f"{name} {version} is what Pyodide has; {found[name]} is asked for"


def test_every_package_is_pyodide_s_or_beside_the_notebooks_or_on_pypi():
    found = set(required("percept-obs[data]", *IN_LITE, "comm", **PLATFORM)) - {"percept-obs"}
    beside = {canonicalize_name(name) for name in BESIDE}
    assert not beside & IN_PYODIDE
    assert found - IN_PYODIDE - beside - OF_THE_KERNEL <= FROM_PYPI


@pytest.mark.slow
@pytest.mark.parametrize("names", [["modules", FIRST], pytest.param(FURTHER, marks=pytest.mark.night)], ids=len)
def test_modules_and_notebooks_do_without_threads_processes_sockets_and_numba(names, tmp_path):
    """The others are left to the night, for it takes minutes to run them here once more."""
    for what in names:
        command = [sys.executable, SUPPORT / "without_threads.py", what if what == "modules" else NOTEBOOKS / what]
        answer = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
        if what.startswith("16"):  # films, of which a note at its beginning in a browser tells
            assert "av, cv2 is missing, and this notebook needs it" in answer.stderr
        else:
            assert answer.returncode == 0, (what, answer.stderr[-2000:])


def test_the_wheel_has_nothing_compiled():
    files = [path for path in (ROOT / "percept_obs").rglob("*") if "node_modules" not in path.parts]
    assert not [path for path in files if path.suffix in (".so", ".pyd", ".dll", ".c", ".pyx")]
    settings = (ROOT / "pyproject.toml").read_text("utf-8")
    assert 'build-backend = "hatchling.build"' in settings
    assert "hooks" not in settings, "which could make the wheel one for a single machine"
