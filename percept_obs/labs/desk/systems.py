"""Systems of the desk: of a motion and a surface, or from a student's name."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.compile import Array, definitions, in_letters, vectorised
from percept_obs.exercises.individual import same_name
from percept_obs.labs.shared.surfaces import SURFACES
from percept_obs.observers import Observer, de_luca, identifier_based, spica
from percept_obs.system.motion import Motion, affine, rigid
from percept_obs.system.perspective import PerspectiveSystem

MOTIONS = {make.__name__: make for make in (affine, rigid)}
OBSERVERS = {make.key: make for make in (identifier_based, de_luca, spica)}
"""Observers whose equations can be typed in a line: those without a covariance and without branches."""

INVERSE = 0.4
"""Inverse distance at which the desk opens, in 1/m."""


@lru_cache
def system_of(motion: str, surface: str) -> PerspectiveSystem:
    """Return a motion in letters, seen on a surface."""
    return PerspectiveSystem(MOTIONS[motion](), SURFACES[surface]())


@lru_cache
def observer_of(system: PerspectiveSystem, outputs: tuple[str, ...], name: str) -> Observer:
    """Return an observer of a system without terms whose gains are 0, which no sheet explains.

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
    """Draws choices one after another from the digits of one large number."""

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


ROUNDS, DRAWS, SIDE = 8, 1000, np.linspace(-0.9, 0.9, 7)
"""Number of rounds of drawing, of systems in a round, and image coordinates at which their motions are compared."""


@lru_cache(maxsize=64)
def numbers_of(system: PerspectiveSystem) -> dict[sp.Symbol, float]:
    """Return numbers for a system's letters with which each right term brings the drawn motion nearer to the true one.

    With a wrong sign the term takes it further away.  Of many draws the one is taken in which the
    term that helps least helps most, in any order of the terms multiplied out; if there is no such draw, in the order
    of the formula as it is printed.
    """
    letters = list(system.parameters)
    gain = _gain_of(system, letters)
    draw, best = np.random.default_rng(0), np.zeros(len(letters))
    for k in range(ROUNDS):
        size = draw.uniform(0.2, 1, (DRAWS, len(letters))) * draw.choice([-1, 1], (DRAWS, len(letters)))
        drawn = np.where(draw.random(size.shape) < 0.2, size, best + 0.2 * size) if k else size
        drawn[1:] = np.round(np.sign(drawn[1:]) * np.clip(np.abs(drawn[1:]), 0.1, 1.2), 2)
        drawn[0] = best
        for column, letter in enumerate(letters):
            drawn[:, column] = system.values.get(letter, drawn[:, column])
        best = drawn[np.argmax(gain(drawn))]
    return dict(zip(letters, best.tolist(), strict=True))


def _gain_of(system: PerspectiveSystem, letters: list[sp.Symbol]) -> Callable[[Array], Array]:
    """Return a function of draws: how much nearer the least helpful term brings the motion, plus 1 if in any order."""
    names = [f"{s.name}'" for s in system.surface.image_coordinates]
    derived = [step.values[name] for step in system.derivation() for name in names if name in step.values]
    rates = [in_letters(rate) for rate in derived]
    apart = [_sizes(sp.Add.make_args(sp.expand(rate)), system, letters) for rate in rates[: len(names)]]
    printed = [_sizes(rate.as_ordered_terms(), system, letters) for rate in rates]

    @np.errstate(all="ignore")
    def gain(drawn: Array) -> Array:
        free = np.min([_least(sizes(drawn), ordered=False) for sizes in apart], axis=0)
        return np.where(free > 0, 1 + free, np.min([_least(sizes(drawn), ordered=True) for sizes in printed], axis=0))

    return gain


def _sizes(terms: Sequence[sp.Expr], system: PerspectiveSystem, letters: list[sp.Symbol]) -> Callable[[Array], Array]:
    """Return a function of draws: of each term in each draw its values over the image."""
    known = definitions(system.rate)
    y1, y2 = (c.ravel() for c in np.meshgrid(SIDE, SIDE))
    place = [y1, y2, np.full(y1.size, INVERSE)]
    values = vectorised([*letters, *system.coordinates], [term.subs(known) for term in terms])
    return lambda drawn: np.array(values(*(column[:, None] for column in drawn.T), *place))


def _least(sizes: Array, ordered: bool) -> Array:
    """Return for each draw how much the least helpful term lowers the squared error, as a share of all; or -1."""
    products = np.einsum("kdp,jdp->dkj", sizes, sizes)
    against = np.triu(products, 1) if ordered else np.minimum(products - products * np.eye(len(sizes)), 0)
    gained = np.einsum("dkk->dk", products) + 2 * against.sum(axis=2)
    part = gained.min(axis=1) / (sizes.sum(axis=0) ** 2).sum(axis=1)
    return np.asarray(np.nan_to_num(part, nan=-1, posinf=-1, neginf=-1))
