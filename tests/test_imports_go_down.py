"""Imports go down only, front ends load when a lab opens, and sympy becomes code in one place."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import percept_obs

PACKAGE = Path(percept_obs.__file__).parent

# The top first. A module may import those of lower lines, never those beside it; a package may spread over lines.
LAYERS = (
    ("cli",),
    ("labs",),
    ("labs.analysis", "labs.choices", "labs.points_words", "labs.tracks"),
    ("labs.points_model", "labs.structures"),
    ("labs.kernels", "labs.lecture"),
    ("labs.checks", "labs.markup", "labs.printing", "labs.sampling"),
    ("figures", "exercises"),
    ("papers", "tuning", "structure_runs"),
    ("captions", "chatter", "compare", "consistency", "points", "two_stage"),
    ("points.gramian", "points.ray", "points.tracking", "points.utias"),
    ("points.run",),
    ("least_squares", "observability", "tracking"),
    ("run",),
    ("scenarios", "datasets", "points.scenarios"),
    ("points.recording", "points.conditions", "structure"),
    ("structure.simulation",),
    ("recording", "points.luenberger", "structure.corollaries", "structure.linear"),
    ("structure.base",),
    ("observers", "perspective", "points.bodies", "points.kernel"),
    ("recovery",),
    ("forms", "points.form", "points.weights"),
    ("points.block", "points.directions", "points.manoeuvre"),
    ("motion", "surfaces", "pixels"),
    ("compile",),
    ("equations", "derivation", "switching", "views"),
)
LEVEL = {name: level for level, names in enumerate(LAYERS) for name in names}

WIDGETS = {"anywidget", "ipywidgets"}
CODE = {"lambdify", "printing", "codegen", "autowrap", "pycode", "jscode", "ccode", "fcode"}


def modules(package):
    """Every module of a package folder: dotted name inside the package -> path; a folder has its own name."""
    return {
        ".".join(path.relative_to(package).with_suffix("").parts).removesuffix("__init__").rstrip("."): path
        for path in sorted(package.rglob("*.py"))
    }


def imports(package, module):
    """What a module imports, as absolute dotted names: `from a.b import c` gives a.b.c."""
    path = modules(package)[module]
    here = [package.name, *path.relative_to(package).parent.parts]
    for statement in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
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


def sympy_names(path):
    """Every dotted name under sympy that a file imports or reaches through an imported sympy."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    aliases = {}
    for statement in ast.walk(tree):
        if isinstance(statement, ast.Import):
            for alias in statement.names:
                if alias.name.split(".")[0] == "sympy":
                    yield alias.name
                    aliases[alias.asname or "sympy"] = alias.name if alias.asname else "sympy"
        elif isinstance(statement, ast.ImportFrom) and (statement.module or "").split(".")[0] == "sympy":
            yield from (f"{statement.module}.{alias.name}" for alias in statement.names)
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            root, _, rest = ast.unparse(node).partition(".")
            if root in aliases:
                yield f"{aliases[root]}.{rest}"


def home_of(module):
    """The longest beginning of a module's name that has a layer, and what is left of the name."""
    parts = module.split(".")
    for length in range(len(parts), 0, -1):
        if (home := ".".join(parts[:length])) in LEVEL:
            return home, parts[length:]
    return parts[0], parts[1:]


def upward(package):
    """Every import that the order forbids, in words."""
    for module in modules(package):
        home, inner = home_of(module)
        if home == "":
            continue  # __init__ gathers the public names from everywhere
        if home not in LEVEL:
            yield f"{module} is in no layer: add {home} to LAYERS"
            continue
        for target in sorted(set(imports_inside(package, module))):
            other, _ = home_of(target)
            if other == home:
                allowed = not inner or (target == f"{home}.base" and target != module)
            else:
                allowed = other in LEVEL and LEVEL[other] > LEVEL[home]
            if not allowed:
                yield f"{module} must not import {target or package.name}"


def widgets_outside_labs(package):
    for module in modules(package):
        for name in imports(package, module):
            if name.split(".")[0] in WIDGETS and module.split(".")[0] != "labs":
                yield f"{module} must not import {name}: only labs may"


