"""Consistency of a filter: the covariance that it claims, tested by its innovations."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from percept_obs.compile import Array
from percept_obs.system.signal import from_the_start
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import diverged
from percept_obs.validation import checked, positive

__all__ = ["Consistency", "check_consistency"]

DEVIATIONS = 2.0
"""Claimed standard deviations to either side of an estimate: 95 % of a normal distribution."""

CONFIDENCE = 0.95
"""Probability of the two-sided intervals of the test."""

JUDGEMENTS = MappingProxyType(
    {
        "consistent": "the innovations are as large as the filter claims",
        "overconfident": "the innovations are larger than the filter claims, so doubt the motion or the samples more",
        "conservative": "the innovations are smaller than the filter claims, so doubt the samples less",
    }
)
"""Meaning of each judgement."""


def claimed_interval(run: Run) -> tuple[Array, Array]:
    """Ends of the interval of two claimed standard deviations around the estimate, of shape (K, n) each.

    They are NaN where the run has diverged.
    """
    variances = np.diagonal(run.covariance, axis1=1, axis2=2)
    spread = DEVIATIONS * np.sqrt(np.maximum(variances, 0))  # round-off may leave one a little below zero
    return run.estimate - spread, run.estimate + spread


def claimed_distance(run: Run) -> tuple[Array, Array]:
    """Ends of the `claimed_interval` of the distance in metres, of shape (K,) each.

    An interval of the inverse distance that reaches zero stands for distances without an upper end.  The high one is
    infinite where the interval reaches zero, and both are where it is not positive at all; they are NaN where the run
    has diverged.
    """
    low, high = (end[:, -1] for end in claimed_interval(run))
    nearest, farthest = (np.divide(1, end, out=np.full_like(end, np.inf), where=~(end <= 0)) for end in (high, low))
    return nearest, farthest


@checked
@dataclass(frozen=True, eq=False)
class Consistency:
    """Test of the normalised innovations squared (NIS) of a run.

    If the filter's claims are right they are distributed as chi-squared with `outputs` degrees of freedom, each
    independent of the others, so N times the mean of N of them is chi-squared with N `outputs`.

    Parameters
    ----------
    time : array of shape (K,)
        Times of the samples of all outputs, in seconds.
    nis : array of shape (K,)
        See `Run.nis`.
    outputs : int
        Number of measured outputs, the expected mean.
    samples : int
        N, the number of samples that a moving average holds.
    whitened : array of shape (K, outputs)
        See `Run.whitened`.

    See Also
    --------
    check_consistency : Computes it.
    percept_obs.figures.consistency : Draws it.

    Examples
    --------
    >>> white = np.random.default_rng(0).normal(size=(500, 2))
    >>> found = Consistency(np.arange(500.0), (white**2).sum(axis=1), 2, 50, white)
    >>> found.judgement, found.white
    ('consistent', True)
    """

    time: Array
    nis: Array
    outputs: int
    samples: int
    whitened: Array

    def __post_init__(self) -> None:
        positive(outputs=self.outputs, samples=self.samples)

    @property
    def averages(self) -> Array:
        """Mean of each NIS and the N - 1 before it, shape (K - N + 1,)."""
        return np.asarray(sliding_window_view(self.nis, self.samples).mean(axis=1))

    @property
    def average_time(self) -> Array:
        """Last time of each moving average in seconds, shape (K - N + 1,)."""
        return self.time[self.samples - 1 :]

    @property
    def mean(self) -> float:
        """Mean of all NIS."""
        return float(self.nis.mean())

    def interval(self, count: int) -> tuple[float, float]:
        """Interval of the mean of `count` NIS, with the probability 0.95."""
        from scipy.stats import chi2

        positive(count=count)
        low, high = chi2.interval(CONFIDENCE, count * self.outputs)
        return float(low) / count, float(high) / count

    @property
    def autocorrelation(self) -> float:
        """Correlation of each normalised innovation with the one before it, over all outputs; 0 is expected."""
        return float((self.whitened[1:] * self.whitened[:-1]).sum() / (self.whitened**2).sum())

    @property
    def white(self) -> bool:
        """True if the autocorrelation lies in its interval for white noise, with the probability 0.95."""
        from scipy.stats import norm

        return bool(abs(self.autocorrelation) <= norm.ppf((1 + CONFIDENCE) / 2) / np.sqrt(self.whitened.size))

    @property
    def judgement(self) -> str:
        """One of "consistent", "overconfident" (innovations are too large) and "conservative" (too small)."""
        low, high = self.interval(len(self.nis))
        return "overconfident" if self.mean > high else "conservative" if self.mean < low else "consistent"

    @property
    def summary(self) -> str:
        """The judgement in words, with the mean NIS."""
        low, high = self.interval(len(self.nis))
        return (
            f"{self.judgement}: {JUDGEMENTS[self.judgement]}. The mean NIS of {len(self.nis)} samples is "
            f"{self.mean:.3g}; {self.outputs} is expected, and {low:.3g} to {high:.3g} with a probability of "
            f"{100 * CONFIDENCE:g} %"
        )

    def verdict(self) -> str:
        """The summary, the share of moving averages inside their interval, and the whiteness."""
        lowest, highest = self.interval(self.samples)
        inside = np.mean((self.averages >= lowest) & (self.averages <= highest))
        means = "white" if self.white else "not white: each tells of the next, so that they hold more than noise"
        return (
            f"{self.summary}. Of the moving averages of {self.samples} samples {100 * inside:.0f} % lie in their "
            f"interval, {lowest:.3g} to {highest:.3g}. The innovations are {means}; neighbours have the correlation "
            f"{self.autocorrelation:.2g}"
        )

    def __repr__(self) -> str:
        return f"<Consistency: {self.verdict()}>"


@checked
def check_consistency(run: Run, samples: int = 50, after: float = 0.0) -> Consistency:
    """Return a test whether a filter's innovations are as large as it claims.

    It needs no truth, so it works on real data.  It cannot find errors that leave no trace in the innovations, such as
    a wrong scale.

    Parameters
    ----------
    run : Run
        Of an observer that claims a covariance and has a measurement update.
    samples : int
        Number of samples in a moving average, from 1 to that of the run.
    after : float
        Seconds to leave out at the beginning, such as a transient that the linearisation does not cover.

    Returns
    -------
    Consistency
        Moving averages of the innovations' squares and their intervals, with a `verdict` in words.

    Raises
    ------
    ValueError
        If the observer claims no covariance, the run diverged, or a number is out of range.

    See Also
    --------
    percept_obs.studies.tuning.tune_by_likelihood : Chooses gains whose claims hold.
    percept_obs.figures.consistency : Draws the moving averages.

    Notes
    -----
    Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation (2001), section 5.4.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, check_consistency, ekf, pinhole, record
    >>> from percept_obs import scenarios, track
    >>> recording = record(scenarios.ma2005_eq35(), 20, Camera(0.02, Gaussian(0.01)))
    >>> run = track(recording, ekf(PerspectiveSystem(affine(), pinhole()), noise_variance=1e-4))
    >>> check_consistency(run, after=5).verdict().partition(".")[0]
    'consistent: the innovations are as large as the filter claims'
    """
    if not after >= 0:
        raise ValueError(f"after is {after} s; it must not be negative")
    if run.diverged_at is not None:
        raise ValueError(f"the run {diverged(run.diverged_at - run.time[0])}, so that it is not consistent")
    nis = run.nis
    counted = np.isfinite(nis) & from_the_start(run.elapsed, after)
    there = int(counted.sum())
    if not 1 <= samples <= there:
        raise ValueError(f"a moving average of {samples} samples was asked for; there are {there} after {after} s")
    outputs = len(run.observer.form.x1)
    return Consistency(run.time[counted], nis[counted], outputs, samples, run.whitened[counted])
