"""The Cramer-Rao bound: the least covariance that the noise leaves to any unbiased observer, sample by sample."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile import Array, Flags
from percept_obs.compile.integrator import LONGEST_STEP
from percept_obs.observability.matching import System, matching_form
from percept_obs.observers import extended_kalman
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.tracking.linearised import Doubt, Linearised, linearisation, names_of, positions
from percept_obs.validation import checked, numbers, positive, require_definite

Prior = Mapping[str, float] | ArrayLike | None

HIDDEN_VARIANCE = next(gain.value for gain in extended_kalman.gains if gain.name == "hidden_variance")
"""Variance of the start in the hidden coordinates unless another one is given: the extended Kalman filter's."""


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Bound:
    """Least covariance of any unbiased observer at the samples of a recording, from `cramer_rao`.

    Parameters
    ----------
    form : PartitionedSystem
        Which outputs are measured.
    recording : Recording
        Along whose truth it holds.
    covariance : array of shape (K, n, n)
        After each sample, in the order of the form's coordinates.
    prediction : array of shape (K, n, n)
        Covariance at each sample without any samples but those that the start needs.
    information : array of shape (K, n, n)
        Fisher information about the start, gathered up to each sample; it leaves a doubt in the motion out.

    Raises
    ------
    WrongKind
        If an argument is of another kind.

    See Also
    --------
    Efficiency : Errors of runs against it.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, cramer_rao, pinhole, record, scenarios
    >>> seen = record(scenarios.ma2005_eq35(), 5, Camera(0.05, Gaussian(0.01)))
    >>> found = cramer_rao(seen, PerspectiveSystem(affine(), pinhole()))
    >>> found.relative[[0, 20, 100]].round(3).tolist()
    [2.5, 0.047, 0.003]
    """

    form: PartitionedSystem
    recording: Recording
    covariance: Array
    prediction: Array
    information: Array

    @property
    def time(self) -> Array:
        """Times of the samples in seconds, shape (K,)."""
        return self.recording.time

    @property
    def elapsed(self) -> Array:
        """Seconds since the first sample, shape (K,)."""
        return self.recording.elapsed

    @cached_property
    def deviation(self) -> Array:
        """Least standard deviations of the coordinates, shape (K, n)."""
        return _deviations(self.covariance)

    @cached_property
    def predicted_deviation(self) -> Array:
        """Standard deviations without samples, shape (K, n)."""
        return _deviations(self.prediction)

    def of(self, name: str) -> Array:
        """Least standard deviation of one coordinate, such as "y3", shape (K,).

        Raises
        ------
        ValueError
            If there is no such coordinate.
        """
        known = names_of(self.form)
        if name not in known:
            raise ValueError(f"there is no coordinate {name!r}; there are {', '.join(known)}")
        return np.asarray(self.deviation[:, known.index(name)])

    @property
    def relative(self) -> Array:
        """Least relative standard deviation of the distance, to first order, shape (K,)."""
        return self.deviation[:, -1] * self.recording.distance

    def kept(self) -> tuple[Array, Array]:
        """Standard deviations of hidden directions at the start after all samples, as shares of those before any.

        Returns
        -------
        shares : array of shape (n2,)
            Increasing; 1 where the samples tell nothing.
        directions : array of shape (n2, n2)
            Of the hidden coordinates at the start, by the recording's unit, one a column.
        """
        hidden = positions(self.form, self.form.hidden)
        root = np.linalg.cholesky(self.prediction[0])
        # (P0^-1 + J)^-1 with P0 = root root^T, without inverting P0
        after = root @ np.linalg.solve(np.eye(len(root)) + root.T @ self.information[-1] @ root, root.T)
        before = np.linalg.cholesky(self.prediction[0][np.ix_(hidden, hidden)])
        inverse = np.linalg.inv(before)
        values, vectors = np.linalg.eigh(inverse @ after[np.ix_(hidden, hidden)] @ inverse.T)
        return np.sqrt(np.clip(values, 0.0, 1.0)), (before @ vectors) * self.recording.scale[hidden, None]

    def __repr__(self) -> str:
        last = ", ".join(f"{name} {d:.3g}" for name, d in zip(names_of(self.form), self.deviation[-1], strict=True))
        return (
            f"<Bound of {', '.join(self.form.measured)} on {self.recording.source or 'a recording'}: least standard "
            f"deviations after {self.elapsed[-1]:.4g} s: {last}>"
        )


