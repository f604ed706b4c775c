"""Observability Gramians of one point along its trajectory: of the linearised error system, and by perturbed runs."""

from __future__ import annotations

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.compile.integrator import step_along
from percept_obs.observability.matching import System, matching_form
from percept_obs.observability.windows import Windows, check_window, window_integrals
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.signal import slack_of
from percept_obs.tracking.linearised import linearisation, names_of, outputs_of, positions, rate_of, values_along
from percept_obs.validation import checked

PERTURBATION = 1e-3
"""Perturbation of a run's start, relative to the size of the coordinate."""

STEP = 0.05
"""Longest step of perturbed runs in seconds; its error is small against what such a perturbation leaves."""

MOST_WINDOWS = 24
"""Largest number of windows of the empirical Gramian."""


class ErrorGramian(Windows):
    """Change of the outputs of a window with the coordinates at its beginning, squared and integrated.

    It comes from `error_gramian` or `empirical_gramian`.

    Parameters
    ----------
    names : tuple of n str
        The form's coordinates, in its order.
    time : array of shape (T,)
        Beginnings of the windows in seconds.
    matrices : array of shape (T, n, n)
    window : float
        Length of the windows in seconds.
    scale : array of shape (T,), optional
        With which eigenvalues are compared; the largest eigenvalue of each window when left out.

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, affine, pinhole, record, scenarios
    >>> from percept_obs.observability import error_gramian
    >>> one = PerspectiveSystem(affine(), pinhole()).measure("y1")
    >>> error_gramian(record(scenarios.planar(), 3, Camera(0.1)), one, 1).holds
    True
    """


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

    See Also
    --------
    empirical_gramian : Without derivatives.

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, affine, pinhole, record, scenarios
    >>> from percept_obs.observability import error_gramian
    >>> seen, system = record(scenarios.planar(), 3, Camera(0.1)), PerspectiveSystem(affine(), pinhole())
    >>> both, one = (error_gramian(seen, form, 1).smallest.min() for form in (system, system.measure("y1")))
    >>> print(f"{both:.1e} {one:.1e}")
    1.4e-01 2.5e-05
    """
    form = matching_form(system, recording)
    check_window(recording, window)
    assert recording.truth is not None
    along = linearisation(form, recording)(recording.truth)
    H = np.eye(len(form.coordinates))[along.measured] * along.seen[:, :, None]
    begins, matrices = window_integrals(recording.time, np.swapaxes(H, 1, 2) @ H, along.transitions, window)
    by_unit = matrices / np.outer(recording.scale, recording.scale)
    return ErrorGramian(names_of(form), recording.time[begins], by_unit, window)


@checked
def empirical_gramian(recording: Recording, system: System, window: float) -> ErrorGramian:
    """The Gramian from runs that begin beside the truth, without derivatives.

    With d_i the change of the outputs by a unit change of coordinate i, the entries are the integrals of d_i^T d_j.

    Parameters
    ----------
    recording, system, window
        See `error_gramian`.

    Returns
    -------
    ErrorGramian
        For some windows, evenly spread.

    Raises
    ------
    ValueError
        As `error_gramian`.

    See Also
    --------
    error_gramian : Of the linearised system.

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
    form = matching_form(system, recording)
    check_window(recording, window)
    time = recording.time
    last = int(np.searchsorted(time, time[-1] - window + slack_of(time), side="right")) - 1
    begins = np.unique(np.linspace(0, last, MOST_WINDOWS).round().astype(int))
    ends = np.searchsorted(time, time[begins] + window - slack_of(time))
    matrices = _by_runs(form, recording, begins, ends) / np.outer(recording.scale, recording.scale)
    return ErrorGramian(names_of(form), time[begins], matrices, window)


def _by_runs(form: PartitionedSystem, recording: Recording, begins: Indices, ends: Indices) -> Array:
    """Gramians of windows from some samples to others, shape (T, n, n); all runs of all windows go side by side."""
    assert recording.truth is not None
    n, time, truth = len(form.coordinates), recording.time, recording.truth
    usual = np.sqrt(np.mean(truth**2, axis=0))
    # a coordinate that is about zero is perturbed by the square of this share of its usual size
    sizes = PERTURBATION * np.maximum(np.abs(truth[begins]), PERTURBATION * usual)
    signs = np.concatenate([np.eye(n), -np.eye(n)])  # central differences
    states = (truth[begins][:, None] + sizes[:, None] * signs).reshape(-1, n)
    rate = values_along(form, recording, [*rate_of(form)])
    measured, seen = positions(form, form.measured), np.isfinite(outputs_of(form, recording))
    found, before = np.zeros((len(begins), n, n)), np.zeros((len(begins), n, n))
    for j in range(int((ends - begins).max()) + 1):
        # windows of fewer samples than the longest one wait at their end, where steps have no length
        at, after = np.minimum(begins + j, ends), np.minimum(begins + j + 1, ends)
        outputs = states[:, measured].reshape(len(begins), 2 * n, -1)
        slopes = (outputs[:, :n] - outputs[:, n:]) / (2 * sizes[:, :, None]) * seen[at][:, None]
        now, h = slopes @ np.swapaxes(slopes, 1, 2), time[after] - time[at]
        if j:
            # trapezoidal rule
            found += (before + now) * (time[at] - time[np.minimum(begins + j - 1, ends)])[:, None, None] / 2
        before = now
        count = max(1, int(np.ceil(h.max() / STEP - 1e-4)))
        length = np.repeat(h / count, 2 * n)
        for k in range(count):
            states = step_along(states, np.repeat(time[at], 2 * n) + k * length, length, rate)
    return found
