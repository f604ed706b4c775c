"""Imports go down only, front ends load when a lab opens, and sympy becomes code in one place."""

import ast
import re
import subprocess
import sys
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import percept_obs

PACKAGE = Path(percept_obs.__file__).parent

# The top first.  A folder may import those of lower floors; inside a folder nothing goes round in a circle.
FLOORS = (
    ("cli",),
    ("site",),
    ("labs",),
    ("figures", "papers", "exercises", "film"),
    ("checking",),
    ("studies",),
    ("structure", "points"),
    ("observability",),
    ("tracking",),
    ("recording", "observers"),
    ("system",),
    ("compile",),
    ("validation",),
)
LEVEL = {name: level for level, names in enumerate(FLOORS) for name in names}

WIDGETS = {"anywidget", "ipywidgets"}
CODE = {"lambdify", "printing", "codegen", "autowrap", "pycode", "jscode", "ccode", "fcode"}


@cache
def modules(package):
    """Every module of a package folder: dotted name inside the package -> path; a folder has its own name."""
    return {
        ".".join(path.relative_to(package).with_suffix("").parts).removesuffix("__init__").rstrip("."): path
        for path in sorted(package.rglob("*.py"))
    }


@cache
def tree_of(path):
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def imports(package, module):
    """What a module imports, as absolute dotted names: `from a.b import c` gives a.b.c."""
    return tuple(_imports(package, module))


def _imports(package, module):
    path = modules(package)[module]
    here = [package.name, *path.relative_to(package).parent.parts]
    for statement in ast.walk(tree_of(path)):
        if isinstance(statement, ast.Import):
            yield from (alias.name for alias in statement.names)
        elif isinstance(statement, ast.ImportFrom):
            above = here[: len(here) + 1 - statement.level] if statement.level else []
            origin = ".".join([*above, *filter(None, [statement.module])])
            yield from (f"{origin}.{alias.name}" for alias in statement.names)


def imports_inside(package, module):
    """The modules of the package that a module imports; "" is the package itself."""
    known = modules(package)
    for name in imports(package, module):
        parts = name.split(".")
        if parts[0] == package.name:
            target = ".".join(parts[1:])
            yield target if target in known else ".".join(parts[1:-1])


def sympy_names(package, module):
    """Every dotted name under sympy that a module imports, or reaches through an imported sympy."""
    text = modules(package)[module].read_text(encoding="utf-8")
    aliases = "|".join(["sympy", *re.findall(r"^import sympy as (\w+)", text, re.MULTILINE)])
    yield from (name for name in imports(package, module) if name.split(".")[0] == "sympy")
    yield from (f"sympy.{name}" for name in re.findall(rf"\b(?:{aliases})\.([\w.]+)", text))


def upward(package):
    """Every import that the floors forbid, in words."""
    for module in modules(package):
        home = module.split(".")[0]
        if home == "":
            continue  # __init__ gathers the public names from everywhere
        if home not in LEVEL:
            yield f"{module} is on no floor: put it into a folder"
            continue
        for target in sorted(set(imports_inside(package, module))):
            other = target.split(".")[0]
            if other != home and LEVEL.get(other, -1) <= LEVEL[home]:
                yield f"{module} must not import {target or package.name}"


def in_circles(package):
    """Modules of a folder that import each other, or the folder that gathers them."""
    graph = {
        module: {target for target in imports_inside(package, module) if target.split(".")[0] == module.split(".")[0]}
        for module in modules(package)
        if module
    }
    try:
        tuple(TopologicalSorter(graph).static_order())
    except CycleError as error:
        yield f"{' imports '.join(reversed(error.args[1]))}: a circle"


def widgets_outside_labs(package):
    for module in modules(package):
        for name in imports(package, module):
            if name.split(".")[0] in WIDGETS and module.split(".")[0] != "labs":
                yield f"{module} must not import {name}: only labs may"


def code_outside_compile(package):
    for module in modules(package):
        for name in sympy_names(package, module):
            if CODE & set(name.split(".")) and module.split(".")[0] != "compile":
                yield f"{module} must not use {name}: only compile may"


