"""Print what the page needs for all that the labs offer: ``python -m percept_obs.labs.printing``."""

import json
from collections.abc import Callable, Mapping
from types import MappingProxyType

from percept_obs.compile import integrator
from percept_obs.figures import look
from percept_obs.labs.desk import texts as desk
from percept_obs.labs.desk.lab import derivation_desk
from percept_obs.labs.observer import texts as observer
from percept_obs.labs.observer.lab import observer_lab
from percept_obs.labs.points import texts as points
from percept_obs.labs.points.lab import points_lab
from percept_obs.labs.shared.printed import FRONT, Parts, file_of, packed, unpacked
from percept_obs.labs.structure import texts as structure
from percept_obs.labs.structure.lab import structure_lab
from percept_obs.validation import write_whole

LABS: Mapping[str, Callable[[], Parts]] = MappingProxyType(
    {
        "observer_lab": observer.texts_for_the_page,
        "structure_lab": structure.texts_for_the_page,
        "points_lab": points.texts_for_the_page,
        "desk_lab": desk.texts_for_the_page,
    }
)
"""For each lab, what is printed for its page."""

INTEGRATOR = FRONT / "src/engine/integrator.js"
LOOKS = FRONT / "src/draw/looks.js"
"""The method of the loops and the marks of all pictures, in the page's sources, from which the bundle is built."""

MODELS = FRONT / "tests/models.json"
"""What Python hands to the labs as they open, for the tests of the page."""


def models() -> str:
    """Return as JSON the models that Python hands to the page when each lab opens."""
    labs = {"observer": observer_lab(), "points": points_lab(), "structure": structure_lab(), "desk": derivation_desk()}
    given = {
        name: {"model": {**lab.model, "written": lab.written}, "settings": lab.settings, "view": lab.view}
        for name, lab in labs.items()
    }
    return json.dumps(given, ensure_ascii=False) + "\n"


def changed(kind: str) -> list[str]:
    """Places at which the shipped file of a lab is not what this package prints."""
    file = file_of(kind)
    there = unpacked(file.read_bytes()) if file.exists() else {}
    now = {place: json.loads(json.dumps(texts)) for place, texts in LABS[kind]()}
    return [place for place in {**there, **now} if there.get(place) != now.get(place)]


def main() -> None:
    """Write the files of all labs, and integrator and marks for the page's sources where they are at hand."""
    if INTEGRATOR.parent.exists():
        write_whole(INTEGRATOR, integrator.for_the_page().encode())
        write_whole(LOOKS, look.for_the_page().encode())
        write_whole(MODELS, models().encode())
    for kind, print_texts in LABS.items():
        file = file_of(kind)
        write_whole(file, packed(print_texts()))
        print(f"{file}: {file.stat().st_size} bytes")


if __name__ == "__main__":
    main()
