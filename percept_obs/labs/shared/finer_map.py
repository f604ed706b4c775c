"""A finer map over two settings than the page fills: Python computes its places, part by part, as the page asks."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from time import monotonic
from typing import Any

import numpy as np
import traitlets

from percept_obs.compile import Array, Language
from percept_obs.labs.shared.lab import Lab
from percept_obs.labs.shared.schema import Choice, Group, Names, Number, Optional, Schema, Settings, Several, Whole
from percept_obs.tracking.following import StepTooLong
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import TOLERANCE
from percept_obs.validation import TooMuchWork, needed

NOT_YET, FOLLOWED, DIVERGED, IMPOSSIBLE = range(4)
"""What became of a run, by the numbers that the page has for it (front/src/common/model/cells.js)."""

MOST_PLACES = 1024
"""Places of a map that a page may ask for at once."""

AT_A_TIME = 0.25
"""Seconds after which an answer has what is done so far, so that the kernel hears what else the page says."""


class MapLab(Lab):
    """A lab whose page has a map over two settings, and asks Python for a finer one.

    The page sends the settings, the names of the numbers that differ from place to place, and these numbers, a row for
    each of some places; None stands for a place without a run.  Python answers with three numbers for each of the first
    of them: what became of the run, its settling time in s, and its relative error at the end.  What Python has not
    done the page asks for anew, unless its hand has moved on.
    """

    map_asked = traitlets.Dict(help="Places of a finer map that the page asks for.").tag(sync=True)
    map_found = traitlets.Dict(help="What became of the first of them, or why there is nothing.").tag(sync=True)
    from_the_page = (*Lab.from_the_page, "map_asked")

    def runs(self, settings: Settings, language: Language = "python") -> dict[str, Run]:
        """Runs that settings stand for, by the observers' names."""
        raise NotImplementedError

    def too_much(self, settings: Settings) -> str:
        """Why Python does not follow runs of these settings; empty if it does."""
        raise NotImplementedError

    def side_by_side(self, settings: Settings, varied: Mapping[str, Array]) -> Array | None:
        """What becomes of runs that differ in some numbers, shape (L, 3); NOT_YET where a run by itself tells.

        Nothing, where such runs do not go side by side.
        """
        return None

    @traitlets.observe("map_asked")
    def _answer_map(self, change: Mapping[str, Any]) -> None:
        asked = change["new"]
        if not asked:  # the page asks for nothing any more
            self.map_found = {}
            return
        serial = asked.get("serial")
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", StepTooLong)  # the page says so
                self.map_found = {"serial": serial, "values": self._filled(asked).tobytes()}
        except (ValueError, ModuleNotFoundError) as error:
            self.map_found = {"serial": serial, "refusal": str(error)}

    def _filled(self, asked: Settings) -> Array:
        """What becomes of the runs at the first of the places that are asked for, at least one, shape (L, 3).

        Raises
        ------
        ValueError
            If a message makes no sense, or a run takes too much work.
        ModuleNotFoundError
            If numba is not installed.
        """
        needed("fast", "numba")
        settings, names, rows = self._read_map(asked)
        there = {k: row for k, row in enumerate(rows) if row is not None}
        found = np.tile([float(IMPOSSIBLE), np.inf, np.nan], (len(rows), 1))
        if not there:
            return found
        columns = np.array([*there.values()]).T
        for name, column in zip(names, columns, strict=True):
            for end in (column.min(), column.max()):  # what lies between is allowed as well
                self.check(_with(settings, [name], [float(end)]))
        together = self.side_by_side(settings, dict(zip(names, columns, strict=True)))
        found[[*there]] = np.full((len(there), 3), NOT_YET) if together is None else together
        until = monotonic() + AT_A_TIME
        for k, row in there.items():
            if found[k, 0] == NOT_YET:
                if k > min(there) and monotonic() > until:
                    return found[:k]
                found[k] = self._at_a_place(_with(settings, names, row))
        return found

    def _read_map(self, asked: Settings) -> tuple[Settings, list[str], list[Sequence[float] | None]]:
        over = self.schema["over"]
        across = over.of["across"] if isinstance(over, Group) else None
        known = across.names if isinstance(across, Choice) else ()
        places = [name for name in known if name.partition(".")[0] in self.schema]
        told = Schema(
            serial=Number(whole=True, low=0, high=2**53),
            settings=Whole(),
            names=Names(names=places),
            rows=Several(of=Optional(Several(of=Number(low=-1e300, high=1e300), most=len(places))), most=MOST_PLACES),
        ).read(asked, dict.fromkeys(("serial", "settings", "names", "rows")))
        names, rows = told["names"], told["rows"]
        settings = self.check(told["settings"])
        if len(settings["observers"]) != 1:
            raise ValueError(f"a map is of one observer, and not of {', '.join(settings['observers'])}")
        if refusal := self.too_much(settings):
            raise ValueError(refusal)
        if none := [name for name in names if settings[name.partition(".")[0]] is None]:
            raise ValueError(f"{none[0]} cannot differ from place to place in these settings; choose another axis")
        if strange := [row for row in rows if row is not None and len(row) != len(names)]:
            raise ValueError(f"a row of the map has {len(strange[0])} numbers; it must have one for each of {names}")
        return settings, names, rows

    def _at_a_place(self, settings: Settings) -> tuple[float, float, float]:
        try:
            (run,) = self.runs(settings, "numba").values()
            if run.diverged_at is not None:
                return DIVERGED, np.inf, np.nan
            settled = run.outcome(settings.get("tolerance", TOLERANCE)).settled
        except TooMuchWork:
            raise
        except ValueError:  # there is no such run: the point is not in front of the camera, nothing is known of it
            return IMPOSSIBLE, np.inf, np.nan
        return FOLLOWED, settled, float(run.relative_error[-1])


def _with(settings: Settings, names: Sequence[str], row: Sequence[float]) -> Settings:
    """Settings with other numbers at places such as "b.0"."""
    changed = settings
    for name, value in zip(names, row, strict=True):
        part = changed = changed.copy()
        *groups, last = name.split(".")
        for group in groups:
            part[group] = inside = part[group].copy()
            part = inside
        part[last if isinstance(part, dict) else int(last)] = value
    return changed
