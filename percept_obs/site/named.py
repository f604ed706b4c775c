"""Substitutions in texts of the site: links to notebooks and equations, and numbers of the package.

A text writes ``{{ nb["02"] }}``, ``{{ MA2005["(11)"] }}`` or ``{{ longest_step }}``, and MyST substitutes these.
"""

from collections.abc import Iterable
from typing import Any

from percept_obs.compile.integrator import LARGEST_STEP_RATE, LONGEST_STEP, PLANT_STEP
from percept_obs.labs.observer.settings import SCHEMA as OF_A_POINT
from percept_obs.labs.points.settings import SCHEMA as OF_POINTS
from percept_obs.labs.points.texts import MOST_POINTS
from percept_obs.labs.shared.surfaces import MOST_NUMBERS
from percept_obs.labs.structure.settings import SCHEMA as OF_STRUCTURE
from percept_obs.papers import NAMED
from percept_obs.recording.path import RELATIVE_ERROR
from percept_obs.site.pages import ledger_addresses, slug
from percept_obs.tracking.verdict import TOLERANCE

EXAM = {
    True: "[Questions with their solutions](exam.md), each computed by code that runs as it stands.",
    False: "Questions with their solutions stand on the site for teachers: `percept-obs site --for teachers DIR`.",
}
"""Words for the exam, by whether the site has it."""


def named(notebooks: Iterable[str], exam: bool = True) -> dict[str, Any]:
    """Return substitutions by their keys; the exam has no link where it is not on the site.

    >>> found = named(["02_two_observers.ipynb"])
    >>> found["nb"]["02"], found["MA2005"]["(11)"]
    ('[02](/notebooks/02_two_observers.ipynb)', '[(11)](/ledger/ma2005/11.md)')
    """
    return {
        "nb": {name[:2]: f"[{name[:2]}](/notebooks/{name})" for name in notebooks},
        **{
            name: {p: f"[{p}](/ledger/{slug(name)}/{page}.md)" for p, page in ledger_addresses(ledger).items()}
            for name, ledger in NAMED.items()
        },
        "exam": EXAM[exam],
        "longest_step": f"{LONGEST_STEP:g} s",
        "plant_step": f"{PLANT_STEP:g} s",
        "largest_step_rate": f"{LARGEST_STEP_RATE:g}",
        "relative_error": f"{RELATIVE_ERROR:g}",
        "tolerance": f"{TOLERANCE:.0%}".replace("%", " %"),
        "most_numbers": MOST_NUMBERS,
        "structure_step": f"{OF_STRUCTURE.opening['step']:g} s",
        "points_step": f"{OF_POINTS.opening['step']:g} s",
        "most_points": MOST_POINTS,
        "duration": f"{OF_A_POINT['duration'].expected} s",
    }
