"""Information that windows of a trajectory gather, and the directions of the state that they miss."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from percept_obs.compile import Array, Indices, vectorised
from percept_obs.observability.directions import in_words
from percept_obs.recording import Recording
from percept_obs.system.forms import CanonicalForm, PartitionedSystem
from percept_obs.system.signal import from_the_start, slack_of
from percept_obs.tracking.following import require_match
from percept_obs.tracking.grid import known_signals
from percept_obs.validation import checked, one_of

UNSEEN = 1e-6
"""A direction whose eigenvalue is below this share of the largest one is not seen."""


@checked
@dataclass(frozen=True, eq=False)
class Windows:
    """Symmetric matrices, one for each window: how much of each direction of the state the window shows."""

    names: tuple[str, ...]  # of the n states
    time: Array  # (T,), beginnings or ends of the windows in seconds
    matrices: Array  # (T, n, n)
    window: float  # length in seconds
    scale: Array | None = None  # (T,), with which eigenvalues are compared; without it each window's largest one

    @cached_property
    def eigenvalues(self) -> Array:
        """Eigenvalues of each window's matrix, increasing, shape (T, n)."""
        return np.asarray(np.linalg.eigvalsh(self.matrices))

    @property
    def smallest(self) -> Array:
        """Smallest eigenvalue of each window, shape (T,)."""
        return np.asarray(self.eigenvalues[:, 0])

    @property
    def least(self) -> float:
        """Smallest eigenvalue of all windows; 0 but for rounding where a direction is not seen."""
        return float(self.smallest.min())

    @cached_property
    def _positive_scale(self) -> Array:
        return np.maximum(self.eigenvalues[:, -1] if self.scale is None else self.scale, 1e-300)

    @property
    def holds(self) -> bool:
        """True if every direction is seen in every window."""
        return bool((self.smallest > UNSEEN * self._positive_scale).all())

    @cached_property
    def weakest(self) -> int:
        """Index of the first window that misses most directions; if none is missed, of the one that shows least."""
        missed = (self.eigenvalues <= UNSEEN * self._positive_scale[:, None]).sum(axis=1)
        return int(np.argmax(missed) if missed.any() else np.argmin(self.smallest / self._positive_scale))

    def unseen(self, window: int | None = None) -> Array:
        """Directions that a window does not show, orthonormal columns, shape (n, q); the weakest if none is given."""
        k = self.weakest if window is None else window
        one_of(len(self.matrices), window=k)
        values, vectors = np.linalg.eigh(self.matrices[k])
        return np.asarray(vectors[:, values <= UNSEEN * self._positive_scale[k]])

    def lost(self, window: int | None = None) -> tuple[str, ...]:
        """Directions that a window does not show, in words such as "y2 - y3"; see `unseen`."""
        return in_words(self.unseen(window), self.names)


class Excitation(Windows):
    """Information about the hidden coordinates that w gathers over windows: the integral of w w^T.

    `time` holds the windows' ends.  Eigenvalues are compared with the trace that the matrix would have if no two terms
    of w cancelled: with one hidden coordinate its only eigenvalue could not be told from zero otherwise.
    """


@checked
def windowed(form: PartitionedSystem, recording: Recording, window: float = 10.0) -> Excitation:
    """Persistency of excitation along a recording.

    Parameters
    ----------
    form : PartitionedSystem
        With a canonical form.
    recording : Recording
        Its truth is used where there is one, else its outputs, with lost samples interpolated.
    window : float
        Seconds.

    Returns
    -------
    Excitation
        Integrals of w w^T over the windows that end at samples, and their eigenvalues.

    Raises
    ------
    NotAffine
        If there is no canonical form, and so no w.
    ValueError
        If the window is not positive, longer than the recording or shorter than the time between two samples.

    See Also
    --------
    instantaneous : Observability at an instant, in symbols.
    how_observable : All measures of observability side by side.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole, record, scenarios, windowed
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> found = windowed(form, record(scenarios.ma2005_eq35(), 20), window=5)
    >>> print(f"{found.smallest.min():.2f}")
    0.48
    """
    from scipy.integrate import cumulative_trapezoid

    time = recording.time
    check_window(recording, window)
    found = instants(form, recording)
    assert found.scale is not None
    rows = np.column_stack([found.matrices.reshape(len(time), -1), found.scale])
    integrals = cumulative_trapezoid(rows, time, axis=0, initial=0)
    ends = time[from_the_start(recording.elapsed, window)]
    # integrals between samples: the running integral, interpolated at the window's ends
    begins = np.maximum(ends - window, time[0])
    over = np.stack([np.interp(ends, time, c) - np.interp(begins, time, c) for c in integrals.T], axis=-1)
    matrices = over[:, :-1].reshape(-1, *found.matrices.shape[1:])
    return Excitation(found.names, ends, matrices, window, over[:, -1])


