"""Scenarios: a point in motion, seen on an imaging surface."""

from __future__ import annotations

from itertools import accumulate

import numpy as np

from percept_obs.recording import Scenario
from percept_obs.recording.camera import Seed
from percept_obs.recording.imu import Imu
from percept_obs.recording.path import exponential
from percept_obs.recording.state_scenario import StateScenario
from percept_obs.system.bearings import bearings_only, own_ship
from percept_obs.system.inertial import camera_with_imu
from percept_obs.system.inertial import imu as imu_motion
from percept_obs.system.motion import affine
from percept_obs.system.surfaces import ImagingSurface, pinhole
from percept_obs.validation import checked

__all__ = ["drive", "held_phone", "ma2005_eq35", "ma2005_eq36", "own_ship_turns", "planar"]

_FIRST_ROWS = [[-0.2, 0.4, -0.6], [0.1, -0.2, 0.3]]
_TRANSLATION = [0.5, 0.25, 0.3]
_START = (1.0, 1.5, 2.5)


def drive() -> Scenario:
    """Return a standing point that a camera drives past, straight on, at 1.3 m/s, and passes 11 m ahead at first.

    See Also
    --------
    ma2005_eq35, ma2005_eq36, planar : The other scenarios.

    Examples
    --------
    >>> from percept_obs import scenarios
    >>> scenarios.drive().points([0, 4])[:, 2].round(1).tolist()
    [11.0, 5.9]
    """
    ahead = np.array([0.16, -0.04, 1.0])
    motion = affine(np.zeros((3, 3)), -1.3 * ahead / np.linalg.norm(ahead))
    return Scenario("drive past a point", motion, (-1.4, 0.8, 11.0), 4.0, pinhole(), "")


@checked
def ma2005_eq35(surface: ImagingSurface | None = None) -> Scenario:
    """Return a point that comes near the focus of expansion once, and stays excited (Ma 2005, (35), p. 70).

    Parameters
    ----------
    surface : ImagingSurface, optional
        The pinhole when left out.

    See Also
    --------
    ma2005_eq36, planar : The other scenarios.

    Examples
    --------
    >>> from percept_obs import scenarios
    >>> scenarios.ma2005_eq35().points([0, 40, 80])[:, 2].round(1).tolist()
    [2.5, 8.5, 11.0]
    """
    return _ma2005("35", [0.3, -0.4, 0.4], surface)


@checked
def ma2005_eq36(surface: ImagingSurface | None = None) -> Scenario:
    """Return a point that moves away without end (Ma 2005, (36), p. 71).

    Parameters
    ----------
    surface : ImagingSurface, optional
        The pinhole when left out.

    See Also
    --------
    ma2005_eq35, planar : The other scenarios.

    Examples
    --------
    >>> from percept_obs import scenarios
    >>> print([f"{Z:.0e}" for Z in scenarios.ma2005_eq36().points([0, 40, 80])[:, 2]])
    ['2e+00', '8e+02', '2e+06']
    """
    return _ma2005("36", [-0.4, 0.4, -0.4], surface)


def _ma2005(number: str, third_row: list[float], surface: ImagingSurface | None) -> Scenario:
    motion = affine([*_FIRST_ROWS, third_row], _TRANSLATION)
    return Scenario(f"Ma 2005 ({number})", motion, _START, 80.0, surface or pinhole(), f"Ma et al. 2005, ({number})")


@checked
def planar() -> Scenario:
    """Return a point that circles on a plane through the camera, seen on the line y2 = 0.5 (Ma 2005, Fig. 2, p. 65).

    The paper gives no numbers: here the point keeps Y = Z / 2 and circles around (1, 2, 4) in 15.7 s.

    See Also
    --------
    ma2005_eq35, ma2005_eq36 : The other scenarios.

    Examples
    --------
    >>> from percept_obs import record, scenarios
    >>> set(record(scenarios.planar()).outputs[:, 1].round(9).tolist())
    {0.5}
    """
    motion = affine([[0.0, 0.4, -0.6], [0.2, -0.2, 0.1], [0.4, -0.4, 0.2]], [1.6, -0.2, -0.4])
    return Scenario("planar motion", motion, (1.0, 1.25, 2.5), 40.0, pinhole(), "after Ma et al. 2005, Fig. 2")


def own_ship_turns() -> StateScenario:
    """Return a target whose bearing alone is seen from a ship that sails straight on for 10 s, and then turns for 4 s.

    The target passes at some 600 m with a constant velocity; the ship turns with 8 m/s^2.

    See Also
    --------
    held_phone : Another source of scale.

    Examples
    --------
    >>> from percept_obs import record, scenarios
    >>> record(scenarios.own_ship_turns(), 20).outputs[[0, -1], 0].round(2).tolist()
    [0.46, -0.01]
    """
    turn = [[0, 0], [0, 0], [8, 0], [8, 0], [0, 0], [0, 0]]
    motion = own_ship(turn, [0, 10, 10.5, 13.5, 14, 30])
    return StateScenario("own ship turns", bearings_only(), motion, (300.0, 600.0, -4.0, 8.0), 29.0)


@checked
def held_phone(imu: Imu | None = None, seed: Seed = 0, shake: float = 1.0, begin: float = 0.0) -> StateScenario:
    """Return a landmark 3 m ahead of a telephone that a hand shakes and turns for 12 s, with its IMU.

    Parameters
    ----------
    imu : Imu, optional
        Errors of the IMU; the usual ones when left out.
    seed : int or numpy Generator
        Of the IMU's errors.
    shake : float
        Largest acceleration in m/s^2 along each axis; with 0 the telephone keeps its speed.
    begin : float
        Seconds at constant speed before it.

    Raises
    ------
    ValueError
        If the shake is negative or not finite, or begins before 0 or after the end.

    See Also
    --------
    own_ship_turns : Another source of scale.

    Examples
    --------
    >>> from percept_obs import record, scenarios
    >>> recording = record(scenarios.held_phone(), 2)
    >>> (1 / recording.truth[[0, -1], -1]).round(2).tolist()
    [3.0, 2.72]
    """
    errors, duration = imu or Imu(), 12.0
    if not (0 <= shake < np.inf and 0 <= begin < duration):
        raise ValueError(f"the shake is {shake} from {begin} s on; it must be finite from 0 on, and begin within 12 s")
    times = np.arange(0, duration + 1, 0.005)
    rates, phases = np.array([2.0, 3.0, 2.5]), np.array([0.0, 1.0, 2.0])
    world = -shake * (times >= begin)[:, None] * np.sin(np.outer(times, rates) + phases)
    turning = np.array([0.3, 0.3, 0.2]) * np.sin(np.outer(times, [1.3, 1.7, 1.1]) + np.array([0.0, 1.0, 1.6]))
    between = (turning[1:] + turning[:-1]) / 2  # as the truth is integrated; the left end would accelerate by 7 mm/s^2
    rotations = accumulate(exponential(-0.005 * np.cross(between[:, None], np.eye(3))), np.matmul, initial=np.eye(3))
    gravity = np.array([0.0, 9.81, 0.0])
    felt = np.stack([rotation.T @ (each - gravity) for rotation, each in zip(rotations, world, strict=True)])
    known = imu_motion(turning, felt, times)
    measured, biases = errors.measured(known, duration, seed)
    speed = (begin == 0) * shake * np.cos(phases) / rates + np.array([0.15, 0.05, 0.0])
    state = (0.4, 0.2, 3.0, *speed, *gravity, *np.zeros(6))
    return StateScenario("held phone", camera_with_imu(), known, state, duration, measured, biases)
