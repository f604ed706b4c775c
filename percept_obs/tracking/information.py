"""What the samples themselves tell at the end of a run, by least squares: it needs neither a truth nor the observer."""

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

ENOUGH = 0.02
"""Relative standard deviation at which no more samples are asked: a longer window only adds what the motion misses."""

NOTHING = 1.0
"""Relative standard deviation from which on samples tell nothing."""

FEWEST = 20
"""Samples in the shortest window."""

SPLIT = 500
"""Steps at most into which a window is divided; between their ends the outputs are interpolated."""

LONGER = 2
"""How often the window that is enough is doubled once more, to see whether the known motion still explains it."""

SURELY = 3.5
"""Standard deviations by which an autocorrelation must differ from that of white noise to be one."""

FINEST = 1e-6
"""Noise of the best measurement, relative to the output's size: no camera is better, and rounding is not far below."""


@dataclass(frozen=True, eq=False)
class Information:
    """What the samples of the last seconds tell of what an observer estimates.

    Parameters
    ----------
    estimate : array of shape (n,)
        Least-squares coordinates at the last sample.
    deviation : float
        Relative standard deviation of what is judged, as the noise leaves it; infinite where samples tell nothing.
    window : float
        How many seconds at the end were needed for that.
    unexcited : float
        Over how many seconds at the end the samples tell nothing; 0 where every window of them tells something.
    noise : array of shape (m,)
        Standard deviation of the measured outputs, as given or as large as what is left of them.
    longer : tuple of Information
        What longer windows tell, which agrees if the motion is as it is known.
    """

    estimate: Array
    deviation: float
    window: float
    unexcited: float
    noise: Array
    longer: tuple[Information, ...] = ()

    def disagreement(self, view: View, known: Array) -> float:
        """How far longer windows are from it, relatively, beyond what the noise of both explains, or how vague."""
        return max((self._beyond(other, view, known) for other in self.longer), default=0.0)

    def _beyond(self, other: Information, view: View, known: Array) -> float:
        if not other.deviation < NOTHING:
            return math.inf
        apart = float(view.relative_error(self.estimate[None], other.estimate[None], known)[0])
        return max(apart - 2 * (self.deviation + other.deviation), 2 * (other.deviation - self.deviation))


ROUNDING = 1e-7
"""Part of a column that differences of nearly equal numbers leave undecided."""

SMALL = 1e-4
"""Relative change by which a slope is found."""

FAR = 1e3
"""Where outputs are taken to be that are beyond all bounds."""

Fit = Callable[[int, list[Array]], tuple[Array, float, Array]]
"""Least squares on the samples from one on, begun at the best of some coordinates: coordinates at the end, relative
deviation, noise of each output."""


def gathered(fit: Fit, elapsed: Array, guess: Array) -> Information:
    """Information from as many samples at the end as are needed, each window twice as long as the one before.

    Parameters
    ----------
    fit : function of the number of a sample and of coordinates to begin at
    elapsed : array of shape (K,)
        Seconds since the first sample.
    guess : array of shape (n,)
        Coordinates at the last sample to begin at, such as an observer's; NaN where there are none.
    """
    guesses = [guess] if np.isfinite(guess).all() else []
    count, length, unexcited = len(elapsed), min(FEWEST, len(elapsed)), 0.0
    found: list[Information] = []
    while True:
        first = count - length
        window = float(elapsed[-1] - elapsed[first])
        estimate, deviation, noise = fit(first, guesses)
        if deviation >= NOTHING and not found:
            unexcited = window
        elif deviation < NOTHING:
            guesses = [*guesses[:1], estimate]
        if found or deviation <= ENOUGH or first == 0:
            found.append(Information(estimate, deviation, window, unexcited, noise))
        if len(found) > LONGER or first == 0:
            return replace(found[0], longer=tuple(found[1:]))
        length = min(2 * length, count)


