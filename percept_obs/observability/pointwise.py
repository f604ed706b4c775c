"""Observability of a canonical form: at an instant, and over a window of its trajectory."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from percept_obs.compile import vectorised
from percept_obs.recording import Recording
from percept_obs.system.forms import CanonicalForm, PartitionedSystem
from percept_obs.system.motion import Motion

Array = NDArray[np.float64]


@dataclass(frozen=True)
class InstantaneousObservability:
    """What w(x1) alone tells about the hidden coordinates at an instant.

    Parameters
    ----------
    form : CanonicalForm
    """

    form: CanonicalForm

    @cached_property
    def information(self) -> sp.ImmutableMatrix:
        """The matrix w w^T, of shape (n2, n2)."""
        return self.form.w * self.form.w.T

    @cached_property
    def rank(self) -> int:
        """Largest rank that the information can have; below n2 no instant suffices."""
        return int(self.form.w.rank())

    @property
    def suffices(self) -> bool:
        """Whether an instant can suffice at all."""
        return self.rank == len(self.form.x2)

    @cached_property
    def measure(self) -> sp.Expr:
        """Determinant of the information, zero where an instant does not suffice."""
        return sp.factor(self.information.det()) if self.suffices else sp.S.Zero

    @cached_property
    def zero_set(self) -> list[dict[sp.Symbol, sp.Expr]]:
        """Where all of w vanishes: solutions for the measured outputs, none if there is no such place."""
        return sp.solve(list(self.form.w), self.form.x1, dict=True)

    def circle(self, threshold: sp.Expr | float) -> tuple[tuple[sp.Expr, ...], sp.Expr]:
        """Centre and radius of the region where |w| is below a threshold.

        With both image coordinates the centre is the focus of expansion (Ma 2005, p. 66).

        Raises
        ------
        ValueError
            If the region is no circle, as with one output alone.
        """
        x1 = self.form.x1
        squared = sum(entry**2 for entry in self.form.w)
        curvature = sp.hessian(squared, x1) / 2
        scale = sp.factor(curvature[0, 0])
        round_ = (curvature - scale * sp.eye(len(x1))).expand() == sp.zeros(len(x1))
        if len(x1) < 2 or not round_ or len(self.zero_set) != 1 or set(self.zero_set[0]) != set(x1):
            raise ValueError(
                f"measuring {', '.join(self.form.measured)}, the region where w is small is no circle; "
                "look at the zero set and the window instead"
            )
        centre = tuple(sp.cancel(self.zero_set[0][x]) for x in x1)
        return centre, sp.Abs(threshold) / sp.sqrt(scale)

    def _repr_latex_(self) -> str:
        verdict = (
            r"\text{an instant can suffice}"
            if self.suffices
            else (rf"\text{{rank }} {self.rank} < {len(self.form.x2)}\text{{: no instant suffices}}")
        )
        return rf"$\displaystyle w w^T = {sp.latex(self.information)},\quad {verdict}$"


def instantaneous(form: PartitionedSystem) -> InstantaneousObservability:
    """Observability at an instant, from w w^T (Ma 2005, (17)-(20), p. 67).

    Ma's test asks the smallest eigenvalue of w w^T to be positive.  With one output and two hidden coordinates its
    rank is 1, so that the smallest eigenvalue is 0 everywhere.

    Raises
    ------
    NotAffine
        If there is no canonical form, and so no w.
    """
    return InstantaneousObservability(form.canonical_form())


@dataclass(frozen=True, eq=False)
class Excitation:
    """Smallest eigenvalue of the information gathered over a window.

    Parameters
    ----------
    time : array of shape (T,)
        Ends of the windows in seconds.
    smallest : array of shape (T,)
        Smallest eigenvalue of the integral of w w^T over the window that ends there.
    window : float
        Length of the window in seconds.
    """

    time: Array
    smallest: Array
    window: float

    @property
    def least(self) -> float:
        """The smallest of all windows: the beta of persistency of excitation."""
        return float(self.smallest.min())


def windowed(
    form: PartitionedSystem, recording: Recording, window: float = 10.0, motion: Motion | None = None
) -> Excitation:
    """Persistency of excitation along a recording.

    Parameters
    ----------
    form : PartitionedSystem
        With a canonical form.
    recording : Recording
        Its truth is used where there is one, else its outputs, with lost samples interpolated.
    window : float
        Seconds.
    motion : Motion, optional
        The recording's own when left out.

    Raises
    ------
    NotAffine
        If there is no canonical form, and so no w.
    ValueError
        If the window is not positive or longer than the recording.
    """
    from scipy.integrate import cumulative_trapezoid

    form, time = form.canonical_form(), recording.time
    if not 0 < window <= time[-1] - time[0] + 1e-9:
        raise ValueError(f"the window is {window} s; it must be positive and at most {time[-1] - time[0]:.4g} s")
    gathered = cumulative_trapezoid(_information(form, recording, motion or recording.motion), time, axis=0, initial=0)
    ends = time[time >= time[0] + window - 1e-9]
    begins = np.maximum(ends - window, time[0])
    flat = gathered.reshape(len(time), -1)
    at = np.stack([np.interp(ends, time, c) - np.interp(begins, time, c) for c in flat.T], axis=-1)
    size = len(form.x2)
    return Excitation(ends, np.linalg.eigvalsh(at.reshape(-1, size, size))[:, 0], window)


def _information(form: CanonicalForm, recording: Recording, motion: Motion) -> Array:
    """The matrix w w^T at the samples, shape (K, n2, n2)."""
    source = recording.outputs if recording.truth is None else recording.truth
    columns = [source[:, recording.names.index(name)] for name in form.measured]
    seen = [np.isfinite(column) for column in columns]
    time = recording.time
    outputs = [np.interp(time, time[s], column[s]) for s, column in zip(seen, columns, strict=True)]
    known = motion.known(recording.time)
    surface = [recording.view.values[s] for s in recording.view.parameters]
    entries = vectorised((*form.x1, *form.parameters), list(form.w))(*outputs, *known.T, *surface)
    w = np.stack(entries, axis=-1).reshape(len(recording.time), *form.w.shape)
    return w @ np.swapaxes(w, 1, 2)
