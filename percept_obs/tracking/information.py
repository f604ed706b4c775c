"""Information in the samples at the end of a run, by least squares: it needs neither a truth nor the observer."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from percept_obs.compile import Array, Table, solve
from percept_obs.compile.equations import Equations
from percept_obs.compile.integrator import EACH, LONGEST_STEP, instants
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.system.view import View
from percept_obs.tracking.doubts import DOUBTS, FAR, SPLIT, images_backwards
from percept_obs.tracking.grid import known_signals

ENOUGH = 0.02
"""Relative standard deviation at which a window is long enough: a longer one only adds errors of the motion."""

NOTHING = 1.0
"""Relative standard deviation from which on samples tell nothing."""

FEWEST = 20
"""Samples in the shortest window."""

LONGER = 3
"""Number of longer windows, each twice the last, whose estimates must agree with that of the one that suffices."""

SURELY = 3.5
"""Standard deviations of white noise's autocorrelation beyond which residuals count as correlated."""

CORRELATED = 0.5
"""Longest lag in seconds at which the correlation of residuals is summed."""

FINEST = 1e-6
"""Noise of the best measurement, relative to the output's size: no camera is better, and rounding is not far below."""


@dataclass(frozen=True, eq=False)
class Information:
    """Least-squares estimate of the coordinates at the last sample, from the samples of the last seconds.

    The deviation is the relative standard deviation of what is judged, infinite where samples tell nothing; `unexcited`
    are the seconds at the end in which they do.  The noise has the standard deviation of each output, as given or that
    of the residuals.  The drift is the change of the known translation's scale, over the whole recording, of which the
    samples leave no doubt.  Estimates from longer windows agree if the motion is as it is known.
    """

    estimate: Array
    deviation: float
    window: float
    unexcited: float
    noise: Array
    drift: float = 0.0
    longer: tuple[Information, ...] = ()

    def disagreement(self, view: View, known: Array) -> float:
        """Relative distance to the estimates from longer windows, less what noise explains; infinite if they are lost.

        Independent errors add by their squares.
        """
        found = 0.0
        for other in self.longer:
            if not other.deviation < NOTHING:
                return math.inf
            apart = float(view.relative_error(self.estimate[None], other.estimate[None], known)[0])
            found = max(found, apart**2 - self.deviation**2 - other.deviation**2)
        return math.sqrt(found)


ROUNDING = 1e-7
"""Share of a column's norm below which differences of nearly equal numbers are rounding."""

SMALL = 1e-4
"""Relative change of a coordinate for a difference quotient."""

Fit = Callable[[int, list[Array]], tuple[Array, float, Array, float]]
"""Least squares on the samples from one on, from the best of some initial guesses; returns coordinates at the end,
their relative deviation, the noise of each output, and the drift of scale that the samples surely tell."""


def information_at_end(fit: Fit, elapsed: Array, guess: Array) -> Information:
    """Information from the shortest window at the end that suffices, each one tried twice as long as the last.

    The guess has the coordinates at the last sample, such as an observer's; NaN where there are none.
    """
    guesses = [guess] if np.isfinite(guess).all() else []
    count, length, unexcited = len(elapsed), min(FEWEST, len(elapsed)), 0.0
    found: list[Information] = []
    while True:
        first = count - length
        window = float(elapsed[-1] - elapsed[first])
        estimate, deviation, noise, drift = fit(first, guesses)
        if deviation >= NOTHING and not found:
            unexcited = window
        elif deviation < NOTHING:
            guesses = [*guesses[:1], estimate]
        if found or deviation <= ENOUGH or first == 0:
            found.append(Information(estimate, deviation, window, unexcited, noise, drift))
        if len(found) > LONGER or first == 0:
            return replace(found[0], longer=tuple(found[1:]))
        length = min(2 * length, count)


