"""What of a lab is looked at: the open group of its drawer, its charts, the chosen observer, the part of the time."""

from __future__ import annotations

from collections.abc import Sequence

from percept_obs.labs.shared.schema import Choice, Flag, Names, Number, Optional, Row, Schema, Settings, Text

_TIME = Number(low=-1e6, high=1e6, unit="s")
ALL_FOLDED = "folded"
EVERY_LAB_HAS = ("charts", "words", "equations", "symbols")
"""Groups of every drawer, after those of the lab itself."""


def view_of(groups: Sequence[str], charts: Sequence[str]) -> Schema:
    """Return what can be looked at in a lab whose drawer has groups of its own, and which has these charts."""
    open_one = (*groups, *EVERY_LAB_HAS, ALL_FOLDED)
    return Schema(
        more=Choice(
            "", ("", *open_one), about=f"the open group of the drawer, of {', '.join(open_one)}; or closed, ''"
        ),
        charts=Names([], tuple(charts), 0, about=f"charts below the first one, of {', '.join(charts)}"),
        chosen=Text("", 100, about="the observer that arrows and sentence are about; empty for the first one"),
        side=Flag(about="whether the map is turned to the side"),
        sight=Optional(Row([_TIME, _TIME]), about="None, or the part of the time that is shown, from when to when"),
    )


def read_view(looks: Schema, view: Settings) -> Settings:
    """Complete what is looked at, or a ValueError that says what is wrong."""
    whole = looks.read(view, looks.opening)
    if whole.get("sight") and not whole["sight"][0] < whole["sight"][1]:
        raise ValueError(f"sight is {whole['sight']}; give two times in seconds, the earlier one first")
    return whole
