"""The derivation desk: a derivation filled in line by line, and checked while it is typed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from percept_obs.labs.desk.marking import entry_of, hints_of, offered, review_of, state_of, summary_of
from percept_obs.labs.desk.settings import SCHEMA
from percept_obs.labs.desk.sheets import Sheet, sheet_of
from percept_obs.labs.desk.systems import system_of, system_of_student
from percept_obs.labs.desk.witness import witness_of
from percept_obs.labs.shared.lab import Lab
from percept_obs.labs.shared.markup import dotted, markup
from percept_obs.labs.shared.printed import part
from percept_obs.labs.shared.schema import Settings
from percept_obs.system.perspective import PerspectiveSystem


class DerivationDesk(Lab):
    """The desk at which a derivation is filled in; `settings` define everything, and may be set from Python as well.

    What is typed is read as `percept_obs.check` reads it, and compared with what the package derives.

    Parameters
    ----------
    system : PerspectiveSystem, optional
        What is derived, if it is none of those that can be chosen.
    **settings
        Those to open with, such as ``student="Ada"``, from which a system of her own follows:

    {settings}

    Examples
    --------
    >>> desk = derivation_desk(student="Ada")
    >>> desk.sheet().goal.lines[-1].name
    'y2'
    """

    schema = SCHEMA

    def __init__(self, system: PerspectiveSystem | None = None, /, **settings: Any) -> None:
        if system is not None and not isinstance(system, PerspectiveSystem):
            raise ValueError(
                f"the desk takes a PerspectiveSystem, not {system!r}; pass PerspectiveSystem(motion, surface), or "
                "settings by their names"
            )
        self._given = system
        opening = SCHEMA.opening
        if system is not None:
            opening["outputs"] = list(system.output_choices[0])
        super().__init__("desk_lab", settings, opening, opening, given=self._given_for_the_page())
        self.analysis = self.analyse()

    def _given_for_the_page(self) -> Settings | None:
        if self._given is None:
            return None
        return {"outputs": [list(names) for names in self._given.output_choices]}

    def refuse(self, settings: Settings) -> None:
        """Raise a ValueError for settings that do not go together."""
        settings["outputs"].sort()
        surface = settings["surface"]
        choices = self._given.output_choices if self._given else part("desk_lab")["surfaces"][surface]
        if settings["outputs"] not in [list(names) for names in choices]:
            told = " or ".join(" and ".join(names) for names in choices)
            seen = self._given.surface.name if self._given else surface
            raise ValueError(
                f"outputs are {settings['outputs']!r}; on the {seen} surface what is hidden can be separated if {told} "
                "is measured"
            )

    def system(self) -> tuple[PerspectiveSystem, tuple[str, ...]]:
        """The system that the settings stand for, and its measured outputs."""
        settings = self.settings
        if self._given is not None:
            return self._given, tuple(settings["outputs"])
        if settings["student"].strip():
            return system_of_student(settings["student"])
        return system_of(settings["motion"], settings["surface"]), tuple(settings["outputs"])

    def sheet(self) -> Sheet:
        """What is asked for.

        Raises
        ------
        ValueError
            If there is no such observer for these outputs.
        """
        return sheet_of(*self.system(), self.settings["observer"], self.settings["part"])

    def analyse(self) -> Settings:
        """The sheet, and what is found of the lines of the step that is shown."""
        settings = self.settings
        try:
            sheet = self.sheet()
        except ValueError as error:
            return {"problem": str(error)}
        system, outputs = self.system()
        steps = range(1, len(sheet.derivation) + 1)
        step = min(settings["step"], len(steps))
        keys = {f"{settings['part']} {k} {name}": (k, name) for k in steps for name in sheet.derivation[k - 1].values}
        texts = {row: text for row, key in enumerate(keys) if (text := settings["typed"].get(key, "")).strip()}
        review = review_of(sheet, step, texts)
        rows = sheet.rows(step)
        hints = int(settings["hints"].get(f"{settings['part']} {step}", 0))
        following, says = offered(review, hints)
        told = hints_of(review, hints)
        names = list(keys)
        return {
            "title": _title(system, outputs),
            "given": sheet.given,
            "letters": sheet.letters,
            "steps": [
                {"reason": sheet.derivation[k - 1].reason.rstrip(":"), **state_of(sheet, k, texts)} for k in steps
            ],
            "step": step,
            "lines": [
                {
                    "key": names[row],
                    "name": keys[names[row]][1],
                    "label": _label(keys[names[row]][1]),
                    **_line(sheet, row, texts, told),
                }
                for row in rows
            ],
            "words": summary_of(review, len(rows)),
            "right": review.right if review.lines else None,
            "hint": following,
            "says": says,
            "witness": witness_of(sheet, rows, texts, system, settings["point"]),
        }


derivation_desk = DerivationDesk


def _line(sheet: Sheet, row: int, texts: Mapping[int, str], told: Mapping[int, Settings]) -> Settings:
    """What is said of a line."""
    if row not in texts:
        return {"markup": "", "mark": "", "told": []}
    entry = entry_of(sheet, row, texts[row])
    if entry.reading is None:
        return {"markup": entry.markup, "mark": "", "told": [], "refusal": entry.refusal, "position": entry.position}
    return {"markup": entry.markup, **told[row]}


def _label(name: str) -> str:
    """The name of a line as MathML; empty for words."""
    stem = name.removesuffix("'")
    if " " in name:
        return ""
    return dotted(sp.Symbol(stem)) if stem != name else markup(sp.Symbol(name))


def _title(system: PerspectiveSystem, outputs: tuple[str, ...]) -> str:
    return f"{system.motion.name} motion on the {system.surface.name} surface, {' and '.join(outputs)} measured"
