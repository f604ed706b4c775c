"""The package does in a browser's Python what it does elsewhere: no threads, no processes, no extras."""

import importlib.metadata
import subprocess
import sys
from pathlib import Path

import pytest
from without_threads import required

HERE = Path(__file__).parent

BUILT_FOR_PYODIDE = {
    "contourpy": "1.3.3",
    "fonttools": "4.62.1",
    "kiwisolver": "1.4.9",
    "matplotlib": "3.10.8",
    "numpy": "2.4.3",
    "pandas": "3.0.2",
    "pillow": "12.2.0",
    "pyyaml": "6.0.2",
    "scipy": "1.17.1",
}
"""Packages with compiled parts, as Pyodide builds them: https://anaconda.org/pyodide/repo and pyodide-lock.json of its
releases, read in November 2026."""

PURE_AS_WELL = {"psygnal", "wcwidth"}
"""Packages that have on PyPI, besides wheels for machines, one for any: psygnal-0.16.1-py3-none-any.whl, say."""


@pytest.mark.slow
@pytest.mark.parametrize("extra", [[], ["data"]], ids=["plain", "data"])
def test_a_course_runs_without_threads_processes_and_other_extras(tmp_path, extra):
    command = [sys.executable, HERE / "without_threads.py", tmp_path, *extra]
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    assert {path.name for path in tmp_path.iterdir()} == {
        *("run.svg", "observer_lab.html", "points_lab.html", "structure_lab.html")
    }


def is_pure(name):
    return "Root-Is-Purelib: true" in (importlib.metadata.distribution(name).read_text("WHEEL") or "")


def test_every_package_that_is_required_is_pure_or_built_for_the_browser():
    found = {name.lower(): wanted for name, wanted in required(extra="data").items()}
    assert not {"pandas", "pyyaml"} & set(map(str.lower, required())), "a plain install has grown"
    assert {"numpy", "sympy", "anywidget", "ipython", "traitlets"} <= set(found)
    assert {name.lower() for name in found if not is_pure(name)} <= {*BUILT_FOR_PYODIDE, *PURE_AS_WELL}
    assert not {"numba", "psutil", "pyzmq", "tornado", "jupyterlab"} & set(found)
    for name, version in BUILT_FOR_PYODIDE.items():
        assert version in found[name], f"{name} {version} is what Pyodide has; {found[name]} is asked for"


def test_the_wheel_has_nothing_compiled():
    files = [path for path in (HERE.parent / "percept_obs").rglob("*") if "node_modules" not in path.parts]
    assert not [path for path in files if path.suffix in (".so", ".pyd", ".dll", ".c", ".pyx")]
    settings = (HERE.parent / "pyproject.toml").read_text("utf-8")
    assert 'build-backend = "hatchling.build"' in settings
    assert "hooks" not in settings, "which could make the wheel one for a single machine"
