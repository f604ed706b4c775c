"""Condition (14): information in the images of a window about the state, and the decay of errors that it implies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import accumulate
from types import MappingProxyType

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.observability.directions import in_words, mainly
from percept_obs.observability.windows import Windows, check_window, window_integrals
from percept_obs.points.conditions import conditions
from percept_obs.points.form import PointsForm, points_form
from percept_obs.points.information import transitions
from percept_obs.points.luenberger import LuenbergerObserver
from percept_obs.recording import Recording
from percept_obs.system.signal import slack_of
from percept_obs.validation import checked

LARGEST_TABLE = 1e7
"""Largest number of entries of all transition matrices; with more samples only every second, third, ... is used."""

PARTS = 40
"""Number of intervals into which a window is divided for the bound on the decay."""

VERDICTS = MappingProxyType(
    {
        "holds": "(14) holds: the smallest eigenvalue is at least {least}; least is seen in the {window} s from "
        "{begin} s on, mainly of {direction}",
        "one fails": "(14) fails: in the {window} s from {begin} s on 1 direction is not seen: {directions}",
        "several fail": "(14) fails: in the {window} s from {begin} s on {count} directions are not seen: {directions}",
        "the scale": "; this is the state itself: the images do not tell its scale",
        "the scale too": "; the state itself is among them: the images do not tell its scale",
    }
)
"""Sentences about condition (14), also of live labs."""


@checked
@dataclass(frozen=True, eq=False)
class Gramian(Windows):
    """The integral of Phi^T S Phi over windows, from the state at their beginnings.

    Parameters
    ----------
    names, time, matrices, window, scale
        See `Windows`; `time` holds the windows' beginnings.
    states : array of shape (T, n), optional
        True states at the beginnings.

    See Also
    --------
    gramian, linear_gramian : Compute it.
    percept_obs.figures.gramian : Draws it.

    Examples
    --------
    >>> from percept_obs import Camera, record
    >>> from percept_obs.points.gramian import gramian
    >>> from percept_obs.points.scenarios import along_the_line_of_sight
    >>> gramian(record(along_the_line_of_sight(), 5, Camera(0.1)), 2).lost()
    ('0.2 X + 0.1 Y + Z',)
    """

    states: Array | None = None

    def verdict(self) -> str:
        """Say in words if (14) holds; if not, which directions of the state are not seen."""
        k = self.weakest
        lost = self.unseen()
        fields = {"window": f"{self.window:g}", "begin": f"{self.time[k]:.3g}", "least": f"{self.least:.3g}"}
        if not lost.shape[1]:
            direction = np.linalg.eigh(self.matrices[k])[1][:, 0]
            return VERDICTS["holds"].format(**fields, direction=mainly(direction, self.names))
        named = in_words(lost, self.names)
        one = len(named) == 1
        fields |= {"count": str(len(named)), "directions": "; ".join(named)}
        text = VERDICTS["one fails" if one else "several fail"].format(**fields)
        if self.states is None or not np.isfinite(self.states[k]).all():
            return text
        state = self.states[k] / max(float(np.linalg.norm(self.states[k])), 1e-300)
        if np.linalg.norm(lost.T @ state) > 1 - 1e-4:
            text += VERDICTS["the scale" if one else "the scale too"]
        return text


@checked
def gramian(recording: Recording, window: float) -> Gramian:
    """Return the information in the images of a window about the state: the integral in (14), Inaba et al. 2005.

    There is a window for each sample from which it fits into the recording.

    Parameters
    ----------
    recording : Recording
        Its true images are used where there is a truth, else its outputs; points count while they are seen.
    window : float
        Seconds.

    Raises
    ------
    ValueError
        If the window is not positive or longer than the recording.

    See Also
    --------
    linear_gramian : Of the points with their distances.
    decay_bound : Decay of errors that it guarantees.

    Examples
    --------
    >>> from percept_obs import Camera, record
    >>> from percept_obs.points.gramian import gramian
    >>> from percept_obs.points.scenarios import moving_body
    >>> gramian(record(moving_body(1), 5, Camera(0.1)), 2).holds
    True
    """
    form, images = points_form(recording), _true_images(recording)
    return _windows(recording, window, form, lambda k: form.information(images[k]))


@checked
def linear_gramian(recording: Recording, window: float) -> Gramian:
    """Return the information if the points were seen with their distances: the integral of Phi^T C^T C Phi.

    The pair (C, A) is uniformly observable if its smallest eigenvalue stays above a positive number.  Where (14) holds
    with epsilon, this one is at least epsilon / (1 + sup |y|^2) (Proposition 3.3); the converse fails.

    Parameters
    ----------
    recording, window
        See `gramian`.  Points count while they are seen.

    Raises
    ------
    ValueError
        If the window is not positive or longer than the recording.

    See Also
    --------
    gramian : Of the images alone.

    Examples
    --------
    >>> from percept_obs import Camera, record
    >>> from percept_obs.points.gramian import gramian, linear_gramian
    >>> from percept_obs.points.scenarios import along_the_line_of_sight
    >>> seen = record(along_the_line_of_sight(), 5, Camera(0.1))
    >>> gramian(seen, 2).holds, linear_gramian(seen, 2).holds
    (False, True)
    """
    form = points_form(recording)

    def information(k: Indices) -> Array:
        C = np.where(recording.seen[k][..., None, None], form.blocks, 0.0).reshape(len(k), -1, form.states)
        return np.swapaxes(C, 1, 2) @ C

    return _windows(recording, window, form, information)


@checked
@dataclass(frozen=True, eq=False)
class DecayBound:
    """Guarantee of the proof of Theorem 3.4 for the error, window by window.

    Parameters
    ----------
    time : array of shape (T,)
        Beginnings of windows that follow each other, in seconds.
    seen : array of shape (T,)
        Smallest eigenvalue of the Gramian relative to P: rho^T G rho >= seen rho^T P rho.
    feedback : array of shape (T,)
        Norm of the operator by which the observer's corrections hide the error from the images.
    window : float
        Seconds.

    See Also
    --------
    decay_bound : Computes it.
    percept_obs.figures.error_norm : Draws it.

    Examples
    --------
    >>> from percept_obs import Camera, luenberger, record
    >>> from percept_obs.points.gramian import decay_bound
    >>> from percept_obs.points.scenarios import moving_body
    >>> scene = moving_body(1)
    >>> found = decay_bound(record(scene, 20, Camera(0.1)), luenberger(scene.form), 5)
    >>> found.contraction.round(3).tolist()
    [0.874, 0.823, 0.967, 0.902]
    """

    time: Array
    seen: Array
    feedback: Array
    window: float

    @property
    def contraction(self) -> Array:
        """Largest ratio of V = rho^T P rho at the end of each window to that at its beginning, shape (T,)."""
        return np.maximum(1 - 2 * self.seen / (1 + self.feedback) ** 2, 0.0)

    @property
    def rate(self) -> float:
        """Least rate in 1/s at which sqrt(V) decays, over all windows."""
        with np.errstate(divide="ignore"):
            return float(-np.log(self.contraction).mean() / (2 * self.window))


@checked
def decay_bound(recording: Recording, observer: LuenbergerObserver, window: float) -> DecayBound:
    """Return a bound on the decay of the error, from (14) as the proof of Theorem 3.4 uses it.

    With z = B C rho, (15) gives V(t) - V(t + T) >= 2 int |z|^2.  By (22), the error without corrections would have
    shown B C Phi rho(t) = z + K z, where K is the operator with the kernel B C Phi(s, tau) P^-1 C^T B^T.  So
    rho^T G rho <= (1 + |K|)^2 int |z|^2, and with G >= seen P the error shrinks by
    V(t + T) <= (1 - 2 seen / (1 + |K|)^2) V(t).  A small P makes the Gramian large relatively to it, but |K| as well:
    too much gain slows down.

    Parameters
    ----------
    recording : Recording
        With a truth.
    observer : LuenbergerObserver
        With a given P, that meets (15).
    window : float
        Seconds.

    Raises
    ------
    ValueError
        If there is no truth, P is computed or misses (15), or the window does not fit.

    See Also
    --------
    gramian : Information in the images of a window.

    Examples
    --------
    >>> from percept_obs import Camera, luenberger, record
    >>> from percept_obs.points.gramian import decay_bound
    >>> from percept_obs.points.scenarios import moving_body
    >>> scene = moving_body(1)
    >>> seen = record(scene, 20, Camera(0.1))
    >>> [round(decay_bound(seen, luenberger(scene.form, P), 5).rate, 3) for P in (0.1, 1.0, 10.0)]
    [0.002, 0.012, 0.013]
    """
    form, P = observer.form, observer.P
    if not form.fits(recording.view):
        raise ValueError(f"the recording shows the {recording.view.name}, but the observer is of {form.name}")
    if recording.truth is None:
        raise ValueError("the recording has no truth, so that the true images are not known")
    check_window(recording, window)
    time, images, slack = recording.time, _true_images(recording), slack_of(recording.time)
    # (15) is tested at as many instants as a window has intervals
    every = slice(None, None, max(1, len(time) // PARTS))
    if P.computed or not conditions(observer, time[every], images[every], P.at(time[every])).printed_holds:
        raise ValueError("the bound rests on (15): give a constant or scheduled P with A^T P + P A + P' <= 0")
    # windows side by side, so that their contractions multiply
    begins = time[0] + window * np.arange(int((time[-1] - time[0] + slack) / window))
    seen, feedback = np.empty(len(begins)), np.empty(len(begins))
    for k, begin in enumerate(begins):
        inside = np.flatnonzero((time >= begin - slack) & (time <= begin + window + slack))
        inside = inside[np.unique(np.linspace(0, len(inside) - 1, PARTS + 1).round().astype(int))]
        at = time[inside]
        shares = np.convolve(np.diff(at), [0.5, 0.5])  # of the trapezoidal rule
        steps = transitions(form, at)[:, :-1, :-1]
        Phi = np.stack([*accumulate(steps, lambda Phi, step: step @ Phi, initial=np.eye(form.states))])
        rows = form.rows(images[inside])
        # each instant weighted by the root of its share, so that sums of products are integrals
        shown = np.sqrt(shares)[:, None, None] * rows @ Phi
        weights = P.at(at)
        corrected = (
            np.linalg.inv(Phi) @ np.linalg.inv(weights) @ np.swapaxes(rows, 1, 2) * np.sqrt(shares)[:, None, None]
        )
        # a correction at one instant is missing from all later images
        size = rows.shape[1]
        operator = np.concatenate(list(shown)) @ np.concatenate(list(corrected), axis=1)
        # the kernel acts on later instants only; on its own one by half, as the trapezoidal rule has it
        later = np.kron(np.tri(len(at), k=-1) + np.eye(len(at)) / 2, np.ones((size, size)))
        G = np.einsum("tij,tik->jk", shown, shown)
        # with P = L L^T, the largest s with G >= s P is the least eigenvalue of L^-1 G L^-T
        half = np.linalg.inv(np.linalg.cholesky(weights[0]))
        seen[k] = np.linalg.eigvalsh(half @ G @ half.T)[0]
        # a sample sees what earlier corrections have changed, not later ones
        hidden = operator * later
        feedback[k] = np.sqrt(np.linalg.eigvalsh(hidden.T @ hidden)[-1])  # the norm, faster than by an SVD
    return DecayBound(begins, np.maximum(seen, 0.0), feedback, window)


def _true_images(recording: Recording) -> Array:
    """Images without noise where the truth is known, else the outputs; NaN where a point is not seen."""
    if recording.truth is None:
        return recording.outputs
    return np.where(recording.seen[..., None], recording.view.outputs(recording.truth), np.nan)


def _windows(recording: Recording, window: float, form: PointsForm, information: Callable[[Indices], Array]) -> Gramian:
    """Integrals over all windows that begin at a sample."""
    check_window(recording, window)
    used = np.arange(0, len(recording.time), max(1, int(len(recording.time) * form.states**2 / LARGEST_TABLE)))
    time = recording.time[used]
    begins, matrices = window_integrals(time, information(used), transitions(form, time)[:, :-1, :-1], window)
    states = None if recording.truth is None else recording.truth[used][begins]
    return Gramian(form.names, time[begins], matrices, window, states=states)