RULES = (upward, in_circles, widgets_outside_labs, code_outside_compile)


@pytest.mark.parametrize("rule", RULES)
def test_the_package_keeps_the_rule(rule):
    complaints = list(rule(PACKAGE))
    assert not complaints, "\n".join(complaints)


@pytest.mark.parametrize(
    ("path", "text", "complaint"),
    [
        ("system/forms.py", "from percept_obs.observers import Observer", "system.forms must not import observers"),
        ("system/forms.py", "from ..observers.base import Observer", "system.forms must not import observers.base"),
        ("system/forms.py", "from .. import tracking", "system.forms must not import tracking"),
        ("system/forms.py", "import percept_obs.tracking as t", "system.forms must not import tracking"),
        ("system/forms.py", "def f():\n    from ..tracking import track", "system.forms must not import tracking"),
        ("system/forms.py", "from percept_obs import ibo", "system.forms must not import percept_obs"),
        ("points/form.py", "from ..structure import x", "points.form must not import structure"),
        ("observers/base.py", "from .family import x", ": a circle"),
        ("observers/family.py", "from . import Observer", ": a circle"),
        ("helpers.py", "", "helpers is on no floor: put it into a folder"),
        ("figures/run.py", "import ipywidgets as w", "figures.run must not import ipywidgets: only labs may"),
        ("system/forms.py", "from sympy import lambdify", "system.forms must not use sympy.lambdify: only compile may"),
        ("system/forms.py", "import sympy as s\ns.lambdify", "forms must not use sympy.lambdify: only compile may"),
        ("system/forms.py", "import sympy.printing", "forms must not use sympy.printing: only compile may"),
        (
            "system/forms.py",
            "from sympy.printing.pycode import PythonCodePrinter",
            "forms must not use sympy.printing.pycode.PythonCodePrinter: only compile may",
        ),
    ],
)
def test_a_breach_is_seen(tmp_path, path, text, complaint):
    assert any(complaint in line for line in complaints(tmp_path, path, text))


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("tracking/run.py", "from ..system.forms import x\nfrom percept_obs import compile\nimport sympy"),
        ("observers/ekf.py", "from .base import Observer\nfrom ..system.forms import x"),
        ("observers/__init__.py", "from .family import ekf\nfrom . import base"),
        ("compile/loop.py", "from sympy import lambdify\nfrom sympy.printing.pycode import PythonCodePrinter"),
        ("labs/base.py", "import anywidget"),
        ("system/forms.py", "observer.lambdify()\nfrom sympy import latex"),
        ("__init__.py", "from .observers import ibo\nfrom .tracking import track"),
    ],
)
def test_what_is_allowed_passes(tmp_path, path, text):
    assert complaints(tmp_path, path, text) == []


def complaints(folder, path, text):
    """What the rules say of a small package in which one file has this text."""
    package = folder / "percept_obs"
    folders = ("", "validation/", "compile/", "system/", "observers/", "points/", "structure/", "tracking/")
    files = ("observers/base.py", "observers/family.py", "system/forms.py")
    for name in (*(f"{folder}__init__.py" for folder in folders), *files, path):
        file = package / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch()
    (package / "observers/family.py").write_text("from .base import x", encoding="utf-8")
    (package / "observers/__init__.py").write_text("from .family import x", encoding="utf-8")
    (package / path).write_text(text, encoding="utf-8")
    return [line for rule in RULES for line in rule(package)]


@pytest.mark.slow
def test_importing_the_package_loads_nothing_heavy_that_may_wait():
    wait = {"numba", "anywidget", "ipywidgets", "matplotlib", "pandas", "scipy"}
    program = f"import sys, percept_obs; print(*sorted({wait} & set(sys.modules)))"
    program += "; import percept_obs.figures; print('matplotlib' in sys.modules, 'matplotlib.pyplot' in sys.modules)"
    loaded = subprocess.check_output([sys.executable, "-c", program], text=True)
    assert loaded.split() == ["True", "False"], "figures load matplotlib, but never open its windows"