@checked
def cramer_rao(
    recording: Recording,
    system: System,
    prior: Prior = None,
    noise_variance: Mapping[str, float] | ArrayLike | None = None,
    doubt: Doubt = 0.0,
    step: float = LONGEST_STEP,
) -> Bound:
    """Cramer-Rao bound, which no unbiased observer beats, along the truth of a recording.

    For Gaussian noise and a start drawn from a normal distribution it is the covariance of a Kalman filter of the
    system linearised along the true trajectory.  It belongs to this one trajectory; averaged over trajectories drawn
    from the prior it would be the posterior bound.  Uniform noise has no bound of this kind: the one shown is that of
    Gaussian noise of the same variance.

    Parameters
    ----------
    recording : Recording
        With a truth; its samples count where they were not lost.
    system : PartitionedSystem, or PerspectiveSystem
        Which outputs are measured, on any surface; a perspective system stands for all image coordinates.
    prior : mapping of names to variances, or array of shape (n, n), optional
        What is known before the first sample.  A mapping names all measured outputs or none: if none, they begin at
        their first sample, with the noise's variance, and that sample tells nothing else.  Hidden coordinates that
        it leaves out have the variance that the extended Kalman filter begins with.  An array is the covariance of
        all coordinates, in the form's order.
    noise_variance : float, or array of shape (m,), (m, m) or (K, m, m), optional
        Variance of the noise in each measured output, or its covariance, which may change from sample to sample; the
        recording's when left out.
    doubt : float, or mapping of names to floats
        Doubt in the motion: variance a second of white noise in the rate of every coordinate, or in that of the
        coordinates, and in the parameters of the motion such as "b1", that a mapping names.
    step : float
        Longest step in seconds with which the linearised system is integrated.

    Returns
    -------
    Bound
        Least covariances of the coordinates after each sample, shape (K, n, n).

    Raises
    ------
    ValueError
        If system and recording do not fit, there is no truth, or a variance makes no sense.

    See Also
    --------
    efficiency : How near runs of an observer come to it.
    bound_map : The bound at each place of the image.

    Notes
    -----
    Van Trees, Detection, Estimation, and Modulation Theory, part I (1968), section 2.4; Taylor, The Cramer-Rao
    estimation error lower bound computation for deterministic nonlinear systems, IEEE Trans. Automatic Control 24
    (1979).

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, cramer_rao, pinhole, record, scenarios
    >>> recording = record(scenarios.ma2005_eq35(), 20, Camera(0.05, Gaussian(0.01)))
    >>> system = PerspectiveSystem(affine(), pinhole())
    >>> both, one = (cramer_rao(recording, form) for form in (system, system.measure("y1")))
    >>> print(f"{both.of('y3')[-1]:.1e} {one.of('y3')[-1]:.1e}")
    3.3e-05 3.9e-05
    """
    form = matching_form(system, recording)
    positive(step=step)
    noise = _noise(recording, form, noise_variance)
    start, from_sample = _start(form, prior, noise[0], HIDDEN_VARIANCE / recording.scale**2)
    assert recording.truth is not None
    with np.errstate(all="ignore"):  # overflow is reported below
        along = linearisation(form, recording, doubt, step)(recording.truth)
    if from_sample and not along.seen[0].all():
        raise ValueError(
            "the first sample was lost, so that the measured outputs need a prior; give one, or cut it off"
        )
    used = along.seen.copy()
    used[0] &= not from_sample
    with np.errstate(all="ignore"):
        found = [_covariances(along, start, noise, each) for each in (used, np.zeros_like(used))]
        found.append(_information(along, noise, used))
    if not all(np.isfinite(each).all() for each in found):
        raise ValueError(
            "the bound leaves every range of numbers on the way: the doubt, the noise_variance or the prior is too "
            "large or too small, or the step too long"
        )
    return Bound(form, recording, *found)


