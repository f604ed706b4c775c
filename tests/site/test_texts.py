"""What texts say holds: their examples run, and the files, notebooks, sections and equations that they name exist."""

import ast
import doctest
import importlib
import inspect
import json
import re
from enum import Enum
from functools import cached_property
from types import FunctionType

import pytest
from notebook_exercises import code as code_of
from places import NOTEBOOKS

from percept_obs import check
from percept_obs.observers.family import Family
from percept_obs.site import TEXTS
from percept_obs.site.named import named
from percept_obs.site.pages import MODULES, public

ROOT = NOTEBOOKS.parent
GUIDE = (TEXTS / "guide.md").read_text("utf-8")
ON_THE_SITE = {path.name: path.read_text("utf-8") for path in TEXTS.iterdir() if path.name.endswith(".md")}
READ = {"CONTRIBUTING.md": (ROOT / "CONTRIBUTING.md").read_text("utf-8"), **ON_THE_SITE}
SECTIONS = {
    path.name[:2]: {
        int(number)
        for cell in json.loads(path.read_bytes())["cells"]
        for number in re.findall(r"^## (\d+)\.", "".join(cell["source"]), re.MULTILINE)
    }
    for path in NOTEBOOKS.glob("*.ipynb")
}


@pytest.mark.slow
def test_the_exam_s_solutions_compute_what_they_say():
    exam = ON_THE_SITE["exam.md"]
    text = re.sub(r"^```.*$", "", exam, flags=re.MULTILINE)
    test = doctest.DocTestParser().get_doctest(text, {}, "exam", None, None)
    assert len(test.examples) > 20
    assert doctest.DocTestRunner().run(test).failed == 0
    questions = exam.split("<details>")[1:]
    assert all(">>> " in question for question in questions)


def ran(text):
    """Names that the lines of a text leave."""
    names = {}
    for block in re.findall(r"```python\n(.*?)```", ON_THE_SITE[text], re.DOTALL):
        exec(compile(block, f"<{text}>", "exec"), names)
    return names


@pytest.mark.slow
def test_the_lines_of_the_tour_run_and_give_what_they_say():
    names = ran("tour.md")
    assert names["review"].right is False
    assert "b3" in str(names["review"].hint(2))
    assert "10 %" in str(names["run"].verdict())
    assert check(names["from_mathpix"], names["system"]).right
    assert "the sign of b3 y3^2 is wrong" in str(check(names["from_a_chat"], names["system"]).hint(3))


@pytest.mark.slow
def test_an_observer_of_one_s_own_runs_as_its_page_says():
    names = ran("own_observer.md")
    seconds = [names[run].settling_time() for run in ("mine", "theirs")]
    assert "{:.2f} s here, the identifier-based observer {:.2f} s".format(*seconds) in ON_THE_SITE["own_observer.md"]


@pytest.mark.slow
def test_a_motion_of_one_s_own_runs_as_its_page_says(capsys):
    names = ran("own_motion.md")
    varies = [names[motion].constants is None for motion in ("steady", "swaying", "carried")]
    assert varies == [False, True, True]
    assert "converged" in capsys.readouterr().out
    assert 0 < names["least"][-1] < 0.1


def test_every_notebook_stands_in_the_lecture_map():
    lectures = GUIDE[GUIDE.index("| lecture |") : GUIDE.index("## Lesson plans")]
    assert set(SECTIONS) <= set(re.findall(r'nb\["(\d\d)"\]', lectures))


def test_the_sections_that_the_guide_names_exist():
    found = re.findall(r'nb\["(\d\d)"\] }}, sections? (\d+)(?: (and|to) (\d+))?', GUIDE)
    assert len(found) > 20
    for notebook, first, _, last in found:
        assert {int(first), int(last or first)} <= SECTIONS[notebook], (notebook, first, last)


def test_each_learning_goal_has_an_exercise_that_is_there():
    plans = GUIDE[GUIDE.index("## Lesson plans") : GUIDE.index("## What students")]
    goals = re.findall(r"^(?:- |\| \d \| ).*$", plans, re.MULTILINE)
    assert len(goals) == 3 + 4 + 8
    for goal in goals:
        ((notebook, number),) = re.findall(r'nb\["(\d\d)"\] }}, exercise (\d)', goal)
        assert f"**Exercise {number}:" in "".join(p.read_text("utf-8") for p in NOTEBOOKS.glob(f"{notebook}_*.ipynb"))


@pytest.mark.parametrize("minutes", [45, 90])
def test_a_lesson_fills_its_time(minutes):
    plan = GUIDE[GUIDE.index(f"### {minutes} minutes") :]
    plan = plan[: plan.index("*Learning goals.*")]
    spans = [(int(begin), int(end)) for begin, end in re.findall(r"^\| (\d+) to (\d+) \|", plan, re.MULTILINE)]
    assert [begin for begin, _ in spans] == [0, *(end for _, end in spans[:-1])]
    assert spans[-1][1] == minutes


@pytest.mark.parametrize("name", ON_THE_SITE)
def test_what_a_text_names_by_a_key_is_there(name):
    values = named([path.name for path in NOTEBOOKS.glob("*.ipynb")])
    for key, _, place in re.findall(r'{{ (\w+)(\["(.*?)"\])? }}', ON_THE_SITE[name]):
        assert key in values, f"nothing is called {key}"
        assert not place or values[key][place], f"{key} has no {place}"


