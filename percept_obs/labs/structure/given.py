"""What somebody brings to the structure lab: a choice of unknowns, its form, or a scenario."""

from __future__ import annotations

from percept_obs.labs.shared.brought import same_system
from percept_obs.labs.shared.schema import Settings
from percept_obs.labs.structure.settings import STANDARD
from percept_obs.labs.structure.texts import PHASES
from percept_obs.structure import StructureAndMotion, StructureScenario
from percept_obs.system.forms import PartitionedSystem

Given = StructureAndMotion | PartitionedSystem | StructureScenario
"""A choice, a form of one, or a scenario, which has one."""


def opening_of(given: Given) -> Settings:
    """The settings that a lab of it opens with.

    Raises
    ------
    ValueError
        If it is none of these, or the lab cannot have it.

    Examples
    --------
    >>> from percept_obs.structure import StructureAndMotion
    >>> opening_of(StructureAndMotion(("d_s", "v_p1"), zero=("v_p2",)))["unknown"]
    ['d_s', 'v_p1']
    """
    if isinstance(given, StructureScenario):
        return _of_choice(given.choice) | _of_scenario(given)
    choice = given.view if isinstance(given, PartitionedSystem) else given
    if not isinstance(choice, StructureAndMotion):
        raise ValueError(
            f"form is {given!r}; it must be a StructureAndMotion, its form, or a StructureScenario, for this lab is of "
            "a point with a scaled inverse depth; bring other forms to observer_lab or points_lab"
        )
    if isinstance(given, PartitionedSystem) and not same_system(given, choice.form):
        raise ValueError(f"the form is not that of its {choice.name}; bring StructureAndMotion(...).form as it is")
    return _of_choice(choice)


def _of_choice(choice: StructureAndMotion) -> Settings:
    """What is unknown, with the velocities that are known to be zero."""
    absent = {name: [f"{name}{axis}" in choice.zero for axis in (1, 2, 3)] for name in PHASES}
    stays = {
        setting: [0.0 if zero else value for zero, value in zip(absent[setting[:3]], STANDARD[setting], strict=True)]
        for setting in (f"{name}{part}" for name in PHASES for part in ("", "_swing"))
    }
    known = {} if choice.scale is None else {"scale": float(choice.scale)}
    return {"unknown": list(choice.unknown), "earlier": "d_s" in choice.earlier, **stays, **known}


def _of_scenario(scenario: StructureScenario) -> Settings:
    """Where its point begins and how it moves."""
    signal = scenario.motion.signal
    if scenario.surface.name != "pinhole":
        raise ValueError(f"the scenario is on the {scenario.surface.name}; this lab is on the pinhole")
    if signal is None or not signal.constant:
        raise ValueError(
            "the scenario's motion varies; bring its choice, and give what varies in expressions of time, such as "
            'motion="v_c1 = 0.3 cos(t)"'
        )
    numbers = scenario.motion.known(0.0)[0].tolist()
    X, Y, Z = map(float, scenario.position)
    return {
        **{"ybar": [X / Z, Y / Z, 1 / (scenario.scale * Z)], "scale": float(scenario.scale)},
        **{"w": numbers[:3], "v_c": numbers[3:6], "v_p": numbers[6:], "v_c_swing": [0.0] * 3, "v_p_swing": [0.0] * 3},
        "duration": float(scenario.duration),
    }