def _information(along: Linearised, noise: Array, used: Flags) -> Array:
    """Fisher information about the start, gathered up to each sample, shape (K, n, n)."""
    n, (count, m) = along.transitions.shape[-1], used.shape
    since = np.stack([*accumulate(along.transitions, lambda Phi, each: each @ Phi, initial=np.eye(n))])
    # a lost sample has no weight: its row and its column are taken out before the covariance is inverted
    both = used[:, :, None] & used[:, None]
    weights = np.where(both, np.linalg.inv(np.where(both, noise, np.eye(m))), 0.0)
    rows = since[:, along.measured]
    return np.asarray(np.cumsum(np.swapaxes(rows, 1, 2) @ weights @ rows, axis=0)).reshape(count, n, n)


def _covariances(along: Linearised, start: Array, noise: Array, used: Flags) -> Array:
    """Covariance of a Kalman filter after each sample, shape (K, n, n), corrected by the samples that are used."""
    P, found = start, np.empty((len(used), *start.shape))
    for k, seen in enumerate(used):
        if k:
            Phi = along.transitions[k - 1]
            P = Phi @ P @ Phi.T + along.spreads[k - 1]
        if seen.any():
            R, rows = noise[min(k, len(noise) - 1)][np.ix_(seen, seen)], along.measured[seen]
            shared = P[:, rows]
            P = P - shared @ np.linalg.solve(shared[rows] + R, shared.T)
        P = (P + P.T) / 2
        found[k] = P
    return found


def _deviations(covariances: Array) -> Array:
    """Standard deviations, shape (K, n)."""
    covariances = numbers(covariances, "the covariances", "K", "n", "n")
    return np.sqrt(np.maximum(np.diagonal(covariances, axis1=1, axis2=2), 0.0))


def _noise(recording: Recording, form: PartitionedSystem, variance: Mapping[str, float] | ArrayLike | None) -> Array:
    """Covariance of the noise, shape (1, m, m) or (K, m, m)."""
    m, count = len(form.measured), len(recording.time)
    if variance is None and not recording.effective_variance:
        raise ValueError(
            f"the recording's noise variance is {recording.noise_variance}, and without noise there is no bound; give "
            "noise_variance, or record with noise: Camera(noise=Gaussian(0.01))"
        )
    if isinstance(variance, Mapping):
        if set(variance) != set(form.measured):
            raise ValueError(f"noise_variance names {', '.join(variance)}; name all of {', '.join(form.measured)}")
        variance = [variance[name] for name in form.measured]
    values = np.asarray(recording.effective_variance if variance is None else variance, dtype=float)
    if values.ndim < 2 and values.shape in ((), (m,)):
        values = np.diag(np.broadcast_to(values, m))
    if values.shape not in ((m, m), (count, m, m)):
        raise ValueError(
            f"the noise_variance has shape {values.shape}; expected a number, ({m},), ({m}, {m}) or ({count}, {m}, {m})"
        )
    values = values.reshape(-1, m, m)
    require_definite("the noise_variance", values)
    return values


def _start(form: PartitionedSystem, prior: Prior, noise: Array, hidden: Array) -> tuple[Array, bool]:
    """Covariance at the first sample, and True if the measured outputs begin at that sample."""
    n = len(form.coordinates)
    if prior is not None and not isinstance(prior, Mapping):
        start = np.array(prior, dtype=float)
        if start.shape != (n, n):
            raise ValueError(f"the prior has shape {start.shape}; expected ({n}, {n}), or variances by their names")
        require_definite("the prior", start)
        return start, False
    variances = dict(prior or {})
    unknown = set(variances) - set(names_of(form))
    if unknown:
        raise ValueError(f"the prior names {', '.join(sorted(unknown))}; there are {', '.join(names_of(form))}")
    named = [name in variances for name in form.measured]
    if any(named) and not all(named):
        raise ValueError(f"the prior names some of {', '.join(form.measured)}; name all measured outputs or none")
    start = np.diag([variances.get(*each) for each in zip(names_of(form), hidden.tolist(), strict=True)])
    if not any(named):
        measured = positions(form, form.measured)
        start[np.ix_(measured, measured)] = noise
    require_definite("the prior", start)
    return start, not any(named)
