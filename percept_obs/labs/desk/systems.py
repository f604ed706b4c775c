"""Systems of the desk: of a motion and a surface, or from a student's name."""

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import sympy as sp

from percept_obs.exercises.individual import same_name
from percept_obs.labs.shared.surfaces import SURFACES
from percept_obs.observers import Observer, de_luca, identifier_based, spica
from percept_obs.system.motion import Motion, affine, rigid
from percept_obs.system.perspective import PerspectiveSystem

MOTIONS = {make.__name__: make for make in (affine, rigid)}
OBSERVERS = {make.key: make for make in (identifier_based, de_luca, spica)}
"""Observers whose equations can be typed in a line: those without a covariance and without branches."""


@lru_cache
def system_of(motion: str, surface: str) -> PerspectiveSystem:
    """Return a motion in letters, seen on a surface."""
    return PerspectiveSystem(MOTIONS[motion](), SURFACES[surface]())


@lru_cache
def observer_of(system: PerspectiveSystem, outputs: tuple[str, ...], name: str) -> Observer:
    """Return an observer of a system, without terms whose gains are 0, for nothing that is given tells of these.

    A ValueError says if there is none for these measured outputs.
    """
    made = OBSERVERS[name](system.measure(*outputs))
    off = {gain: sp.S.Zero for gain, value in made.gain_values.items() if value == 0}
    return replace(made, equations=made.equations.xreplace(off))


@lru_cache
def system_of_student(student: str) -> tuple[PerspectiveSystem, tuple[str, ...]]:
    """Return the system that follows from a student's name or number, and its measured outputs.

    The same name gives the same system on every machine; capitals and spaces around it do not matter.  Some letters of
    the motion are zero, so that neighbours have different and shorter formulas; b3 never is, for without it the
    distance would drop out of a moving image.
    """
    drawn = _Draw(int.from_bytes(hashlib.sha256(same_name(student).encode()).digest(), "big"))
    surface = drawn.one_of(("pinhole", "chained"))  # the others are long by hand
    system = PerspectiveSystem(
        _affine(drawn) if drawn.one_of([True, True, False]) else _rigid(drawn), SURFACES[surface]()
    )
    return system, drawn.one_of(system.output_choices)


class _Draw:
    """Choices from one large number."""

    def __init__(self, number: int) -> None:
        self.number = number

    def one_of(self, choices: Sequence[Any]) -> Any:
        self.number, which = divmod(self.number, len(choices))
        return choices[which]


def _affine(drawn: _Draw) -> Motion:
    A, b = sp.Matrix(affine().A), sp.Matrix(affine().b)
    for row in range(3):
        A[row, drawn.one_of(range(3))] = 0
    left_out = drawn.one_of([None, 0, 1])
    if left_out is not None:
        b[left_out] = 0
    return affine(A, b)


def _rigid(drawn: _Draw) -> Motion:
    parameters = rigid().parameters
    turning, camera, point = (sp.Matrix(parameters[k : k + 3]) for k in (0, 3, 6))
    turning[drawn.one_of(range(3))] = 0
    moving, resting = drawn.one_of([(camera, point), (point, camera)])
    resting[:, 0] = sp.zeros(3, 1)
    left_out = drawn.one_of([None, 0, 1])
    if left_out is not None:
        moving[left_out] = 0
    return rigid(camera_angular_velocity=turning, camera_velocity=camera, point_velocity=point)


def number_of(symbol: sp.Symbol, system: PerspectiveSystem) -> float:
    """Return the number of a letter: the system's, or one that follows from the letter's name."""
    if symbol in system.values:
        return system.values[symbol]
    drawn = int.from_bytes(hashlib.sha256(symbol.name.encode()).digest()[:4], "big") / 2**32
    return round((0.3 + 0.7 * (2 * drawn % 1)) * (1 if drawn < 0.5 else -1), 2)
