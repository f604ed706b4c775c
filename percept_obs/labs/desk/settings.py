"""Settings of the desk, and the choices that the page shows."""

from typing import Any

from percept_obs.labs.desk.answers import HINTS
from percept_obs.labs.desk.sheets import PARTS
from percept_obs.labs.desk.systems import INVERSE, MOTIONS, OBSERVERS
from percept_obs.labs.shared.schema import Choice, Entries, Names, Number, Row, Schema, Text
from percept_obs.labs.shared.surfaces import SURFACES

MOST_LINES, LONGEST_LINE = 200, 2000
_PLACE: dict[str, Any] = {"low": -1, "high": 1, "usual": (-1, 1), "step": 0.01}

SCHEMA = Schema(
    student=Text(most=60, label="Name or number", about="whose system it is; empty for the one chosen"),
    motion=Choice("affine", tuple(MOTIONS)),
    surface=Choice("pinhole", tuple(SURFACES)),
    outputs=Names(["y1", "y2"], ("y1", "y2", "y3"), label="Measured"),
    observer=Choice("identifier_based", tuple(OBSERVERS)),
    part=Choice("rate", tuple(PARTS), label="Derive", about=f"what is derived: {', '.join(PARTS)}"),
    step=Number(1, 1, 20, whole=True, about="the step that is shown, counted from 1"),
    typed=Entries(Text(most=LONGEST_LINE), MOST_LINES, about='what is typed, by part, step and line, "rate 5 y1\'"'),
    hints=Entries(
        Number(0, 0, len(HINTS), whole=True), MOST_LINES, about='how many hints are open, by part and step, "rate 5"'
    ),
    point=Row(
        [
            *(Number(value, label=label, **_PLACE) for label, value in (("y1", 0.4), ("y2", 0.3))),
            Number(INVERSE, 0.01, 100, (0.05, 2), label="inverse distance", unit="1/m"),
        ],
        about="where numbers are put in: y1, y2 and the inverse distance",
    ),
)

LOOKS = Schema(more=Choice("", ("", "choices"), about="whether the drawer is open: choices, or empty"))
"""Schema of the desk's view, which no answer depends on: its drawer, open or closed."""

EXAMPLE: dict[str, Any] = {
    "step": 6,
    "point": [-0.6, 0.6, INVERSE],
    "hints": {"rate 6": 2},
    "typed": {"rate 6 y1'": "a13 + (a11 - a33) y1 + a12 y2 - a31 y1^2 - a32 y1 y2 + (b1 + b3 y1) y3"},
}
"""Settings of a desk that is given none, where they differ: a line with a slip in its last term, which is marked."""
