"""The exercises of a notebook: their solutions, and trials that show what passes and what does not."""

import ast
import json
from itertools import chain

from places import NOTEBOOKS

from percept_obs.exercises import stub

VERDICT = "Out[max(Out)].right"


FAILING = """
import asyncio, warnings
import ipywidgets as widgets

def fails(name):
    def callback(*_, **__):
        raise ArithmeticError(name)
    return callback

slider, button, later = widgets.IntSlider(), widgets.Button(), widgets.Checkbox()
slider.observe(fails("observed"), "value")
button.on_click(fails("clicked"))

interactive = widgets.interactive(lambda x: fails("interactive")(), x=(0.0, 1.0))

later.observe(lambda _: asyncio.get_running_loop().call_later(0.01, fails("put off")), "value")

warns = widgets.Dropdown(options=["a", "b"])
warns.observe(lambda _: warnings.warn("a warning"), "value")

swallows, words = widgets.ToggleButton(), widgets.HTML()
def swallow(_):
    words.add_class("percept-obs-error")
    words.value = "shown to the student only"
swallows.observe(swallow, "value")

unknown = widgets.ColorPicker()
"""


def read(name):
    """A notebook as its file has it."""
    return json.loads((NOTEBOOKS / name).read_text(encoding="utf-8"))


def code(notebook):
    return ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]


def asked(notebook):
    """The modules for which the first cell of code asks."""
    calls = [node for node in ast.walk(ast.parse(code(notebook)[0])) if isinstance(node, ast.Call)]
    return [each.value for call in calls if getattr(call.func, "id", "") == "needs" for each in call.args]


def tagged(notebook, tag, kind):
    """The numbers of the cells of a kind that have a tag."""
    cells = enumerate(notebook["cells"])
    return [k for k, cell in cells if cell["cell_type"] == kind and tag in cell["metadata"].get("tags", ())]


def source(notebook, k):
    return "".join(notebook["cells"][k]["source"])


def answer_name(solution):
    """The name that a solution gives to its answer."""
    return stub(solution).split(" ")[0]


def trials(notebook, mistakes):
    """What is run after the check of each exercise: the solution passes, its stub and each mistake do not.

    In a students' copy only the stubs differ, and nothing but the check, the next cell, reads an answer; so what runs
    here with a stub is what runs there.
    """
    programs = {}
    for k in tagged(notebook, "solution", "code"):
        solution, check = source(notebook, k), source(notebook, k + 1)
        name = answer_name(solution)
        wrong = [stub(solution), *(f"{name} = {mistake!r}" for mistake in mistakes[notebook["cells"][k]["id"]])]
        refused = ((program, check, f"assert {VERDICT} is not True, {program!r}") for program in wrong)
        programs[k + 1] = [f"assert {VERDICT} is True, {name!r}", *chain.from_iterable(refused), solution]
    return programs


def names_read(program):
    """The names that a program reads."""
    return {n.id for n in ast.walk(ast.parse(program)) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)}
