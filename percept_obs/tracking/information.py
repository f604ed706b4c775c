"""Information in the samples at the end of a run, by least squares: it needs neither a truth nor the observer."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.state_view import StateView
from percept_obs.system.view import View
from percept_obs.tracking.doubts import DOUBTS, images_backwards
from percept_obs.tracking.linearised import outputs_of, positions
from percept_obs.tracking.smoothing import shows_scale, smoothed, usual_start


@dataclass(frozen=True)
class Limits:
    """When samples tell enough, and what of their noise is known before."""

    enough: float = 0.02  # relative deviation at which a window is long enough: longer ones add the motion's errors
    nothing: float = 1.0  # relative deviation from which on samples tell nothing: the distance may be any
    fewest: int = 20  # samples in the shortest window
    longer: int = 3  # windows twice as long each, by which the known motion is tested once one is long enough
    surely: float = 3.5  # deviations of chance by which residuals are more alike than white noise: one in 4000 runs
    correlated: float = 0.5  # seconds up to which errors of samples are asked for their correlation
    unexplained: float = 1.5  # times the noise that is said, which few know better: what is left beyond it is not noise
    alike: float = 0.3  # correlation of residuals in a row, beyond which they are not, where no noise is said
    wild: float = 9.0  # usual residuals, six deviations of normal noise, beyond which a sample is an exception,
    most_wild: float = 0.15  # and the share of them beyond which they are none
    camera: float = 1e-4  # standard deviation in focal lengths of the best camera: a twentieth of a pixel
    finest: float = 1e-6  # noise of the best measurement, over the output's size: no camera is better
    rounding: float = 1e-7  # share of a column's norm below which differences of nearly equal numbers are rounding
    small: float = 1e-4  # relative change of a coordinate for a difference quotient


LIMITS = Limits()


@dataclass(frozen=True, eq=False)
class Information:
    """Least-squares estimate of the coordinates at the last sample, from the samples of the last seconds.

    The deviation is the relative standard deviation of what is judged, infinite where samples tell nothing; `unexcited`
    are the seconds at the end in which they do.  What is `left` of all samples, if it does not look like noise, moves
    what is judged by this relative error at most; it is infinite where that is not known.  The drift is the change of
    the known translation's scale, over the whole recording, of which the samples leave no doubt.  Estimates from longer
    windows agree if the motion is as it is known.
    """

    estimate: Array
    deviation: float
    window: float
    unexcited: float
    left: float = 0.0
    drift: float = 0.0
    longer: tuple[Information, ...] = ()

    def disagreement(self, view: View, known: Array) -> float:
        """Relative distance to the estimates from longer windows, less what noise explains; infinite if they are lost.

        Independent errors add by their squares.
        """
        found = 0.0
        for other in self.longer:
            if not other.deviation < LIMITS.nothing:
                return math.inf
            apart = float(view.relative_error(self.estimate[None], other.estimate[None], known)[0])
            found = max(found, apart**2 - self.deviation**2 - other.deviation**2)
        return math.sqrt(found)


Fit = Callable[[int, list[Array]], tuple[Array, float, float, float]]
"""Least squares on the samples from one on, from the best of some initial guesses; returns coordinates at the end,
their relative deviation, the relative error that is left if it is of all samples, and the drift of scale that they
surely tell."""


def looks_like_noise(left: float, correlation: float, noise: float | None) -> bool:
    """Return True if residuals are as small as the noise is said to be, or white, where nothing is said of it.

    They are given by their root mean square and the correlation of neighbours in time.
    """
    if noise is not None:
        return left <= LIMITS.unexplained * max(noise, LIMITS.camera)
    return left <= LIMITS.camera or correlation <= LIMITS.alike


def information_at_end(fit: Fit, elapsed: Array, guess: Array) -> Information:
    """Information from the shortest window at the end that suffices, each one tried twice as long as the last.

    The guess has the coordinates at the last sample, such as an observer's; NaN where there are none.
    """
    guesses = [guess] if np.isfinite(guess).all() else []
    count, length, unexcited = len(elapsed), min(LIMITS.fewest, len(elapsed)), 0.0
    found: list[Information] = []
    while True:
        first = count - length
        window = float(elapsed[-1] - elapsed[first])
        estimate, deviation, left, drift = fit(first, guesses)
        if deviation >= LIMITS.nothing and not found:
            unexcited = window
        elif deviation < LIMITS.nothing:
            guesses = [*guesses[:1], estimate]
        if found or deviation <= LIMITS.enough or first == 0:
            found.append(Information(estimate, deviation, window, unexcited, left, drift))
        if len(found) > LIMITS.longer or first == 0:
            if first > 0:  # one more fit, of all samples: a short window hides what is wrong
                _, _, left, _ = fit(0, guesses)
            return replace(found[0], left=left, longer=tuple(found[1:]))
        length = min(2 * length, count)


def one_point(form: PartitionedSystem, recording: Recording) -> Fit:
    """Least squares on the images of a point at rest that a form measures, with the recording's known motion.

    It finds the coordinates at the end that explain the samples best when the system's equations run backwards, each
    output weighted by its noise, from a guess or from hidden coordinates of 0, whichever explains the samples better.
    """
    from scipy.optimize import least_squares

    view, scale, unknown = recording.view, recording.scale, form.coordinates
    columns = [recording.names.index(name) for name in form.measured]
    places = [unknown.index(symbol) for symbol in form.x1]
    size, measured = len(unknown), len(columns)
    known_noise = recording.effective_variance or 0.0
    at_end = recording.motion.known(recording.time[-1:])

    def fit(first: int, guesses: list[Array]) -> tuple[Array, float, float, float]:
        samples, time = recording.outputs[first:, columns], recording.time[first:]
        seen = np.isfinite(samples)
        free = int(seen.sum()) - size
        if free < 1 or not seen.any(axis=0).all():
            return np.full(size, np.nan), math.inf, 0.0, 0.0
        images = images_backwards(recording, first, columns)

        def slopes(x: Array) -> Array:  # of the images, all at once, shape (n, K, m)
            steps = np.where(x, LIMITS.small * x, math.sqrt(np.finfo(float).eps))
            found = images(np.vstack([x, x + np.diag(steps)]))
            return np.asarray((found[1:] - found[0]) / steps[:, None, None])

        plain = np.zeros(size + len(DOUBTS))
        plain[places] = [column[np.isfinite(column)][-1] for column in samples.T]
        begins = [plain, *(np.append(guess * scale, plain[size:]) for guess in guesses)]
        start = min(begins, key=lambda x: float(((samples - images(x))[seen] ** 2).sum()))
        finest = max(LIMITS.finest * float(np.abs(samples[seen]).max()), math.sqrt(known_noise)) or LIMITS.finest
        noise = np.ones(measured)
        for _ in range(2):

            def residuals(x: Array, noise: Array = noise) -> Array:
                return np.append(((images(x) - samples) / noise)[seen], x[size:] / np.array(DOUBTS))

            def jacobian(x: Array, noise: Array = noise) -> Array:
                return np.vstack([(slopes(x) / noise)[:, seen].T, np.eye(len(x))[size:] / np.array(DOUBTS)[:, None]])

            solution = least_squares(residuals, start, jacobian, x_scale="jac", max_nfev=50)
            start, rest = solution.x, np.where(seen, samples - images(solution.x), 0.0)
            spread = np.sqrt((rest**2).sum(axis=0) * seen.sum() / (free * seen.sum(axis=0)))
            if _inflation(rest / np.maximum(spread, finest), time) > 1:  # residuals drift: trust all outputs alike
                spread[:] = math.sqrt((spread**2).mean())
            before, noise = noise, np.maximum(spread, finest)
        inflation = _inflation(rest / noise, time) if (spread > finest).any() else 1.0
        weighted = solution.jac
        weighted[: free + size] *= (before / noise / inflation)[np.nonzero(seen)[1]][:, None]
        deviations = np.array([_deviation(weighted, k) for k in range(size + 1)])
        estimate, drift = start[:size] / scale, max(0.0, abs(float(start[size])) - 2 * deviations[size])
        deviation = relative_deviation(view, estimate, deviations[:size] / scale, at_end)
        if first > 0:
            return estimate, deviation, 0.0, drift

        def residuals_alone(x: Array) -> Array:  # without the doubts, which hide a wrong focal length as well
            return np.where(seen, images(np.append(x, plain[size:])) - samples, 0.0).ravel() / finest

        def jacobian_alone(x: Array) -> Array:
            return np.where(seen, slopes(np.append(x, plain[size:]))[:size], 0.0).reshape(size, -1).T / finest

        alone = least_squares(residuals_alone, start[:size], jacobian_alone, x_scale="jac", max_nfev=50)
        rest = residuals_alone(alone.x).reshape(samples.shape) * finest
        if not (left := _left(rest, free, recording)):
            return estimate, deviation, 0.0, drift
        one = np.array([_deviation(alone.jac, k) for k in range(size)])
        moved = relative_deviation(view, alone.x / scale, one / scale, at_end) * left / finest
        return estimate, deviation, moved, drift

    return fit


def by_smoothing(form: PartitionedSystem, recording: Recording, doubt: Mapping[str, float]) -> Fit:
    """Least squares on the outputs that a form measures and on its motion, each weighted by its noise.

    The samples of a camera with an IMU, or of bearings, tell nothing where a point at infinity explains them.
    """
    known_noise, at_end = recording.effective_variance or 0.0, recording.motion.known(recording.time[-1:])

    def fit(first: int, guesses: list[Array]) -> tuple[Array, float, float, float]:
        part = recording.between(recording.time[first], recording.time[-1])
        samples, measured = outputs_of(form, part), positions(form, form.measured)
        seen, size = np.isfinite(samples), len(form.coordinates)
        free = int(seen.sum()) - size
        if free < 1 or not seen.any(axis=0).all():
            return np.full(size, np.nan), math.inf, 0.0, 0.0
        finest = max(LIMITS.finest * float(np.abs(samples[seen]).max()), math.sqrt(known_noise)) or LIMITS.finest
        noise, larger = np.full(len(measured), finest), 1.0
        for _ in range(3):
            noise = noise * math.sqrt(larger)
            found = smoothed(form, part, *usual_start(form, part, noise**2), noise**2, doubt)
            estimate, larger = found.states[-1], float(np.nanmean(found.nis[1:])) / len(measured)
            if not larger > 1.2:  # chance makes as much of a hundred samples
                break
        if not found.arrived or (isinstance(form.view, StateView) and not shows_scale(form, part, noise**2, doubt)):
            return estimate, math.inf, 0.0, 0.0
        rest = np.where(seen, samples - found.states[:, measured], 0.0)
        deviations = np.sqrt(np.maximum(np.diagonal(found.covariance), 0.0)) * _inflation(rest / noise, part.time)
        deviation = relative_deviation(recording.view, estimate, deviations, at_end)
        left = _left(rest, int(seen.sum()), recording)
        return estimate, deviation, math.inf if left else 0.0, 0.0

    return fit


def _left(rest: Array, free: int, recording: Recording) -> float:
    """Norm of residuals, 0 where a sample was lost, or 0 if they look like noise; few far ones are left out."""
    size = np.abs(rest)
    usual = float(np.median(size[size > 0])) if size.any() else 0.0
    near = np.where(size <= LIMITS.wild * usual, rest, 0.0)
    near = near if np.count_nonzero(near) > (1 - LIMITS.most_wild) * np.count_nonzero(rest) else rest
    squares, noise = float((near**2).sum()), recording.effective_variance
    white = float((near[1:] * near[:-1]).sum()) / max(squares, np.finfo(float).tiny)
    alike = looks_like_noise(math.sqrt(squares / free), white, None if noise is None else math.sqrt(noise))
    return 0.0 if alike else math.sqrt(squares)


def _inflation(residuals: Array, time: Array) -> float:
    """Factor by which a standard deviation grows where residuals are surely correlated, 0 where a sample was lost."""
    products = residuals[1:] * residuals[:-1]
    surely = LIMITS.surely * float((residuals**2).sum()) < float(products.sum()) * math.sqrt(np.count_nonzero(products))
    return math.sqrt(max(1.0, correlation(residuals, time))) if surely else 1.0


def correlation(residuals: Array, time: Array) -> float:
    """Return how many times their variance white noise needs, to be as bad as residuals, shape (K, m), 0 if lost.

    Covariances of residuals less than `correlated` seconds apart count, the farther ones less (Newey and West, A
    simple, positive semi-definite, heteroskedasticity and autocorrelation consistent covariance matrix, Econometrica
    55(3), 1987).
    """
    lags = min(int(LIMITS.correlated / float(np.median(np.diff(time)))), len(residuals) - 1)
    shares = [1 - k / (lags + 1) for k in range(1, lags + 1)]
    pairs = sum(share * float((residuals[k:] * residuals[:-k]).sum()) for k, share in enumerate(shares, 1))
    return 1 + 2 * pairs / max(float((residuals**2).sum()), np.finfo(float).tiny)


def _deviation(jacobian: Array, k: int) -> float:
    """Standard deviation of one unknown, when all others are unknown as well; infinite if nothing depends on it."""
    others = np.delete(jacobian, k, axis=1)
    alone = jacobian[:, k] - others @ np.linalg.lstsq(others, jacobian[:, k], rcond=None)[0]
    size = float(np.linalg.norm(alone))
    return 1 / size if size > LIMITS.rounding * float(np.linalg.norm(jacobian[:, k])) else math.inf


def relative_deviation(view: View, estimate: Array, deviations: Array, known: Array) -> float:
    """Relative standard deviation of what is judged, from those of the coordinates, to first order."""
    total = 0.0
    for k, deviation in enumerate(deviations):
        step = np.zeros(len(estimate))
        step[k] = LIMITS.small * (abs(estimate[k]) or float(np.abs(estimate).max()))
        change = float(view.relative_error(estimate[None], (estimate + step)[None], known)[0])
        if not math.isfinite(change):
            return math.inf
        total += (change / step[k] * deviation) ** 2 if change > 0 else 0.0
    return math.sqrt(total)
