"""Observability Gramians of one point along its trajectory: of the linearised error system, and by perturbed runs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.compile.integrator import INSTANTS, step
from percept_obs.observability.linearised import System, fitting, flow_along, linearised, places
from percept_obs.observability.windows import OverWindows, check_samples, gathered
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.signal import slack_of
from percept_obs.validation import checked

PERTURBED = 1e-3
"""Share of a coordinate by which a run begins beside the truth."""

STEP = 0.05
"""Longest step of such runs in seconds: of what a perturbation of this size leaves, its error is a small part."""

SOME = 24
"""Windows that are looked at by perturbed runs."""


@dataclass(frozen=True, eq=False)
class ErrorGramian(OverWindows):
    """How much the outputs of a window change with the coordinates at its beginning.

    Parameters
    ----------
    form : PartitionedSystem
    time : array of shape (T,)
        Beginnings of the windows in seconds.
    matrices : array of shape (T, n, n)
        In the order of the form's coordinates.
    window : float
        Length of the windows in seconds.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole, record, scenarios
    >>> from percept_obs.observability import error_gramian
    >>> found = error_gramian(record(scenarios.planar(), 3), PerspectiveSystem(affine(), pinhole()), window=1)
    >>> found.names, found.matrices.shape[1:]
    (('y1', 'y2', 'y3'), (3, 3))
    >>> print(f"{found.smallest.min():.1e}")
    1.4e-01
    """

    form: PartitionedSystem
    time: Array
    matrices: Array
    window: float

    @property
    def names(self) -> tuple[str, ...]:
        """Of the coordinates."""
        return tuple(symbol.name for symbol in self.form.coordinates)


@checked
def error_gramian(recording: Recording, system: System, window: float) -> ErrorGramian:
    """The integral of Phi^T H^T H Phi over windows, of the error system linearised along the truth.

    It counts what w shows, as persistency of excitation does, and what g carries from the hidden coordinates as well.

    Parameters
    ----------
    recording : Recording
        With a truth; lost samples show nothing.
    system : PartitionedSystem, or PerspectiveSystem
        Which outputs are measured; a perspective system stands for all image coordinates.
    window : float
        Seconds.

    Returns
    -------
    ErrorGramian
        With a window for each sample from which it fits into the recording.

    Raises
    ------
    ValueError
        If system and recording do not fit, there is no truth, or the window does not fit.

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, affine, pinhole, record, scenarios
    >>> from percept_obs.observability import error_gramian
    >>> seen, system = record(scenarios.planar(), 3, Camera(0.1)), PerspectiveSystem(affine(), pinhole())
    >>> both, one = (error_gramian(seen, form, 1).smallest.min() for form in (system, system.measure("y1")))
    >>> print(f"{both:.1e} {one:.1e}")
    1.4e-01 2.5e-05
    """
    form = fitting(system, recording)
    check_samples(recording, window)
    along = linearised(form, recording)
    H = np.zeros((len(recording.time), len(along.measured), len(form.coordinates)))
    H[:, np.arange(len(along.measured)), along.measured] = along.seen
    begins, matrices = gathered(recording.time, np.swapaxes(H, 1, 2) @ H, along.transitions, window)
    return ErrorGramian(form, recording.time[begins], matrices, window)


@checked
def empirical_gramian(
    recording: Recording, system: System, window: float, perturbed: float = PERTURBED
) -> ErrorGramian:
    """The same by perturbed runs: no derivative is taken, and what is not linear is seen (Krener and Ide 2009).

    From the beginning of each window two runs start beside the truth for every coordinate, one on either side.  With
    the differences d_i of their outputs over twice the perturbation, the entry (i, j) is the integral of d_i^T d_j.

    Parameters
    ----------
    recording, system, window
        See `error_gramian`.
    perturbed : float
        Share of a coordinate's size by which runs begin beside the truth.

    Returns
    -------
    ErrorGramian
        For some windows, evenly spread.

    Raises
    ------
    ValueError
        As `error_gramian`, or if the share is not between 0 and 1.

    Notes
    -----
    Krener and Ide, Measures of unobservability, IEEE Conf. Decision and Control (2009).

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, affine, pinhole, record, scenarios
    >>> from percept_obs.observability import empirical_gramian
    >>> seen = record(scenarios.planar(), 2, Camera(0.1))
    >>> found = empirical_gramian(seen, PerspectiveSystem(affine(), pinhole()), window=1)
    >>> print(f"{found.smallest.min():.1e}")
    1.5e-01
    """
    form = fitting(system, recording)
    check_samples(recording, window)
    if not 0 < perturbed < 1:
        raise ValueError(f"the perturbed share is {perturbed}; it must lie between 0 and 1")
    time = recording.time
    last = int(np.searchsorted(time, time[-1] - window + slack_of(time), side="right")) - 1
    begins = np.unique(np.linspace(0, last, SOME).round().astype(int))
    ends = np.searchsorted(time, time[begins] + window - slack_of(time))
    matrices = _by_runs(form, recording, begins, ends, perturbed)
    return ErrorGramian(form, time[begins], matrices, window)


def _by_runs(form: PartitionedSystem, recording: Recording, begins: Indices, ends: Indices, share: float) -> Array:
    """Gramians of windows from some samples to others, shape (T, n, n); all runs of all windows go side by side."""
    assert recording.truth is not None
    n, time, truth = len(form.coordinates), recording.time, recording.truth
    usual = np.sqrt(np.mean(truth**2, axis=0))
    sizes = share * np.maximum(np.abs(truth[begins]), share * usual)
    away = np.concatenate([np.eye(n), -np.eye(n)])  # all to one side, then all to the other
    states = (truth[begins][:, None] + sizes[:, None] * away).reshape(-1, n)
    rate = flow_along(form, recording)
    columns = [recording.names.index(name) for name in form.measured]
    measured, seen = places(form, form.measured), np.isfinite(recording.outputs[:, columns])
    found, before = np.zeros((len(begins), n, n)), np.zeros((len(begins), n, n))
    for j in range(int((ends - begins).max()) + 1):
        at, after = np.minimum(begins + j, ends), np.minimum(begins + j + 1, ends)
        outputs = states[:, measured].reshape(len(begins), 2 * n, -1)
        slopes = (outputs[:, :n] - outputs[:, n:]) / (2 * sizes[:, :, None]) * seen[at][:, None]
        now, h = slopes @ np.swapaxes(slopes, 1, 2), time[after] - time[at]
        if j:
            found += (before + now) * (time[at] - time[np.minimum(begins + j - 1, ends)])[:, None, None] / 2
        before = now
        pieces = max(1, int(np.ceil(h.max() / STEP - 1e-4)))
        for k in range(pieces):
            part, start = np.repeat(h / pieces, 2 * n), np.repeat(time[at] + k * h / pieces, 2 * n)

            def moving(instant: int, state: Array, start: Array = start, part: Array = part) -> Array:
                return rate(start + float(INSTANTS[instant]) * part, state)

            states = step(states, part[:, None], moving)
    return found
