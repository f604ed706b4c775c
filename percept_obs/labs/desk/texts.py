"""What the page needs before Python answers: which choices there are, and how they are called."""

from percept_obs.labs.desk.sheets import PARTS
from percept_obs.labs.desk.systems import MOTIONS, OBSERVERS, system_of
from percept_obs.labs.shared.printed import Parts
from percept_obs.labs.shared.surfaces import SURFACES


def texts_for_the_page() -> Parts:
    """Everything that the desk offers."""
    yield (
        "",
        {
            "surfaces": {name: system_of("affine", name).output_choices for name in SURFACES},
            "motions": list(MOTIONS),
            "observers": {name: make.name for name, make in OBSERVERS.items()},
            "parts": PARTS,
        },
    )
