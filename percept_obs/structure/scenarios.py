"""Chwa's set-ups, by name, each with its source."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from percept_obs.structure.corollaries import COROLLARIES
from percept_obs.structure.simulation import StructureScenario
from percept_obs.system.motion import rigid
from percept_obs.system.surfaces import pinhole
from percept_obs.validation import checked, numbers

_STILL = (0.0, 0.0, 0.0)

_CHWA_EXPERIMENT = {
    "IV.A": (1, (-0.22, -0.23, 0.0), _STILL),
    "IV.B": (2, (-0.44, -0.47, 0.0), (-0.22, -0.23, 0.0)),
    "V.B": (4, (-0.44, -0.23, 0.0), (-0.22, 0.0, 0.0)),
    "VI.B": (6, (-0.44, -0.47, 0.0), (-0.22, -0.23, 0.0)),
    "VI.C": (7, (-0.44, -0.23, 0.0), (-0.22, 0.0, 0.0)),
}
"""Section: corollary, velocities of the camera and of the object in m/s."""


@checked
def chwa2019_experiment(section: str) -> StructureScenario:
    """Return the scenario of the experiment, with the values that are stated for it (Chwa 2019, VII.B, pp. 12-14).

    It lasts 10 s, with d_s = 10.4 per metre.

    Parameters
    ----------
    section : str
        "IV.A", "IV.B", "V.B", "VI.B" or "VI.C".  In IV.B the camera and the object have other velocities than in IV.A,
        although they are two stages of one motion; the paper says nothing of it.

    Raises
    ------
    ValueError
        If there is no such case.

    See Also
    --------
    chwa2019_simulation, chwa2019_semigeneral

    Examples
    --------
    >>> from percept_obs.structure.scenarios import chwa2019_experiment
    >>> scene = chwa2019_experiment("IV.A")
    >>> scene.choice.theta, scene.coordinates([0, 5]).round(3).tolist()
    ((d_s, d_s*v_c2, d_s*v_c3), [[0.32, 0.3, 0.05, 10.4, -2.392, 0.0], [0.892, 0.898, 0.05, 10.4, -2.392, 0.0]])
    """
    number, camera, object_ = _stated(section, _CHWA_EXPERIMENT)
    name = f"Chwa 2019, experiment {section}"
    return _structure(name, (0.32, 0.30, 0.05), 10.4, number, (_STILL, camera, object_), "Chwa 2019, VII.B")


def _circling(time: float) -> list[float]:
    """Velocity in m/s of a camera that circles at up to 1 rad/s and moves away along its axis."""
    return [0.3 * math.cos(time), 0.3 * math.sin(0.8 * time), -0.3 - 0.1 * math.sin(time)]


def _approaching(time: float) -> list[float]:
    return [0.3 + 0.1 * math.sin(time), 0.3 + 0.1 * math.cos(time), 0.2 * math.sin(0.8 * time)]


def _turning_back(time: float) -> list[float]:
    return [0.3 * math.cos(time), 0.3 * math.sin(0.8 * time), -0.3 * math.sin(time + 1.0)]


def _wandering(components: int, time: float) -> list[float]:
    """Velocity in m/s of an object, varying at up to 1 rad/s in its first components."""
    whole = [0.2 * math.sin(0.7 * time), 0.2 * math.cos(time), 0.1 * math.sin(0.5 * time)]
    return [*whole[:components], *[0.0] * (3 - components)]


_CHWA_SIMULATION = {
    "IV.A": (1, (0.3, 0.2, -0.1), _STILL),
    "IV.B": (2, (0.3, 0.2, -0.1), partial(_wandering, 3)),
    "V.A": (3, _circling, partial(_wandering, 2)),
    "V.B": (4, _approaching, partial(_wandering, 1)),
    "VI.A": (5, _circling, partial(_wandering, 3)),
    "VI.B": (6, _circling, partial(_wandering, 2)),
    "VI.C": (7, _circling, partial(_wandering, 1)),
}


@checked
def chwa2019_simulation(section: str, chwa_rotation: Sequence[float] = _STILL) -> StructureScenario:
    """Return the scenario of the simulations (Chwa 2019, VII.A, pp. 9-11), with velocities of this package's choice.

    The paper states y(0) = (0.4, 0.4, 0.2) and d_s = 4, and no velocities.  Here they vary at up to 1 rad/s where they
    need not be constant, keep the point in view, and fulfil the case's observability condition at all times.  It lasts
    10 s.

    Parameters
    ----------
    section : str
        "IV.A", "IV.B", "V.A", "V.B", "VI.A", "VI.B" or "VI.C".
    chwa_rotation : three floats
        Chwa's w in rad/s, minus the camera's angular velocity; zero in the paper.  If it is not zero, the point starts
        on its axis, at w / w3 in the image, so that it stays in view; w3 must be positive then.

    Raises
    ------
    ValueError
        If there is no such case, or w has not three components or w3 is not positive.

    See Also
    --------
    chwa2019_experiment, chwa2019_crossing

    Examples
    --------
    >>> from percept_obs.structure.scenarios import chwa2019_simulation
    >>> chwa2019_simulation("IV.A").coordinates([0, 5])[:, :3].round(3).tolist()
    [[0.4, 0.4, 0.05], [0.091, 0.182, 0.045]]
    """
    number, camera, object_ = _stated(section, _CHWA_SIMULATION)
    w = numbers(chwa_rotation, "components of chwa_rotation", 3)
    image = (0.4, 0.4)
    if w.any():
        if not w[2] > 0:
            raise ValueError(f"the rotation w = {chwa_rotation} needs a positive third component, or to be zero")
        image = (w[0] / w[2], w[1] / w[2])
    name = f"Chwa 2019, simulation {section}" + (f", w = {tuple(w.tolist())}" if w.any() else "")
    source = "after Chwa 2019, VII.A; velocities chosen here"
    return _structure(name, (*image, 0.05), 4.0, number, (tuple(w.tolist()), camera, object_), source)


MOVES_AT = 5.0
"""Seconds after which the object moves; the paper does not state it."""


@checked
def chwa2019_semigeneral(set_up: str) -> StructureScenario:
    """Return the scenario of an object that stands still for 5 s and then moves (Chwa 2019, section IV).

    Both stages are one motion, and the choice is that of the second.

    Parameters
    ----------
    set_up : str
        "simulation": the camera keeps its velocity, and the object begins to wander.  "experiment": the values stated
        for IV.A and then those for IV.B, so that the camera changes its velocity when the object moves off.

    Raises
    ------
    ValueError
        If there is no such set-up.

    See Also
    --------
    percept_obs.semigeneral : Follows both stages.

    Examples
    --------
    >>> from percept_obs.structure.scenarios import chwa2019_semigeneral
    >>> motion = chwa2019_semigeneral("experiment").motion
    >>> motion.known([4.0, 6.0])[:, 6:].tolist()  # the object's velocity
    [[0.0, 0.0, 0.0], [-0.22, -0.23, 0.0]]
    """
    cases = {"simulation": _CHWA_SIMULATION, "experiment": _CHWA_EXPERIMENT}
    stages = [_stated(set_up, cases)[section] for section in ("IV.A", "IV.B")]
    still, moving = (chwa2019_simulation if set_up == "simulation" else chwa2019_experiment)("IV.A"), stages[1]
    camera, object_ = (partial(_in_stage, [stage[k] for stage in stages]) for k in (1, 2))
    motion = rigid(camera_velocity=camera, point_velocity=object_)
    name, choice = f"Chwa 2019, {set_up} IV", COROLLARIES[moving[0] - 1].choice()
    return replace(still, name=name, motion=motion, duration=2 * MOVES_AT, choice=choice)


def _in_stage(velocities: Sequence[Any], time: float) -> Any:
    velocity = velocities[time > MOVES_AT]
    return velocity(time - MOVES_AT) if callable(velocity) else velocity


@checked
def chwa2019_crossing() -> StructureScenario:
    """Return the scenario of corollary 3 with a camera that turns back along its axis, for 10 s.

    Its v_c3 crosses 0 at 2.1 s and every 3.1 s.

    See Also
    --------
    chwa2019_simulation : Velocities that keep the condition.

    Examples
    --------
    >>> from percept_obs.structure.scenarios import chwa2019_crossing
    >>> chwa2019_crossing().motion.known([2.0, 2.3])[:, 5].round(2).tolist()  # v_c3
    [-0.04, 0.05]
    """
    motion = (_STILL, _turning_back, partial(_wandering, 2))
    return _structure("crossing v_c3 = 0", (0.4, 0.4, 0.05), 4.0, 3, motion, "after Chwa 2019, VII.A")


def _stated(section: str, cases: dict[str, Any]) -> Any:
    """Case of a table; raise ValueError if there is none."""
    if section not in cases:
        raise ValueError(f"there is no case (section or set-up) {section!r}; there are {', '.join(cases)}")
    return cases[section]


def _structure(
    name: str, ybar: tuple[float, ...], scale: float, number: int, velocities: tuple[Any, ...], source: str
) -> StructureScenario:
    """Scenario of a point that starts at the given (y1, y2, ybar3), in the case of a corollary."""
    depth = 1 / (scale * ybar[2])
    position, choice = (ybar[0] * depth, ybar[1] * depth, depth), COROLLARIES[number - 1].choice()
    motion = rigid(chwa_rotation=velocities[0], camera_velocity=velocities[1], point_velocity=velocities[2])
    return StructureScenario(name, motion, position, 10.0, pinhole(), source, scale=scale, choice=choice)
