"""Inputs of a user of the structure lab: a choice of unknowns, its form, a scenario, or velocities."""

from __future__ import annotations

import numpy as np

from percept_obs.compile.integrator import LONGEST_STEP
from percept_obs.labs.shared.samples import refuse_longer, refuse_unfit, times_of
from percept_obs.labs.shared.schema import Settings
from percept_obs.labs.shared.user_observers import same_system
from percept_obs.labs.structure.settings import LONGEST, STANDARD
from percept_obs.labs.structure.texts import PHASES
from percept_obs.structure import StructureAndMotion, StructureScenario
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.motion import Motion, rigid
from percept_obs.validation.arguments import described

Given = StructureAndMotion | PartitionedSystem | StructureScenario | Motion
"""A choice, a form of one, a scenario, which has one, or the velocities of camera and object."""


def opening_of(given: Given) -> tuple[Settings, Motion | None]:
    """Settings that a lab opens with, and its velocities in samples, if there are some.

    >>> opening_of(StructureAndMotion(("d_s", "v_p1"), zero=("v_p2",)))[0]["unknown"]
    ['d_s', 'v_p1']
    """
    if isinstance(given, StructureScenario):
        settings, samples = _of_motion(given.motion, given.duration)
        return _of_choice(given.choice) | settings | _of_scenario(given), samples
    if isinstance(given, Motion):
        return _of_motion(given)
    choice = given.view if isinstance(given, PartitionedSystem) else given
    if not isinstance(choice, StructureAndMotion):
        raise ValueError(
            f"form is {described(given)}; it must be a StructureAndMotion, its form, a StructureScenario, or a motion "
            "from rigid, for this lab is of a point with a scaled inverse depth; bring other forms to observer_lab or "
            "points_lab"
        )
    if isinstance(given, PartitionedSystem) and not same_system(given, choice.form):
        raise ValueError(f"the form is not that of its {choice.name}; bring StructureAndMotion(...).form as it is")
    return _of_choice(choice), None


def _of_choice(choice: StructureAndMotion) -> Settings:
    """Settings of a choice: the unknowns, and the velocities that are known to be zero."""
    absent = {name: [f"{name}{axis}" in choice.zero for axis in (1, 2, 3)] for name in PHASES}
    stays = {
        setting: [0.0 if zero else value for zero, value in zip(absent[setting[:3]], STANDARD[setting], strict=True)]
        for setting in (f"{name}{part}" for name in PHASES for part in ("", "_swing"))
    }
    known = {} if choice.scale is None else {"scale": float(choice.scale)}
    return {"unknown": list(choice.unknown), "earlier": "d_s" in choice.earlier, **stays, **known}


def _of_scenario(scenario: StructureScenario) -> Settings:
    """Settings of a scenario's point and duration."""
    if scenario.surface.name != "pinhole":
        raise ValueError(f"the scenario is on the {scenario.surface.name}; this lab is on the pinhole")
    X, Y, Z = map(float, scenario.position)
    return {
        **{"ybar": [X / Z, Y / Z, 1 / (scenario.scale * Z)], "scale": float(scenario.scale)},
        "duration": float(scenario.duration),
    }


def _of_motion(motion: Motion, duration: float | None = None) -> tuple[Settings, Motion | None]:
    """The numbers of constant velocities; of others their samples, for as long as they last."""
    if samples := sampled(motion, duration):
        return {"velocities": "samples", "duration": min(float(times_of(samples)[-1]), LONGEST)}, samples
    w_c, v_c, v_p = motion.known(0.0).reshape(3, 3).tolist()
    return {"w_c": w_c, "v_c": v_c, "v_p": v_p, "v_c_swing": [0.0] * 3, "v_p_swing": [0.0] * 3}, None


def sampled(motion: Motion, duration: float | None = None) -> Motion | None:
    """The samples of velocities that vary, every 10 ms of a duration if they are functions; None of constant ones.

    >>> sampled(rigid(camera_velocity=[0.1, 0, 0])) is None
    True
    >>> sampled(rigid(camera_velocity=[[0.1, 0, 0], [0.3, 0, 0]], times=[0, 2])).known(1)[0, 3].item()
    0.2
    """
    signal = motion.signal
    if motion.parameters != rigid().parameters or signal is None:
        raise ValueError(
            f"the velocities are a motion {motion.name!r} of {', '.join(map(str, motion.parameters)) or 'no letters'}, "
            f"{'without' if signal is None else 'with'} numbers; bring rigid(...) with numbers for all"
        )
    if callable(signal.samples):
        if duration is None:
            raise ValueError(
                "the velocities are functions of time, and nothing says how long they last; bring samples, "
                "rigid(..., times=times), or a StructureScenario, which has a duration"
            )
        times = np.linspace(0, duration, int(np.ceil(duration / LONGEST_STEP)) + 1)
        w_c, v_c, v_p = np.split(motion.known(times), 3, axis=1)
        motion = rigid(camera_angular_velocity=w_c, camera_velocity=v_c, point_velocity=v_p, times=times)
    elif signal.times is None:
        return None
    refuse_unfit(motion)
    return motion


def zero_in(motion: Motion) -> list[str]:
    """Names of the velocities that are 0 in all samples."""
    columns = motion.known(times_of(motion)).T
    return [symbol.name for symbol, column in zip(motion.parameters, columns, strict=True) if not column.any()]


def refuse_samples(motion: Motion, settings: Settings) -> None:
    """Refuse settings that do not go with velocities in samples."""
    if settings["motion"].strip():
        raise ValueError(
            f"motion is {settings['motion']!r}, but the velocities are those of your samples; leave it empty, or take "
            'velocities="set"'
        )
    refuse_longer(motion, settings["duration"])