def one_point(form: PartitionedSystem, recording: Recording) -> Fit:
    """Least squares on the outputs that a form measures, with the recording's known motion.

    It finds the coordinates at the end that explain the samples best when the system's own equations run back from
    there, each output weighted by its noise.  It begins at a guess, or at hidden coordinates of 0 if these explain the
    samples better.
    """
    plant = Equations((*form.x1, *form.x2), tuple(form.rate), (), form.parameters)
    columns = [recording.names.index(name) for name in form.measured]
    order = [plant.state.index(symbol) for symbol in form.coordinates]
    inverse = np.argsort(order)
    size, measured, view = len(plant.state), len(form.x1), recording.view
    given = (recording.noise_variance or 0.0) if isinstance(view, ImagingSurface) else 0.0
    at_end = recording.motion.known(recording.time[-1:])

    def fit(first: int, guesses: list[Array]) -> tuple[Array, float, Array]:
        samples = recording.outputs[first:, columns]
        seen = np.isfinite(samples)
        free = int(seen.sum()) - size
        if free < 1 or not seen.any(axis=0).all():
            return np.full(size, np.nan), math.inf, np.full(measured, np.nan)
        backwards = _backwards(plant, recording, first, measured)
        plain = np.zeros(size)
        plain[:measured] = [column[np.isfinite(column)][-1] for column in samples.T]
        begins = [plain, *(guess[inverse] for guess in guesses)]
        start = min(begins, key=lambda x: float(((samples - backwards(x))[seen] ** 2).sum()))
        finest = max(FINEST * float(np.abs(samples[seen]).max()), math.sqrt(given)) or FINEST
        noise = np.ones(measured)
        for _ in range(2):
            start, left, jacobian = _least_squares(backwards, samples, noise, start)
            of_each = np.sqrt((left**2).sum(axis=0) * seen.sum() / (free * seen.sum(axis=0)))
            if _lengthened(left / np.maximum(of_each, finest)) > 1:  # it drifts: no reason to believe one output more
                of_each[:] = math.sqrt((of_each**2).mean())
            before, noise = noise, np.maximum(of_each, finest)
        weighted = jacobian * (before / noise)[np.nonzero(seen)[1]][:, None]
        deviations = np.array([_deviation(weighted, k) for k in range(size)])[order]
        deviations *= _lengthened(left / noise) if (of_each > finest).any() else 1.0
        return start[order], relative_deviation(view, start[order], deviations, at_end), noise

    return fit


def _least_squares(
    backwards: Callable[[Array], Array], samples: Array, noise: Array, start: Array
) -> tuple[Array, Array, Array]:
    """What explains the samples best, what is left of them (0 for lost ones), and the weighted Jacobian."""
    from scipy.optimize import least_squares

    seen = np.isfinite(samples)
    found = least_squares(lambda x: ((backwards(x) - samples) / noise)[seen], start, x_scale="jac", max_nfev=50)
    return found.x, np.where(seen, samples - backwards(found.x), 0.0), found.jac


def _backwards(plant: Equations, recording: Recording, first: int, measured: int) -> Callable[[Array], Array]:
    """The outputs at the samples from one on, shape (K - first, m), as a function of the coordinates at the end."""
    from scipy.interpolate import CubicSpline

    time = recording.time[first:]
    span = time[-1] - time[0]
    nodes = np.linspace(time[-1], time[0], 1 + max(3, math.ceil(span / max(LONGEST_STEP, span / SPLIT))))
    steps = np.diff(nodes)
    rows = recording.motion.known(instants(nodes))
    shape = [recording.view.values[symbol] for symbol in recording.view.parameters]
    known = np.hstack([rows, np.broadcast_to(np.array(shape), (len(rows), len(shape)))])
    table = Table(steps, np.empty((len(steps), EACH + 1, 0)), known, np.empty((len(nodes), 0)))

    def outputs(x: Array) -> Array:
        states = solve(plant, x, table).states[:, :measured]
        if not np.isfinite(states).all():
            return np.full((len(time), measured), FAR)
        return np.asarray(CubicSpline(nodes[::-1] - time[0], states[::-1])(time - time[0]))

    return outputs


def _lengthened(left: Array) -> float:
    """By how much a standard deviation grows where what is left of the samples drifts: each tells little anew.

    With the correlation r of neighbours, N samples count as N (1 - r)/(1 + r), as for a process of first order.
    """
    pairs = np.count_nonzero(left[1:] * left[:-1])
    r = float((left[1:] * left[:-1]).sum() / max((left**2).sum(), np.finfo(float).tiny))
    return math.sqrt((1 + r) / (1 - r)) if r * math.sqrt(pairs) > SURELY else 1.0


def _deviation(jacobian: Array, k: int) -> float:
    """Standard deviation of one unknown, when all others are unknown as well; infinite if nothing depends on it."""
    others = np.delete(jacobian, k, axis=1)
    alone = jacobian[:, k] - others @ np.linalg.lstsq(others, jacobian[:, k], rcond=None)[0]
    size = float(np.linalg.norm(alone))
    return 1 / size if size > ROUNDING * float(np.linalg.norm(jacobian[:, k])) else math.inf


def relative_deviation(view: View, estimate: Array, deviations: Array, known: Array) -> float:
    """What standard deviations of the coordinates are, relative to what is judged, to first order."""
    total = 0.0
    for k, deviation in enumerate(deviations):
        step = np.zeros(len(estimate))
        step[k] = SMALL * (abs(estimate[k]) or float(np.abs(estimate).max()))
        change = float(view.relative_error(estimate[None], (estimate + step)[None], known)[0])
        if not math.isfinite(change):
            return math.inf
        total += (change / step[k] * deviation) ** 2 if change > 0 else 0.0
    return math.sqrt(total)
