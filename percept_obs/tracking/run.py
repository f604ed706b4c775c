"""Run of an observer on a recording: estimates, errors, consistency, and its verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from percept_obs.compile import Array, Flags, Indices, vectorised
from percept_obs.recording import Recording
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.system.view import View
from percept_obs.tracking.grid import Hold
from percept_obs.tracking.information import (
    LIMITS,
    Fit,
    Information,
    by_smoothing,
    correlation,
    information_at_end,
    one_point,
    relative_deviation,
)
from percept_obs.tracking.smoothing import doubts_of
from percept_obs.tracking.verdict import (
    REMEDY,
    TOLERANCE,
    VERDICTS,
    Outcome,
    Trust,
    in_words,
    judge_tolerance,
    number,
    outcome,
)
from percept_obs.validation import checked, numbers, positive


@checked
@dataclass(frozen=True, eq=False)
class Run:
    """An observer's estimates at the samples of a recording.

    Parameters
    ----------
    recording : Recording
        That it followed.
    observer : Observer, FunctionObserver, or LuenbergerObserver for several points
        That ran.
    estimate : array of shape (K, n)
        Estimates of the view's coordinates; NaN from `diverged_at` on.
    state : array of shape (K, s)
        The observer's state, with lengths by the recording's unit.
    diverged_at : float or None
        Time at which the state stopped being finite, by the recording's clock.
    hold : "zero", "first" or "exact"
        Hold of the samples, as in `track`.
    resets : array of shape (R,)
        Times in seconds by the recording's clock at which the estimate was reset.
    unobservable : array of shape (K,) of int
        Number of the `Observer.unobservable` that hides the hidden coordinates, from 1; 0 where they are estimated.

    Raises
    ------
    ValueError
        If an argument is of another kind or shape.

    See Also
    --------
    track : Makes it.
    percept_obs.points.PointsRun : Of many points.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios, track
    >>> run = track(record(scenarios.ma2005_eq35(), 20), ibo(PerspectiveSystem(affine(), pinhole())))
    >>> print(f"{run.settling_time(0.1):.1f} s")
    1.9 s
    >>> print(f"{run.relative_error[-1]:.0e}")
    2e-04
    """

    recording: Recording
    observer: Any
    estimate: Array
    state: Array
    diverged_at: float | None
    hold: Hold
    resets: Array
    unobservable: Indices
    remedy: ClassVar[str] = REMEDY
    """Advice if it diverged."""

    def __post_init__(self) -> None:
        for name, columns in (("estimate", len(self.view.coordinates)), ("state", "s")):
            numbers(getattr(self, name), f"values of {name}", len(self.time), columns).setflags(write=False)

    @property
    def time(self) -> Array:
        """Times of the samples in seconds, shape (K,)."""
        return self.recording.time

    @property
    def elapsed(self) -> Array:
        """Seconds since the first sample, shape (K,)."""
        return self.recording.elapsed

    @property
    def view(self) -> View:
        """View of the estimated coordinates."""
        return self.recording.view

    @property
    def truth(self) -> Array:
        """True coordinates, shape (K, n); raises ValueError if the recording has none."""
        if self.recording.truth is None:
            raise ValueError("the recording has no truth to compare with; give it one, or look at the innovation")
        return self.recording.truth

    @cached_property
    def error(self) -> Array:
        """Truth minus estimate, shape (K, n)."""
        return self.truth - self.estimate

    @cached_property
    def innovation(self) -> Array:
        """Samples minus estimates of the measured outputs, shape (K, n1) or (K, p, m); NaN where either is not seen."""
        outputs = [symbol.name for symbol in self.view.image_coordinates]
        measured = self.measured
        samples = self.recording.outputs[..., [self.recording.names.index(name) for name in measured]]
        return samples - self.view.outputs(self.estimate)[..., [outputs.index(name) for name in measured]]

    @property
    def measured(self) -> tuple[str, ...]:
        """Names of the outputs that the observer used."""
        return tuple(self.observer.form.measured)

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the estimate that the observer claims, shape (K, n, n); raises ValueError without."""
        observer = self.observer
        if observer.covariance is None:
            raise ValueError(f"the {observer.name} observer claims no covariance; the extended Kalman filter does")
        entries = vectorised(observer.equations.state, list(observer.covariance))(*self.state.T)
        inside = np.stack(entries, axis=-1).reshape(len(self.state), *observer.covariance.shape)
        return inside / np.outer(self.recording.scale, self.recording.scale)

    @cached_property
    def nis(self) -> Array:
        """Normalised innovation squared (NIS): before the update, over its claimed variance, shape (K,).

        Its mean is the number of measured outputs if the claims are right; NaN where a sample was lost or is the
        start itself, or where P equals R to rounding.  Raises as `whitened` does.
        """
        return np.asarray((self.whitened**2).sum(axis=1))

    @cached_property
    def whitened(self) -> Array:
        """Innovations before the update, normalised to the identity as their covariance, shape (K, n1).

        With the residual r after the update, its covariance R - P and r = R S^-1 (innovation), they are
        (R - P)^(-1/2) r: a rotation of S^(-1/2) (innovation), with the same squared norm, the `nis`.

        Raises
        ------
        ValueError
            If the observer claims no covariance or has no measurement update.
        """
        values, vectors = self._residual_covariance
        across = np.swapaxes(vectors, 1, 2) @ self.innovation[:, :, None]
        return np.asarray((vectors @ (across / np.sqrt(values)[:, :, None]))[:, :, 0])

    @cached_property
    def log_likelihood(self) -> Array:
        """Logarithm of the probability density that the observer gives each innovation, shape (K,); NaN as `nis`.

        Raises as `whitened` does.
        """
        values, _ = self._residual_covariance
        log_det = (2 * math.log(self._noise_variance) - np.log(values)).sum(axis=1)  # of S = R (R - P)^-1 R
        return np.asarray(-(self.nis + log_det + values.shape[1] * math.log(2 * math.pi)) / 2)

    @cached_property
    def _residual_covariance(self) -> tuple[Array, Array]:
        """Eigenvalues, NaN unless positive, and eigenvectors of the residuals' covariance R - P after an update."""
        covariance, measured = self.covariance, self._columns(self.measured)
        claimed = covariance[:, measured][:, :, measured]
        residual = self._noise_variance * np.eye(len(measured)) - claimed
        finite = np.asarray(np.isfinite(residual).all(axis=(1, 2)))
        values, vectors = np.linalg.eigh(np.where(finite[:, None, None], residual, np.eye(len(measured))))
        return np.where(finite[:, None] & (values > 0), values, np.nan), vectors

    @property
    def _noise_variance(self) -> float:
        variance = dict((gain.name, gain.value) for gain in self.observer.gains).get("noise_variance")
        if variance is None or not self.observer.equations.update:
            raise ValueError(f"the {self.observer.name} observer has no measurement update")
        return variance

    def nees(self, *names: str) -> Array:
        """Normalised estimation error squared (NEES): the squared error over its claimed variance, shape (K,).

        Its mean is the number of coordinates if the claims are right; its median is 0.45 for one.

        Parameters
        ----------
        *names : str
            Coordinates; all hidden ones when left out.

        Raises
        ------
        ValueError
            If there is no truth or no such coordinate, or the observer claims no covariance.
        """
        covariance, columns = self.covariance, self._columns(names)
        claimed = covariance[:, columns][:, :, columns]
        finite = np.asarray(np.isfinite(claimed).all(axis=(1, 2)) & (np.linalg.det(claimed) != 0))
        claimed = np.where(finite[:, None, None], claimed, np.nan)
        error = self.error[:, columns, None]
        return np.asarray((np.swapaxes(error, 1, 2) @ np.linalg.solve(claimed, error))[:, 0, 0])

    @cached_property
    def points(self) -> Array:
        """Estimated positions in metres, shape (K, 3) or (K, p, 3); see `distance` for those that are not finite."""
        known = np.isfinite(self.estimate).all(axis=1)
        located = self.view.locate(self.estimate)
        return np.where(known.reshape(-1, *(1,) * (located.ndim - 1)), located, np.nan)

    @cached_property
    def distance(self) -> Array:
        """Estimated depth or range in metres, shape (K,) or (K, p).

        Infinite where the estimated inverse distance is not positive, so that the point would not be in front of the
        camera; NaN where there is no finite estimate, as from `diverged_at` on.
        """
        inverse = self.view.inverse(self.estimate)
        none = np.where(np.isfinite(inverse), np.inf, np.nan)
        return np.divide(1, inverse, out=none, where=np.isfinite(inverse) & (inverse > 0))

    @cached_property
    def relative_error(self) -> Array:
        """Relative error of the distance, or of all that the view seeks, shape (K,); the verdict judges it.

        Infinite where the estimate is infinitely far away or behind the camera, NaN where there is none.
        """
        return self.view.relative_error(self.truth, self.estimate, self.recording.motion.known(self.time))

    @cached_property
    def effective_variance(self) -> float:
        """Variance of white noise that harms an estimate as much as this run's residuals; at least the recording's.

        Errors of poses that stay alike for long are found so, of which nobody told: take it as the `noise_variance` of
        a second run.
        """
        settled = slice(len(self.time) // 4, None)  # before, the estimate is still finding its way
        left = self.innovation.reshape(len(self.time), -1)[settled]
        variance = float(np.nanmean(left**2)) if np.isfinite(left).any() else math.inf
        variance *= correlation(np.nan_to_num(left), self.time[settled])
        return max(variance, self.recording.effective_variance or 0.0)

    @cached_property
    def information(self) -> Information:
        """Information in the samples at the end, independent of observer and truth."""
        return information_at_end(self._least_squares, self.elapsed, self.estimate[-1])

    @property
    def _least_squares(self) -> Fit:
        form, recording = self.observer.form, self.recording
        if isinstance(recording.view, ImagingSurface):
            return one_point(form, recording)
        return by_smoothing(form, recording, doubts_of(self.observer, recording.motion, recording.unit))

    def to_pandas(self) -> Any:
        """Return the recording's table with estimates as estimated_y1, and what the observer claims as deviation_y1."""
        table, names = self.recording.to_pandas(), [symbol.name for symbol in self.view.coordinates]
        table[[f"estimated_{name}" for name in names]] = self.estimate
        if self.observer.covariance is not None:
            claimed = np.sqrt(np.maximum(np.diagonal(self.covariance, axis1=1, axis2=2), 0))
            table[[f"deviation_{name}" for name in names]] = claimed
        return table

    def trust(self, tolerance: float = TOLERANCE) -> Trust:
        """Judge the last estimate without a truth.

        It is trusted where the samples by themselves tell what is sought to within the tolerance, with two standard
        deviations, and the observer claims no more than that.  The squares of one standard deviation and of the
        distance to the least-squares estimate must add up to no more, either.  Doubts of the known motion widen the
        deviation: its direction may be wrong by half a degree, its scale may drift, and longer windows may tell
        something else.  What a fit of all samples leaves does so as well, unless it looks like noise, by as much as it
        moves the estimate if all of it leans one way; that takes two fits more.  So noise of the velocities that nobody
        told costs trust: of estimates within 5 % two thirds are flagged then, and one in twenty otherwise.  A wrong
        scale of the whole motion leaves no trace in the samples, so that all rests on the length of the translation.

        Parameters
        ----------
        tolerance : float
            Relative, as for `outcome`.

        Raises
        ------
        ValueError
            If the tolerance is not positive, or infinite.

        Examples
        --------
        >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios, track
        >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
        >>> track(record(scenarios.ma2005_eq35(), 5), ibo(form)).trust().kind
        'agrees'
        """
        judge_tolerance(tolerance)
        known, last, view = self.recording.motion.known(self.time[-1:]), self.estimate[-1], self.view
        said = partial(Trust, judged=view.judged, length=float(self.elapsed[-1]))
        if not np.isfinite(last).all():
            return said("not yet" if self.unobservable.all() else "no estimate")
        if not view.point_shape and not view.inverse(last) > 0:
            return said("nowhere")
        if self.recording.doubt:
            return said("doubted", doubt=self.recording.doubt)
        speeds = self.recording.landmark.error
        if speeds > tolerance / 2:
            return said("doubted", doubt=self.recording.landmark.sentence)
        if self.observer.covariance is not None:
            claims = np.sqrt(np.maximum(np.diagonal(self.covariance[-1]), 0))
            if self.observer.equations.update and (assumed := self._noise_variance) > 0:
                claims *= math.sqrt(max(1.0, self.effective_variance / assumed))
            said = partial(said, claimed=math.hypot(relative_deviation(view, last, claims, known), speeds))
        found, claimed = self.information, said.keywords.get("claimed")
        apart = found.disagreement(view, known)
        widened = math.hypot(found.deviation, apart / 2, speeds, found.left / 2)
        small = max(apart, found.left) <= tolerance
        said = partial(said, information=replace(found, deviation=widened if small else found.deviation))
        if not 2 * found.deviation <= tolerance:
            return said("vague" if found.deviation < LIMITS.nothing else "hidden")
        if (drift := (found, *found.longer)[-1].drift) > tolerance / 2:
            return said("drifting", disagreement=drift)
        if apart > tolerance:
            return said("contradicted", disagreement=apart)
        if found.left > tolerance:
            return said("unexplained", disagreement=found.left)
        if 2 * widened > tolerance:
            return said("vague")
        difference = float(view.relative_error(found.estimate[None], last[None], known)[0])
        if claimed is not None and not 2 * claimed <= tolerance:
            return said("wide", difference=difference)
        agrees = math.hypot(difference, widened) <= tolerance
        return said("agrees" if agrees else "differs", difference=difference)

    @cached_property
    def unobservable_intervals(self) -> list[tuple[float, float]]:
        """First and last time in seconds of every interval in which the hidden coordinates have no estimate.

        Their estimates are NaN finite, although the observer runs on; `reasons` says why.
        """
        return [(float(self.time[k]), float(self.time[end - 1])) for k, end in self._gaps]

    @property
    def reasons(self) -> list[str]:
        """Reason for each of the `unobservable_intervals`."""
        return [self.observer.unobservable[self.unobservable[k] - 1].reason for k, _ in self._gaps]

    @cached_property
    def _gaps(self) -> list[tuple[int, int]]:
        """First sample of every unobservable interval, and the first one after it."""
        edges = np.flatnonzero(np.diff(self.unobservable, prepend=0, append=0))
        return [(int(k), int(end)) for k, end in pairwise(edges) if self.unobservable[k]]

    def outcome(self, tolerance: float = TOLERANCE, *names: str) -> Outcome:
        """Outcome of the run: converged or not, and when.

        Parameters
        ----------
        tolerance : float
            Bound on the `relative_error`, or on the absolute errors of the named coordinates; positive.
        *names : str
            Coordinates whose absolute error is asked for.

        Raises
        ------
        ValueError
            If there is no truth, or the tolerance or a name makes no sense.
        """
        if names:
            positive(tolerance=tolerance)
        else:
            judge_tolerance(tolerance)
        error = np.abs(self.error[:, self._columns(names)]).max(axis=1) if names else self.relative_error
        known = self._known
        if not known.any():
            raise ValueError("the truth is NaN at every sample, so that there is nothing to compare with")
        length = float(self.elapsed[-1])
        found = outcome(self.elapsed[known], error[known], tolerance, length)
        return found if self.diverged_at is None else replace(found, kind="diverged", settled=math.inf)

    def settling_time(self, tolerance: float = TOLERANCE, *names: str) -> float:
        """Time at which the error entered the tolerance for good, in seconds since the first sample; see `outcome`."""
        return self.outcome(tolerance, *names).settled

    def rms(self, begin: float = -math.inf, end: float = math.inf, *names: str) -> float:
        """Root mean square of the error between two times of its clock, over the hidden coordinates or those named."""
        inside = (self.time >= begin) & (self.time <= end) & self._known
        if not inside.any():
            raise ValueError(f"no sample with a truth lies between {begin} and {end} s")
        return float(np.sqrt(np.mean(self.error[inside][:, self._columns(names)] ** 2)))

    def verdict(self, tolerance: float = TOLERANCE, *names: str) -> str:
        """Verdict in words; times count from the first sample.

        An estimate has converged if its error stayed within the tolerance for at least the last tenth of the run.

        Parameters
        ----------
        tolerance, *names
            See `outcome`.
        """
        if self.diverged_at is not None:
            time = number(self.diverged_at - self.time[0])
            return f"{VERDICTS['diverged'].format(time=time)}{VERDICTS['grew']}; {self.remedy}"
        if self.recording.truth is None or not self._known.any():
            said = VERDICTS["followed"].format(time=number(self.elapsed[-1]))
            said += "" if names else self.trust(tolerance).clause
        elif self.unobservable.all():
            said = VERDICTS["not yet"].format(window=number(self.elapsed[-1]), judged=self.view.judged)
        else:
            said = in_words(self.outcome(tolerance, *names), ", ".join(names) or self.view.judged, tolerance, names)
        return said + self._resets_and_gaps()

    def _resets_and_gaps(self) -> str:
        """Text of resets and of intervals without an estimate."""
        said, begun = "", self.time[0]
        if len(self.resets):
            which = "reset once" if len(self.resets) == 1 else "reset often"
            said = VERDICTS[which].format(count=len(self.resets), time=number(self.resets[0] - begun))
        for reason in dict.fromkeys(self.reasons):
            gaps = [gap for gap, why in zip(self.unobservable_intervals, self.reasons, strict=True) if why == reason]
            begin, end = (number(time - begun) for time in gaps[0])
            which = "short gap" if begin == end else "gap"
            said += VERDICTS[which].format(begin=begin, end=end, reason=reason)
            if len(gaps) > 1:
                said += VERDICTS["one more gap" if len(gaps) == 2 else "more gaps"].format(count=len(gaps) - 1)
        return said

    @property
    def _known(self) -> Flags:
        """Samples at which the truth is known."""
        return np.asarray(np.isfinite(self.truth).all(axis=1))

    def _columns(self, names: Sequence[str]) -> list[int]:
        """Positions of named coordinates, of all hidden ones without names."""
        known = [symbol.name for symbol in self.observer.form.coordinates]
        unknown = [name for name in names if name not in known]
        if unknown:
            raise ValueError(f"there is no coordinate {', '.join(unknown)}; there are {', '.join(known)}")
        if len(set(names)) < len(names):
            raise ValueError(f"a coordinate stands twice in {', '.join(names)}; name each once")
        return [known.index(name) for name in names or getattr(self.observer.form, "hidden", known)]

    def __repr__(self) -> str:
        return f"<Run of the {self.observer.name} observer on {self.recording.source}: {self.verdict()}>"
