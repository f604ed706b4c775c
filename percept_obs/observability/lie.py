"""Rank of the Lie derivatives' differentials: observability at an instant from outputs and their derivatives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import sympy as sp
from numpy.linalg import matrix_rank
from numpy.typing import ArrayLike

from percept_obs.compile import Array, vectorised
from percept_obs.observability.directions import in_words
from percept_obs.observability.matching import System, as_form, matching_form
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.tracking.linearised import names_of, rate_of
from percept_obs.validation import MOST_TERMS, checked, limit, travels

NEGLIGIBLE = 1e-8
"""A singular value below this share of the largest one is 0, when every row has the length 1."""


@checked
@dataclass(frozen=True, eq=False)
class Codistribution:
    """Differentials of the outputs h and of L_f h, L_f^2 h, ..., a block of rows for each order; see `lie_derivatives`.

    Parameters
    ----------
    form : PartitionedSystem
    blocks : tuple of matrices of shape (m, n)
        Order by order, from 0 on; columns in the order of the form's coordinates.
    derivatives : tuple of tuples of symbols
        The first, second, ... time derivatives of the form's parameters, if the motion varies; none if not.

    See Also
    --------
    LieRanks : Its ranks along a trajectory.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, lie_derivatives, pinhole
    >>> system = PerspectiveSystem(affine(), pinhole())
    >>> at_rest = dict.fromkeys(system.coordinates, 0.5) | dict.fromkeys(system.parameters, 0.0)
    >>> lie_derivatives(system).rank, lie_derivatives(system).ranks_at(at_rest)
    (3, (2, 2, 2))
    """

    form: PartitionedSystem
    blocks: tuple[sp.ImmutableMatrix, ...]
    derivatives: tuple[tuple[sp.Symbol, ...], ...] = ()

    @property
    def matrix(self) -> sp.ImmutableMatrix:
        """All blocks, one below the other."""
        return sp.ImmutableMatrix.vstack(*self.blocks)

    @cached_property
    def rank(self) -> int:
        """Rank at almost every state and motion."""
        return self.ranks_at(self._random_values)[-1]

    @cached_property
    def unobservable(self) -> Array:
        """Directions that are lost at almost every state and motion, orthonormal, shape (n, n - rank).

        They may turn with state and motion; these belong to values drawn at random.
        """
        from scipy.linalg import null_space

        return null_space(self._at(self._random_values).rows[0], rcond=NEGLIGIBLE)

    def ranks_at(self, values: Mapping[sp.Symbol, float]) -> tuple[int, ...]:
        """Rank with the orders up to 0, 1, ..., at values of coordinates, parameters and their derivatives."""
        return tuple(self._at(values).ranks[0].tolist())

    def along(self, recording: Recording) -> LieRanks:
        """Ranks along the truth of a recording, which must fit the form; ValueError if it does not."""
        time = recording.time
        columns: list[ArrayLike] = []
        if self.form.parameters:
            matching_form(self.form, recording)
            known = np.broadcast_to(recording.motion.known(time), (len(time), len(recording.motion.parameters)))
            surface = [recording.view.values[symbol] for symbol in recording.view.parameters]
            columns = [*known.T, *surface]
            for _ in self.derivatives:
                known = np.gradient(known, time, axis=0)
                columns += [*known.T, *(0.0 for _ in surface)]
        assert recording.truth is not None
        return self._ranks(time, recording.scale, *recording.truth.T, *columns)

    def _at(self, values: Mapping[sp.Symbol, float]) -> LieRanks:
        """Ranks at one state and motion."""
        missing = [str(symbol) for symbol in self._symbols if symbol not in values]
        if missing:
            raise ValueError(f"there are no values for {', '.join(missing)}; give them numbers")
        return self._ranks(np.zeros(1), np.ones(1), *([float(values[symbol])] for symbol in self._symbols))

    def _ranks(self, time: Array, scale: Array, *columns: ArrayLike) -> LieRanks:
        entries = vectorised(self._symbols, list(self.matrix))(*columns)
        rows = np.stack(entries, axis=-1).reshape(-1, *self.matrix.shape) / scale
        # rows of length 1, so that no order outweighs the others; rows of zeros stay
        lengths = np.linalg.norm(rows, axis=2, keepdims=True)
        return LieRanks(self.form, time, np.divide(rows, lengths, out=np.zeros_like(rows), where=lengths > 0))

    @property
    def _symbols(self) -> tuple[sp.Symbol, ...]:
        return (*self.form.coordinates, *self.form.parameters, *(s for each in self.derivatives for s in each))

    @property
    def _random_values(self) -> dict[sp.Symbol, float]:
        draw = np.random.default_rng(1).uniform(0.2, 0.9, len(self._symbols))
        drawn = dict(zip(self._symbols, draw.tolist(), strict=True))
        return drawn | self.form.values

    def _repr_latex_(self) -> str:
        said = rf"\text{{rank }} {self.rank} \text{{ of }} {len(self.form.coordinates)}"
        return rf"$\displaystyle {sp.latex(self.matrix)},\quad {said}$"


@travels
@dataclass(frozen=True, eq=False)
class LieRanks:
    """Ranks of the Lie derivatives' differentials along a trajectory, which `how_observable` has.

    Parameters
    ----------
    form : PartitionedSystem
    time : array of shape (K,)
        Seconds.
    rows : array of shape (K, q, n)
        The differentials, each scaled to the length 1.

    See Also
    --------
    Codistribution : The differentials in symbols.

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, affine, how_observable, pinhole, record, scenarios
    >>> one = PerspectiveSystem(affine(), pinhole()).measure("y1")
    >>> how_observable(record(scenarios.ma2005_eq35(), 4, Camera(0.1)), one).lie.holds
    True
    """

    form: PartitionedSystem
    time: Array
    rows: Array

    @cached_property
    def ranks(self) -> Array:
        """Rank with the orders up to 0, up to 1, and so on, shape (K, orders + 1)."""
        m = len(self.form.x1)
        counts = range(m, self.rows.shape[1] + 1, m)
        return np.stack([matrix_rank(self.rows[:, :count], rtol=NEGLIGIBLE) for count in counts], axis=1)

    @cached_property
    def smallest(self) -> Array:
        """Smallest singular value of all orders together, shape (K,)."""
        return np.asarray(np.linalg.svd(self.rows, compute_uv=False)[:, -1])

    @property
    def holds(self) -> bool:
        """True if the rank is full at every sample."""
        return bool((self.ranks[:, -1] == len(self.form.coordinates)).all())

    @property
    def weakest(self) -> int:
        """Index of the sample of the least rank; among several, of the smallest singular value."""
        worst = self.ranks[:, -1] == self.ranks[:, -1].min()
        return int(np.argmin(np.where(worst, self.smallest, np.inf)))

    def lost(self) -> tuple[str, ...]:
        """Directions that are lost at the weakest sample, in words."""
        from scipy.linalg import null_space

        return in_words(null_space(self.rows[self.weakest], rcond=NEGLIGIBLE), names_of(self.form))


@checked
def lie_derivatives(system: System, orders: int | None = None, varying: bool = False) -> Codistribution:
    """Derive the differentials of the outputs and of their Lie derivatives, in symbols.

    A state can be told from all states near it if their rank is the number of coordinates (Hermann and Krener,
    Nonlinear controllability and observability, IEEE Trans. Automatic Control 22 (1977)).  At single states more
    orders may be needed than almost everywhere, as at the focus of expansion.

    Parameters
    ----------
    system : PartitionedSystem, or PerspectiveSystem
        With or without numbers; a perspective system stands for all image coordinates.
    orders : int, optional
        Largest number of derivatives; as many as there are coordinates, less one, when left out.
    varying : bool
        True if the motion varies, so that its parameters have time derivatives as well.

    Returns
    -------
    Codistribution
        A block of shape (m, n) for each order, with m outputs and n coordinates.

    Raises
    ------
    ValueError
        If the number of orders is negative.
    TooMuchWork
        If the expressions become too long.

    See Also
    --------
    percept_obs.how_observable : Along a recording, among other measures.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, lie_derivatives, pinhole
    >>> system = PerspectiveSystem(affine(), pinhole())
    >>> [lie_derivatives(system, orders).rank for orders in (0, 1)]
    [2, 3]
    >>> lie_derivatives(system.measure("y1")).rank
    3
    """
    form = as_form(system)
    x, p = form.coordinates, form.parameters
    orders = len(x) - 1 if orders is None else orders
    if orders < 0:
        raise ValueError(f"the orders are {orders}; the outputs themselves are the order 0")
    f = rate_of(form)
    growth = 4.0 if all(entry.is_polynomial(*x) for entry in f) else 10.0  # from order to order, as curved surfaces do
    terms = len(form.x1) * len(x) * growth ** min(orders, 99)
    limit(terms, "terms of Lie derivatives", "ask for fewer orders", MOST_TERMS)
    names = [tuple(sp.Symbol(f"{s.name}^({k})", real=True) for s in p) for k in range(1, orders)] if varying else []
    chain = [p, *names]
    h, blocks = sp.ImmutableMatrix(form.x1), []
    for k in range(orders + 1):
        gradient = h.jacobian(x)
        blocks.append(gradient)
        if k < orders:
            moved = gradient * f
            # L_f h of a varying motion: the parameters move as well, each derivative by the next one
            for now, after in pairwise(chain):
                moved += h.jacobian(now) * sp.ImmutableMatrix(after) if now else sp.zeros(*h.shape)
            h = sp.ImmutableMatrix(moved)
    return Codistribution(form, tuple(blocks), tuple(names))


def lie_ranks(recording: Recording, form: PartitionedSystem) -> LieRanks:
    """Ranks of the Lie derivatives along the truth of a recording, with the derivatives of a motion that varies."""
    signal = recording.motion.signal
    varying = signal is not None and not signal.constant
    if not varying:  # numbers are put in, so that zeros drop out
        numbers = recording.motion.values | dict(recording.view.values)
        rate = sp.ImmutableMatrix(form.rate.xreplace({s: sp.Float(v) if v else sp.S.Zero for s, v in numbers.items()}))
        form = PartitionedSystem(form.x1, form.x2, rate, (), form.coordinates, form.view)
    return lie_derivatives(form, varying=varying).along(recording)