def code_outside_compile(package):
    for module, path in modules(package).items():
        for name in sympy_names(path):
            if CODE & set(name.split(".")) and module.split(".")[0] != "compile":
                yield f"{module} must not use {name}: only compile may"


RULES = (upward, widgets_outside_labs, code_outside_compile)


@pytest.mark.parametrize("rule", RULES)
def test_the_package_keeps_the_rule(rule):
    complaints = list(rule(PACKAGE))
    assert not complaints, "\n".join(complaints)


@pytest.mark.parametrize(
    ("path", "text", "complaint"),
    [
        ("forms.py", "from percept_obs.observers import Observer", "forms must not import observers"),
        ("forms.py", "from .observers.base import Observer", "forms must not import observers.base"),
        ("forms.py", "from . import tracking", "forms must not import tracking"),
        ("forms.py", "import percept_obs.tracking as t", "forms must not import tracking"),
        ("forms.py", "def f():\n    from .tracking import track", "forms must not import tracking"),
        ("forms.py", "from percept_obs import ibo", "forms must not import percept_obs"),
        ("points/form.py", "from .tracking import track", "points.form must not import points.tracking"),
        ("points/form.py", "from . import x", "points.form must not import points"),
        ("motion.py", "from .surfaces import pinhole", "motion must not import surfaces"),
        ("observers/ekf.py", "from ..tracking import track", "observers.ekf must not import tracking"),
        ("observers/ekf.py", "from .family import x", "observers.ekf must not import observers.family"),
        ("observers/ekf.py", "from . import Observer", "observers.ekf must not import observers"),
        ("observers/base.py", "from .family import x", "observers.base must not import observers.family"),
        ("helpers.py", "", "helpers is in no layer: add helpers to LAYERS"),
        ("figures.py", "import ipywidgets as w", "figures must not import ipywidgets: only labs may"),
        ("forms.py", "from sympy import lambdify", "forms must not use sympy.lambdify: only compile may"),
        ("forms.py", "import sympy as s\ns.lambdify", "forms must not use sympy.lambdify: only compile may"),
        ("forms.py", "import sympy.printing", "forms must not use sympy.printing: only compile may"),
        (
            "forms.py",
            "from sympy.printing.pycode import PythonCodePrinter",
            "forms must not use sympy.printing.pycode.PythonCodePrinter: only compile may",
        ),
    ],
)
def test_a_breach_is_seen(tmp_path, path, text, complaint):
    assert complaint in complaints(tmp_path, path, text)


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("tracking.py", "from .forms import CanonicalForm\nfrom percept_obs import compile\nimport sympy"),
        ("observers/ekf.py", "from .base import Observer\nfrom . import base\nfrom ..forms import x"),
        ("observers/__init__.py", "from .ekf import ekf\nfrom . import base"),
        ("compile/base.py", "from sympy import lambdify\nfrom sympy.printing.pycode import PythonCodePrinter"),
        ("labs/base.py", "import anywidget"),
        ("forms.py", "observer.lambdify()\nfrom sympy import latex"),
        ("__init__.py", "from .observers import ibo\nfrom .tracking import track"),
    ],
)
def test_what_is_allowed_passes(tmp_path, path, text):
    assert complaints(tmp_path, path, text) == []


def complaints(folder, path, text):
    """What the rules say of a small package in which one file has this text."""
    package = folder / "percept_obs"
    observers = ("observers/__init__.py", "observers/base.py", "observers/family.py")
    points = ("points/__init__.py", "points/tracking.py")
    others = ("__init__.py", "tracking.py", "compile/__init__.py", "forms.py", "surfaces.py")
    for name in (*others, *observers, *points, path):
        file = package / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch()
    (package / path).write_text(text, encoding="utf-8")
    return [line for rule in RULES for line in rule(package)]


def test_importing_the_package_loads_nothing_heavy_that_may_wait():
    wait = {"numba", "anywidget", "ipywidgets", "pooch", "pandas"}
    program = f"import sys, percept_obs; print(*sorted({wait} & set(sys.modules)))"
    loaded = subprocess.check_output([sys.executable, "-c", program], text=True)
    assert loaded.split() == []
