"""What of a lab is looked at: the open group of its drawer, its charts, the chosen observer, the part of the time."""

from __future__ import annotations

from collections.abc import Sequence

from percept_obs.labs.shared.schema import Flag, Names, Number, Optional, Row, Schema, Text

_TIME = Number(low=-1e6, high=1e6, unit="s")

VIEW = Schema(
    more=Text("", 40, about="the group of the drawer that is open; empty while the drawer is closed"),
    charts=Names([], least=0, about="charts below the first one"),
    chosen=Text("", 100, about="the observer that arrows and sentence are about; empty for the first one"),
    side=Flag(about="whether the map is turned to the side"),
    sight=Optional(Row([_TIME, _TIME]), about="None, or the part of the time that is shown, from when to when"),
)
"""What a lab without charts looks at."""


def view_of(charts: Sequence[str]) -> Schema:
    """Return what can be looked at in a lab with these charts."""
    return Schema(
        VIEW | {"charts": Names([], tuple(charts), 0, about=f"charts below the first one, of {', '.join(charts)}")}
    )
