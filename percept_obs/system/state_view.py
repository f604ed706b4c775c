"""Views that come from no imaging surface: coordinates of a state, of which some are measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array, vectorised
from percept_obs.system.forms import PartitionedSystem, partition
from percept_obs.system.motion import Motion
from percept_obs.system.view import OnePoint
from percept_obs.validation import checked, numbers

Symbols = tuple[sp.Symbol, ...]


@checked
@dataclass(frozen=True, eq=False)
class StateView(OnePoint):
    """Coordinates c = h(x) of a state x' = f(x) that is driven by known signals.

    The coordinates' rate is derived, c' = (dh/dx f)(x(c)), so that everything runs on it that runs on a form.

    Parameters
    ----------
    name : str
    state : tuple of symbols
        The state x.
    rate : tuple of expressions
        f, in x and the motion's parameters.
    motion : Motion
        Its parameters are the known signals.
    image : mapping of coordinates' symbols to expressions in x
        Those that can be measured.
    rest : mapping of coordinates' symbols to expressions in x
        The others; the last one is the inverse distance.
    back : tuple of expressions
        The state in terms of the coordinates.
    powers : tuple of int
        Power of length of each entry of x.
    usual : mapping of coordinates to floats, optional
        Usual sizes of hidden ones, by which a filter's deviation at the start is multiplied; 1 for those left out.
    guess : mapping of coordinates to expressions in the motion's parameters, optional
        Coordinates that are 0 for a point at infinity, and what they are for a near one if nothing accelerates.

    Raises
    ------
    ValueError
        If the state is not found again from its coordinates.

    See Also
    --------
    PerspectiveSystem : A point on an imaging surface.
    percept_obs.recording.state_scenario.StateScenario : Simulates it.

    Examples
    --------
    >>> import sympy as sp
    >>> from percept_obs import linear
    >>> x, v, y, u, z = sp.symbols("x v y u z", real=True)
    >>> along = StateView("inverse of a place", (x, v), (v, 0), linear([[0, 1], [0, 0]], [0, 0]), {y: v / x},
    ...                   {z: 1 / x}, (1 / z, y / z), (1, 1))
    >>> along.partition("y").rate.T
    Matrix([[-y**2, -y*z]])
    """

    name: str
    state: Symbols
    rate: tuple[sp.Expr, ...]
    motion: Motion
    image: Mapping[sp.Symbol, sp.Expr]
    rest: Mapping[sp.Symbol, sp.Expr]
    back: tuple[sp.Expr, ...]
    powers: tuple[int, ...]
    usual: Mapping[sp.Symbol, float] = field(default_factory=dict)
    parameters: Symbols = ()
    guess: Mapping[sp.Symbol, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("rate", "back", "powers", "formulas"):
            if (count := len(getattr(self, name))) != len(self.state):
                raise ValueError(f"{name} of the {self.name} has {count} entries; the state has {len(self.state)}")
        if strange := {*self.usual, *self.guess} - {*self.formulas}:
            raise ValueError(f"{strange} of `usual` or `guess` are no coordinates of the {self.name}")
        again = [e.subs(self.formulas, simultaneous=True) for e in self.back]
        at = {s: sp.Rational(k + 3, 7) for k, s in enumerate(self.state)}
        if any(abs(sp.N(e.subs(at) - at[s])) > 1e-9 for e, s in zip(again, self.state, strict=True)):
            raise ValueError(f"the state of the {self.name} is not found again from its coordinates; correct `back`")

    @cached_property
    def formulas(self) -> dict[sp.Symbol, sp.Expr]:
        """All coordinates in terms of the state."""
        return {**self.image, **self.rest}

    @property
    def image_coordinates(self) -> Symbols:
        """Symbols of the coordinates that can be measured."""
        return tuple(self.image)

    @property
    def coordinates(self) -> Symbols:
        """Symbols of all coordinates."""
        return tuple(self.formulas)

    @property
    def values(self) -> Mapping[sp.Symbol, float]:
        """No numbers, since there are no constants."""
        return {}

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        """Power of the unit of length in each coordinate, found by doubling all lengths of the state."""
        some = np.arange(3.0, len(self.state) + 3)
        small, large = (self.project(some * 2.0 ** (k * np.array(self.powers))) for k in (0, 1))
        return tuple(np.log2(large / small).round().astype(int).tolist())

    def fits(self, other: Any) -> bool:
        """Return True if the other has the same equations."""
        return isinstance(other, StateView) and (self.rate, self.formulas) == (other.rate, other.formulas)

    def project(self, states: ArrayLike) -> Array:
        """Coordinates of states of shape (..., n)."""
        columns = np.moveaxis(numbers(states, "the states", len(self.state)), -1, 0)
        return np.stack(vectorised(self.state, list(self.formulas.values()))(*columns), axis=-1)

    def locate(self, coordinates: ArrayLike) -> Array:
        """Positions, shape (..., 2) or (..., 3): the state's first entries, as many as are lengths, at most three."""
        columns = np.moveaxis(self._all(coordinates), -1, 0)
        return np.stack(vectorised(self.coordinates, self.back[: min(3, sum(self.powers))])(*columns), axis=-1)

    def inverse(self, coordinates: ArrayLike) -> Array:
        """Inverse distances, shape (...): the last of the coordinates."""
        return self._all(coordinates)[..., -1]

    def partition(self, *names: str) -> PartitionedSystem:
        """Divide the coordinates into measured ones, by name, and hidden ones; `canonical_form` where there is one.

        Raises
        ------
        ValueError
            If a name is not among those that can be measured, or none is given.
        """
        known = [symbol.name for symbol in self.image]
        if not names or not set(names) <= set(known):
            raise ValueError(f"cannot measure {', '.join(names) or 'nothing'}: the {self.name} has {', '.join(known)}")
        moved = sp.Matrix(list(self.formulas.values())).jacobian(self.state) * sp.Matrix(self.rate)
        near = sp.Dummy(positive=True)  # so that roots of its square go
        at = dict(zip(self.state, (e.xreplace({self.coordinates[-1]: near}) for e in self.back), strict=True))
        rate = (sp.cancel(sp.trigsimp(e.subs(at, simultaneous=True))).expand() for e in moved)
        own = sp.ImmutableMatrix([sp.trigsimp(e).xreplace({near: self.coordinates[-1]}) for e in rate])
        return partition(self.coordinates, own, names, self.motion.parameters, self, self.motion)