@pytest.mark.parametrize("name", READ)
def test_the_files_that_a_text_names_exist(name):
    for quoted in re.findall(r"`([^`]*)`", READ[name]):
        for path in re.findall(r"(?<![\w/.-])[\w/.-]+\.(?:py|js|md|cff|toml)\b", quoted):
            if re.search(r"(^|/)(test_)?my_|/LAB/", path):
                continue  # the reader's own, or any lab's
            assert list(ROOT.glob(path)) or [
                f for f in (ROOT / "percept_obs").rglob(path) if "node_modules" not in f.parts
            ], f"there is no {path}"


EXAMPLES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts): count
    for path in sorted((ROOT / "percept_obs").rglob("*.py"))
    if (count := len(re.findall(r"^ *>>> (?!.*\+SKIP)", path.read_text("utf-8"), re.MULTILINE)))
}
"""Modules with examples, and how many lines of them."""


MEMBER = FunctionType | property | cached_property | classmethod | staticmethod
PUBLIC = {f"{module}.{names[0]}": value for module, values in public().items() for names, value in values}
"""Public functions and classes, by the name under which the reference shows them."""


def is_called(value):
    """True if an example that is run calls a function; of a class, which a function may make, if there is any."""
    members = [v for v in vars(value).values() if isinstance(v, MEMBER)] if inspect.isclass(value) else []
    texts = [each.__doc__ or "" for each in (value, *members)]
    examples = [each for text in texts for each in doctest.DocTestParser().get_examples(inspect.cleandoc(text))]
    names = "|".join(next(names for values in public().values() for names, each in values if each is value))
    called = "" if inspect.isclass(value) else rf"\b({names})\("
    return any(re.search(called, each.source) for each in examples if doctest.SKIP not in each.options)


def missing_sections(value):
    """Return the sections of numpydoc that the docstring of a public function or class lacks."""
    cls = inspect.isclass(value)
    if not callable(value) or isinstance(value, Family) or (cls and issubclass(value, Exception | Enum)):
        return set()
    text = inspect.getdoc(value) or ""
    body = inspect.unwrap(getattr(value, "__post_init__", value.__init__) if cls else value)
    written = isinstance(body, FunctionType) and body.__code__.co_filename != "<string>"  # as a dataclass's is not
    made = not (inspect.isabstract(value) or getattr(value, "_is_protocol", False))  # by its own name
    returned = "None" if cls else value.__annotations__.get("return", "None")
    needed = {
        "Parameters": made and bool(inspect.signature(value).parameters),
        "Returns": returned != "None" and not text.startswith("Return "),
        "Raises": made and written and bool(re.search(r"^ +raise ", inspect.getsource(body), re.MULTILINE)),
    }
    return {name for name, holds in needed.items() if holds and f"{name}\n-----" not in text}


def test_every_public_name_has_its_sections():
    lacking = {name: missing for name, value in PUBLIC.items() if (missing := missing_sections(value))}
    assert not lacking, lacking


def test_every_public_name_is_called_by_an_example():
    errors = {value for value in PUBLIC.values() if inspect.isclass(value) and issubclass(value, Exception | Enum)}
    called = {name: is_called(value) for name, value in PUBLIC.items() if callable(value) and value not in errors}
    assert len(called) > 200
    assert [name for name, is_so in called.items() if not is_so] == []


def test_every_function_that_a_notebook_imports_is_in_the_reference():
    codes = [code for path in NOTEBOOKS.glob("*.ipynb") for code in code_of(json.loads(path.read_bytes()))]
    statements = [node for code in codes for node in ast.walk(ast.parse(code)) if isinstance(node, ast.ImportFrom)]
    ours = [node for node in statements if node.module.startswith("percept_obs")]
    for node in (node for node in ours if ".papers." not in node.module):  # whose parts make ledgers only
        for name in (alias.name for alias in node.names):
            value = getattr(importlib.import_module(node.module), name)
            assert not callable(value) or any(value is each for each in PUBLIC.values()), name


def test_every_folder_s_public_names_are_in_the_reference():
    for path in (ROOT / "percept_obs").rglob("*.py"):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        if "\n__all__ = [" in path.read_text("utf-8") and name not in ("percept_obs.site",):
            assert name in MODULES, f"{name} has public names; put it into percept_obs/site/pages.py"


@pytest.mark.slow
def test_docstrings_begin_with_what_is_returned_or_done():
    paths = [path for path in (ROOT / "percept_obs").rglob("*.py") if "node_modules" not in path.parts]
    trees = [ast.parse(path.read_text("utf-8")) for path in paths]
    things = ast.Module | ast.ClassDef | ast.FunctionDef
    texts = [
        text
        for tree in trees
        for node in ast.walk(tree)
        if isinstance(node, things) and (text := ast.get_docstring(node))
    ]
    others = [text for text in texts if re.match(r"(What|How|Whether|The same|Of|As what)\b", text)]
    assert len(others) < 0.02 * len(texts), others


@pytest.mark.slow
@pytest.mark.parametrize("name", EXAMPLES)
def test_the_examples_of_the_docstrings_run(name, monkeypatch):
    module = importlib.import_module(name.removesuffix(".__init__"))
    families = {f.key: f.__doc__ for f in vars(module).values() if isinstance(f, Family) and f.__module__ == name}
    monkeypatch.setattr(module, "__test__", families, raising=False)  # doctest finds those of functions and classes
    found = doctest.testmod(module)
    skipped = getattr(found, "skipped", 0)  # from Python 3.13 on they are counted among the attempted
    assert found.attempted - skipped == EXAMPLES[name], "an example is not run"
    assert not found.failed
