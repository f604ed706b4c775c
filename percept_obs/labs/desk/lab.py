"""The derivation desk: a derivation filled in line by line, and checked while it is typed."""

from __future__ import annotations

import re
from os import PathLike
from typing import Any

import traitlets

from percept_obs.labs.desk.answers import answer_to
from percept_obs.labs.desk.settings import EXAMPLE, LOOKS, SCHEMA
from percept_obs.labs.desk.sheets import PARTS, Sheet, sheet_of
from percept_obs.labs.desk.systems import system_of, system_of_student
from percept_obs.labs.desk.texts import sheet_for_the_page, sheet_name
from percept_obs.labs.shared.lab import Lab
from percept_obs.labs.shared.printed import part
from percept_obs.labs.shared.schema import Settings, only
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.validation import checked


class DerivationDesk(Lab):
    """The desk at which a derivation is filled in; `settings` define everything, and may be set from Python as well.

    Formulas are read as `percept_obs.check` reads them, and compared with those that the package derives.

    Parameters
    ----------
    system : PerspectiveSystem, optional
        System of one's own, if it is none of those that can be chosen.
    **settings
        Settings to open with, such as ``student="Ada"``, from which a system of her own follows; without any it opens
        with an example, a line that holds a slip:

    {settings}

    See Also
    --------
    percept_obs.check : Checks a line without the desk.

    Examples
    --------
    >>> desk = derivation_desk(student="Ada")
    >>> desk.sheet().goal.lines[-1].name
    'y2'
    """

    schema = SCHEMA
    looks = LOOKS
    title = "The derivation desk"
    sheets = traitlets.Dict(help="Sheets of a system that the package does not print, by their names.").tag(sync=True)

    @checked
    def __init__(self, system: PerspectiveSystem | None = None, /, **settings: Any) -> None:
        self._given = system
        opening, given = SCHEMA.opening, None
        self.idle = dict.fromkeys(("motion", "surface", "outputs"), only("student", ""))
        if system is None and set(settings) <= set(self.looks):
            opening |= EXAMPLE
        if system is not None:
            self.idle = dict.fromkeys(("student", "motion", "surface"), lambda _: "a system is given")
            given = {"outputs": [list(names) for names in system.output_choices]}
            opening["outputs"] = given["outputs"][0]
        super().__init__("desk_lab", settings, opening, opening, given=given)
        for key in settings.get("typed", ()) if self.by_hand(settings) else ():
            part, number, line = key.split(" ", 2)
            steps = sheet_of(*self.system(), self.settings["observer"], part).derivation
            there = [name for step in steps[int(number) - 1 : int(number)] for name in step.values]
            if line not in there:
                raise ValueError(f"typed has {key!r}; this step has {', '.join(there) or 'no lines'}")
        self.analysis = self.analyse()

    def refuse(self, settings: Settings) -> None:
        """Raise a ValueError for settings that do not go together."""
        settings["outputs"].sort()
        for key in settings["typed"]:
            if not re.fullmatch(rf"({'|'.join(PARTS)}) [1-9]\d? \S.*", key):
                raise ValueError(f'typed has {key!r}; give the part, the step and the line, such as "rate 6 y1\'"')
        if strange := [key for key in settings["hints"] if not re.fullmatch(rf"({'|'.join(PARTS)}) [1-9]\d?", key)]:
            raise ValueError(f'hints has {strange[0]!r}; give the part and the step, such as "rate 6"')
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
        """Return the system of the settings, and its measured outputs."""
        settings = self.settings
        if self._given is not None:
            return self._given, tuple(settings["outputs"])
        if settings["student"].strip():
            return system_of_student(settings["student"])
        return system_of(settings["motion"], settings["surface"]), tuple(settings["outputs"])

    def sheet(self) -> Sheet:
        """Return the derivation to fill in.

        Raises
        ------
        ValueError
            If there is no such observer for these outputs.
        """
        return sheet_of(*self.system(), self.settings["observer"], self.settings["part"])

    def save(self, file: str | PathLike[str]) -> None:
        """Write the desk into a page of its own, which reads and judges lines by itself; see `Lab.save`."""
        for each in PARTS:
            self._print(each)
        super().save(file)

    def _print(self, part: str) -> None:
        """Print a sheet for the page, unless the package has."""
        settings = self.settings
        student = settings["student"].strip()
        if self._given is None and not student:
            return
        whose = "own" if self._given else f"student {student}"
        name = sheet_name(whose, settings["outputs"], settings["observer"], part)
        if name not in self.sheets:
            system, outputs = self.system()
            found = sheet_for_the_page(system, outputs, settings["observer"], part)
            self.sheets = {**self.sheets, name: {**found, "outputs": list(outputs)}}

    def analyse(self) -> Settings:
        """Return the answer to the lines of the step that is shown."""
        self._print(self.settings["part"])
        try:
            sheet = self.sheet()
        except ValueError as error:
            return {"problem": str(error)}
        return answer_to(sheet, self.settings)


derivation_desk = DerivationDesk