def instants(form: PartitionedSystem, recording: Recording) -> Excitation:
    """The matrix w w^T at the samples, as windows of length 0; see `windowed`."""
    require_match(form, recording, recording.motion)
    canonical = form.canonical_form()
    sizes = [sp.Add(*map(sp.Abs, sp.Add.make_args(entry))) for entry in canonical.w]  # no two terms cancel
    scale = (_along(canonical, recording, sizes) ** 2).sum(axis=1)
    return Excitation(canonical.hidden, recording.time, information_along(form, recording), 0.0, scale)


def information_along(form: PartitionedSystem, recording: Recording) -> Array:
    """The matrix w w^T at the samples, shape (K, n2, n2); see `windowed`."""
    form = form.canonical_form()
    w = _along(form, recording, list(form.w)).reshape(len(recording.time), *form.w.shape)
    return w @ np.swapaxes(w, 1, 2)


def _along(form: CanonicalForm, recording: Recording, expressions: Sequence[sp.Expr]) -> Array:
    """Values of expressions in the measured outputs and parameters at the samples, one a column."""
    time, names = recording.time, recording.names
    source = recording.outputs
    if recording.truth is not None:
        source, names = recording.truth, tuple(map(str, recording.view.coordinates))
    outputs = []
    for name in form.measured:
        column = source[:, names.index(name)]
        seen = np.isfinite(column)
        if not seen.any():
            raise ValueError(f"no sample of {name} was seen; take a part of the recording that shows the point")
        outputs.append(np.interp(time, time[seen], column[seen]))
    known = known_signals(recording.motion, recording.view, time, recording.unit)
    entries = vectorised((*form.x1, *form.parameters), expressions)(*outputs, *known.T)
    return np.stack(entries, axis=-1)


def check_window(recording: Recording, window: float) -> None:
    """Raise ValueError unless a window is positive and fits into a recording, and holds two samples."""
    length, shortest = recording.elapsed[-1], float(np.diff(recording.time).min())
    if not 0 < window <= length + slack_of(recording.time):
        raise ValueError(f"the window is {window} s; it must be positive and at most {length:.4g} s")
    if window < shortest * (1 - 1e-9):
        raise ValueError(f"the window is {window} s, shorter than the {shortest:.4g} s between two samples; widen it")


def window_integrals(time: Array, S: Array, Phi: Array, window: float) -> tuple[Indices, Array]:
    """Samples at which windows begin, shape (T,), and integrals of Phi^T S Phi over these windows, shape (T, n, n).

    S, shape (K, n, n), is the information of each sample, and Phi, shape (K - 1, n, n), the transition to the next one.
    """
    h = np.diff(time)[:, None, None]
    # trapezoidal rule over one interval, with the end's information referred to its beginning
    G = h / 2 * (S[:-1] + _seen_through(Phi, S[1:]))
    # the first sample at or behind the window's end; windows that reach beyond the last one are left out
    ends = np.searchsorted(time, time + window - slack_of(time))
    begins = np.flatnonzero(ends < len(time))
    reached, left, size = begins.copy(), ends[begins] - begins, 1
    whole = np.repeat(np.eye(S.shape[1])[None], len(begins), axis=0)
    matrices = np.zeros_like(whole)
    # a window is put together of spans of 1, 2, 4, ... intervals, as the binary digits of its length say
    while left.any():
        odd = left % 2 == 1
        matrices[odd] += _seen_through(whole[odd], G[reached[odd]])
        whole[odd] = Phi[reached[odd]] @ whole[odd]
        reached[odd] += size
        G = G[:-size] + _seen_through(Phi[:-size], G[size:])
        Phi = Phi[size:] @ Phi[:-size]
        left, size = left // 2, 2 * size
    return begins, (matrices + np.swapaxes(matrices, 1, 2)) / 2


def _seen_through(Phi: Array, G: Array) -> Array:
    """Information about the states before the transitions: Phi^T G Phi."""
    return np.asarray(np.swapaxes(Phi, 1, 2) @ G @ Phi)
