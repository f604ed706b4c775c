"""Scenarios: a point in motion, seen on an imaging surface."""

from __future__ import annotations

import numpy as np

from percept_obs.recording import Scenario
from percept_obs.system.motion import affine
from percept_obs.system.surfaces import ImagingSurface, pinhole
from percept_obs.validation import checked

__all__ = ["drive", "ma2005_eq35", "ma2005_eq36", "planar"]

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
