"""Signals: numbers known over time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile import Array, Flags
from percept_obs.validation import TIMES, Chain, Times, checked, numbers, set_fields


def slack_of(times: Array) -> float:
    """Tolerance in seconds of two equal times: a thousandth of the median interval."""
    return 1e-3 * float(np.median(np.diff(times)))


def from_the_start(elapsed: Array, after: float) -> Flags:
    """Flags of the samples that lie `after` seconds or more after the first one, shape (K,)."""
    return np.asarray(elapsed >= after - slack_of(elapsed))


@checked
@dataclass(frozen=True, eq=False)
class Signal:
    """Numbers known over time, rows of samples (one for a constant) or a function of a time in seconds.

    Between the times at which rows were sampled, the signal is linear.
    """

    samples: Array | Callable[[float], ArrayLike]
    times: Annotated[Array, TIMES] | None = None

    def __post_init__(self) -> None:
        if callable(self.samples):
            return
        samples = frozen(np.atleast_2d(np.asarray(self.samples, dtype=float)), "the signal's samples")
        set_fields(self, samples=samples)
        if not len(samples):
            raise ValueError("the signal has no samples; give a row of values for each of its times")
        if self.times is None:
            if len(samples) != 1:
                raise ValueError(f"{len(samples)} rows of samples need as many times; only one row is a constant")
            return
        times = frozen(np.asarray(self.times, dtype=float), "the signal's times")
        if times.shape != (len(samples),):
            raise ValueError(
                f"the signal has {len(samples)} rows of samples and times of shape {times.shape}; give one time a row"
            )
        if not (increasing := np.diff(times) > 0).all():
            before, after = times[np.argmin(increasing) :][:2].tolist()
            raise ValueError(
                f"the signal's times go from {before:.6g} to {after:.6g} s; sort the samples, so that the times "
                "are strictly increasing"
            )
        set_fields(self, times=times)

    @property
    def constant(self) -> bool:
        """True if the signal is the same at all times."""
        return not callable(self.samples) and len(self.samples) == 1

    def breaks(self, until: float) -> ArrayLike:
        """Times up to a last one between which the signal is smooth, as far as they are known."""
        if self.times is not None:
            return self.times
        breaks = getattr(self.samples, "breaks", None)
        return breaks(until) if breaks else ()

    def at(self, times: Times) -> Array:
        """Return the values at times in seconds, shape (T, n), or (1, n) if constant; refuse times outside."""
        times = np.atleast_1d(np.asarray(times, dtype=float))
        if callable(self.samples):
            return frozen(_rows(self.samples, times), "the signal's function values")
        if self.times is None or len(self.samples) == 1:
            return self.samples
        slack = slack_of(self.times)
        if times.size and not (times.min() >= self.times[0] - slack and times.max() <= self.times[-1] + slack):
            raise ValueError(
                f"the signal is known from {self.times[0]:.6g} to {self.times[-1]:.6g} s, but is asked for from "
                f"{times.min():.6g} to {times.max():.6g} s; sample it longer or ask for less"
            )
        return np.stack([np.interp(times, self.times, column) for column in self.samples.T], axis=-1)

    def mapped(self, of: Callable[[Array], Array]) -> Signal:
        """Return the signal whose rows are a function of this one's."""
        if callable(self.samples):
            return Signal(OverTime(Chain(self.at, of), getattr(self.samples, "breaks", None)))
        return Signal(of(self.samples), self.times)


@dataclass(frozen=True, eq=False)
class OverTime:
    """Function of time that returns its rows at many times at once, for a run asks for ten thousands."""

    rows: Callable[[Array], Array]
    breaks: Callable[[float], Sequence[float]] | None = None  # up to a time, as `breaks_of` gives them

    def __call__(self, time: float) -> Array:
        """Values at one time, shape (n,)."""
        return self.rows(np.array([time]))[0]


def _rows(samples: Callable[[float], ArrayLike], times: Array) -> Array:
    """Values of a function of time, shape (T, n)."""
    if isinstance(samples, OverTime):
        return samples.rows(times)
    return np.array([numbers(samples(t), "what the function of time gives").ravel() for t in times.tolist()])


def frozen(array: Array, what: str) -> Array:
    """Read-only copy of numbers; raise ValueError if they are not finite."""
    if not np.isfinite(array).all():
        raise ValueError(f"{what} are not finite; remove or repair the NaN or infinite ones")
    return readonly(array)


def readonly(values: ArrayLike) -> Array:
    """Read-only copy of numbers."""
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array
