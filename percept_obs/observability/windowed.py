"""Observability of a canonical form over windows of a trajectory."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from percept_obs.border import checked
from percept_obs.compile import Array, vectorised
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.signal import from_the_start, slack_of


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
    """
    from scipy.integrate import cumulative_trapezoid

    time = recording.time
    check_window(recording, window)
    gathered = cumulative_trapezoid(information_along(form, recording), time, axis=0, initial=0)
    ends = time[from_the_start(recording.elapsed, window)]
    begins = np.maximum(ends - window, time[0])
    flat = gathered.reshape(len(time), -1)
    at = np.stack([np.interp(ends, time, c) - np.interp(begins, time, c) for c in flat.T], axis=-1)
    size = len(form.x2)
    return Excitation(ends, np.linalg.eigvalsh(at.reshape(-1, size, size))[:, 0], window)


def check_window(recording: Recording, window: float) -> None:
    """Refuse a window that does not fit into a recording.

    Raises
    ------
    ValueError
        If it is not positive or longer than the recording.
    """
    length = recording.elapsed[-1]
    if not 0 < window <= length + slack_of(recording.time):
        raise ValueError(f"the window is {window} s; it must be positive and at most {length:.4g} s")


def information_along(form: PartitionedSystem, recording: Recording) -> Array:
    """The matrix w w^T at the samples, shape (K, n2, n2); see `windowed`."""
    form = form.canonical_form()
    source = recording.outputs if recording.truth is None else recording.truth
    names = recording.names if source is recording.outputs else tuple(map(str, recording.view.coordinates))
    columns = [source[:, names.index(name)] for name in form.measured]
    seen = [np.isfinite(column) for column in columns]
    time = recording.time
    outputs = [np.interp(time, time[s], column[s]) for s, column in zip(seen, columns, strict=True)]
    known = recording.motion.known(time)
    surface = [recording.view.values[s] for s in recording.view.parameters]
    entries = vectorised((*form.x1, *form.parameters), list(form.w))(*outputs, *known.T, *surface)
    w = np.stack(entries, axis=-1).reshape(len(time), *form.w.shape)
    return w @ np.swapaxes(w, 1, 2)