def one_point(form: PartitionedSystem, recording: Recording) -> Fit:
    """Least squares on the outputs that a form measures, with the recording's known motion.

    It finds the coordinates at the end that explain the samples best when the system's equations run backwards, each
    output weighted by its noise, from a guess or from hidden coordinates of 0, whichever explains the samples better.
    """
    from scipy.optimize import least_squares

    view, scale, unknown = recording.view, recording.scale, form.coordinates
    columns = [recording.names.index(name) for name in form.measured]
    places = [unknown.index(symbol) for symbol in form.x1]
    size, measured, surface = len(unknown), len(columns), isinstance(view, ImagingSurface)
    known_noise = (recording.effective_variance or 0.0) if surface else 0.0
    at_end = recording.motion.known(recording.time[-1:])

    def fit(first: int, guesses: list[Array]) -> tuple[Array, float, Array, float]:
        samples, time = recording.outputs[first:, columns], recording.time[first:]
        seen = np.isfinite(samples)
        free = int(seen.sum()) - size
        if free < 1 or not seen.any(axis=0).all():
            return np.full(size, np.nan), math.inf, np.full(measured, np.nan), 0.0
        images = images_backwards(recording, first, columns) if surface else _backwards(form, recording, first)
        doubts = DOUBTS if surface else ()
        plain = np.zeros(size + len(doubts))
        plain[places] = [column[np.isfinite(column)][-1] for column in samples.T]
        begins = [plain, *(np.append(guess * scale, plain[size:]) for guess in guesses)]
        # the sum of squares may have several minima: begin where it is least
        start = min(begins, key=lambda x: float(((samples - images(x))[seen] ** 2).sum()))
        finest = max(FINEST * float(np.abs(samples[seen]).max()), math.sqrt(known_noise)) or FINEST
        noise = np.ones(measured)
        # how noisy each output is shows only once a first fit has been made
        for _ in range(2):

            def residuals(x: Array, noise: Array = noise) -> Array:
                return np.append(((images(x) - samples) / noise)[seen], x[size:] / np.array(doubts))

            solution = least_squares(residuals, start, x_scale="jac", diff_step=SMALL, max_nfev=50)
            start, rest = solution.x, np.where(seen, samples - images(solution.x), 0.0)
            spread = np.sqrt((rest**2).sum(axis=0) * seen.sum() / (free * seen.sum(axis=0)))
            if _inflation(rest / np.maximum(spread, finest), time) > 1:  # residuals drift: trust all outputs alike
                spread[:] = math.sqrt((spread**2).mean())
            before, noise = noise, np.maximum(spread, finest)
        inflation = _inflation(rest / noise, time) if (spread > finest).any() else 1.0
        weighted = solution.jac
        weighted[: free + size] *= (before / noise / inflation)[np.nonzero(seen)[1]][:, None]
        deviations = np.array([_deviation(weighted, k) for k in range(size + surface)])
        estimate, drift = start[:size] / scale, 0.0
        if surface:
            drift = max(0.0, abs(float(start[size])) - 2 * deviations[size])
        return estimate, relative_deviation(view, estimate, deviations[:size] / scale, at_end), noise, drift

    return fit


def _backwards(form: PartitionedSystem, recording: Recording, first: int) -> Callable[[Array], Array]:
    """Return a function from the coordinates at the end to the measured outputs at the samples from `first` on."""
    from scipy.interpolate import CubicSpline

    plant = Equations((*form.x1, *form.x2), tuple(form.rate), (), form.parameters)
    order = [form.coordinates.index(symbol) for symbol in plant.state]
    time = recording.time[first:]
    span = time[-1] - time[0]
    nodes = np.linspace(time[-1], time[0], 1 + max(3, math.ceil(span / max(LONGEST_STEP, span / SPLIT))))
    steps = np.diff(nodes)
    known = known_signals(recording.motion, recording.view, instants(nodes), recording.unit)
    table = Table(steps, np.empty((len(steps), EACH + 1, 0)), known, np.empty((len(nodes), 0)))

    def outputs(x: Array) -> Array:
        states = solve(plant, x[order], table).states[:, : len(form.x1)]
        if not np.isfinite(states).all():
            return np.full((len(time), len(form.x1)), FAR)
        return np.asarray(CubicSpline(nodes[::-1] - time[0], states[::-1])(time - time[0]))

    return outputs


def _inflation(residuals: Array, time: Array) -> float:
    """Factor by which correlated residuals, 0 where lost, enlarge a standard deviation; 1 if it is not sure."""
    products = residuals[1:] * residuals[:-1]
    surely = SURELY * float((residuals**2).sum()) < float(products.sum()) * math.sqrt(np.count_nonzero(products))
    return math.sqrt(max(1.0, correlation(residuals, time))) if surely else 1.0


def correlation(residuals: Array, time: Array) -> float:
    """Return the variance of white noise that harms an estimate as much as residuals (K, m), 0 if lost, over theirs.

    Covariances of residuals less than `CORRELATED` seconds apart count, the farther ones less (Newey and West, A
    simple, positive semi-definite, heteroskedasticity and autocorrelation consistent covariance matrix, Econometrica
    55(3), 1987).
    """
    lags = min(int(CORRELATED / float(np.median(np.diff(time)))), len(residuals) - 1)
    shares = [1 - k / (lags + 1) for k in range(1, lags + 1)]
    pairs = sum(share * float((residuals[k:] * residuals[:-k]).sum()) for k, share in enumerate(shares, 1))
    return 1 + 2 * pairs / max(float((residuals**2).sum()), np.finfo(float).tiny)


def _deviation(jacobian: Array, k: int) -> float:
    """Standard deviation of one unknown, when all others are unknown as well; infinite if nothing depends on it."""
    others = np.delete(jacobian, k, axis=1)
    # the part of a column that no change of the other unknowns can explain
    alone = jacobian[:, k] - others @ np.linalg.lstsq(others, jacobian[:, k], rcond=None)[0]
    size = float(np.linalg.norm(alone))
    return 1 / size if size > ROUNDING * float(np.linalg.norm(jacobian[:, k])) else math.inf


def relative_deviation(view: View, estimate: Array, deviations: Array, known: Array) -> float:
    """Relative standard deviation of what is judged, from those of the coordinates, to first order."""
    total = 0.0
    for k, deviation in enumerate(deviations):
        step = np.zeros(len(estimate))
        step[k] = SMALL * (abs(estimate[k]) or float(np.abs(estimate).max()))
        change = float(view.relative_error(estimate[None], (estimate + step)[None], known)[0])
        if not math.isfinite(change):
            return math.inf
        total += (change / step[k] * deviation) ** 2 if change > 0 else 0.0
    return math.sqrt(total)
