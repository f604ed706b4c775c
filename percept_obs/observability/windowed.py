"""Observability of a canonical form over windows of a trajectory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp

from percept_obs.compile import Array, vectorised
from percept_obs.observability.windows import OverWindows, check_window
from percept_obs.recording import Recording
from percept_obs.system.forms import CanonicalForm, PartitionedSystem
from percept_obs.system.signal import from_the_start
from percept_obs.validation import checked


@dataclass(frozen=True, eq=False)
class Excitation(OverWindows):
    """Information about the hidden coordinates that w gathers over windows.

    Parameters
    ----------
    form : CanonicalForm
    time : array of shape (T,)
        Ends of the windows in seconds.
    matrices : array of shape (T, n2, n2)
        Integral of w w^T over the window that ends there.
    window : float
        Length of the windows in seconds.
    uncancelled : array of shape (T,)
        How large its trace would be if no two terms of w cancelled each other.
    """

    form: CanonicalForm
    time: Array
    matrices: Array
    window: float
    uncancelled: Array

    @property
    def names(self) -> tuple[str, ...]:
        """Of the hidden coordinates."""
        return self.form.hidden

    @property
    def reference(self) -> Array:
        """With one hidden coordinate the largest eigenvalue is the smallest one, and would not tell it from zero."""
        return np.maximum(self.uncancelled, 1e-300)


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

    Raises
    ------
    NotAffine
        If there is no canonical form, and so no w.
    ValueError
        If the window is not positive or longer than the recording.

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
    rows = np.hstack([found.matrices.reshape(len(time), -1), found.uncancelled[:, None]])
    gathered = cumulative_trapezoid(rows, time, axis=0, initial=0)
    ends = time[from_the_start(recording.elapsed, window)]
    begins = np.maximum(ends - window, time[0])
    at = np.stack([np.interp(ends, time, c) - np.interp(begins, time, c) for c in gathered.T], axis=-1)
    matrices = at[:, :-1].reshape(-1, *found.matrices.shape[1:])
    return Excitation(found.form, ends, matrices, window, at[:, -1])


def instants(form: PartitionedSystem, recording: Recording) -> Excitation:
    """The matrix w w^T at the samples: what windows of no length gather; see `windowed`."""
    canonical = form.canonical_form()
    terms = _along(canonical, recording, [_without_cancelling(entry) for entry in canonical.w])
    matrices = information_along(form, recording)
    return Excitation(canonical, recording.time, matrices, 0.0, (terms**2).sum(axis=1))


def _without_cancelling(entry: sp.Expr) -> sp.Expr:
    """A sum with the absolute value of each term."""
    return sp.Add(*map(sp.Abs, sp.Add.make_args(entry)))


def information_along(form: PartitionedSystem, recording: Recording) -> Array:
    """The matrix w w^T at the samples, shape (K, n2, n2); see `windowed`."""
    form = form.canonical_form()
    w = _along(form, recording, list(form.w)).reshape(len(recording.time), *form.w.shape)
    return w @ np.swapaxes(w, 1, 2)


def _along(form: CanonicalForm, recording: Recording, expressions: Sequence[sp.Expr]) -> Array:
    """Values of expressions in the measured outputs and parameters at the samples, one a column."""
    source = recording.outputs if recording.truth is None else recording.truth
    names = recording.names if source is recording.outputs else tuple(map(str, recording.view.coordinates))
    columns = [source[:, names.index(name)] for name in form.measured]
    seen = [np.isfinite(column) for column in columns]
    time = recording.time
    outputs = [np.interp(time, time[s], column[s]) for s, column in zip(seen, columns, strict=True)]
    known = recording.motion.known(time)
    surface = [recording.view.values[s] for s in recording.view.parameters]
    entries = vectorised((*form.x1, *form.parameters), expressions)(*outputs, *known.T, *surface)
    return np.stack(entries, axis=-1)
