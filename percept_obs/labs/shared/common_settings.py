"""Settings that several labs have: gains of their observers, noise, a seed, a kept run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial

from percept_obs.labs.shared.printed import Texts
from percept_obs.labs.shared.schema import Choice, GainsOf, Group, Kind, Names, Number, Optional, Whole
from percept_obs.observers import Observer
from percept_obs.recording import Recording

AT_LEAST = "at least from one sample to the next"
"""Words for the least length of a window, to which window_in() in Python and windowIn() in the page widen it."""


def window_in(recording: Recording, asked: float) -> float:
    """Seconds of a window in a recording: as long as asked, but no longer than it, and no shorter than its intervals.

    Examples
    --------
    >>> from percept_obs.recording import Camera, record, scenarios
    >>> recording = record(scenarios.drive(), camera=Camera(0.5))
    >>> [window_in(recording, asked) for asked in (0.3, 2.0, 30.0)]
    [0.5, 2.0, 4.0]
    """
    return max(min(asked, float(recording.elapsed[-1])), float(recording.intervals.max()))


def offering(kind: Kind, names: Iterable[str]) -> Kind:
    """Return a kind of setting like this one, which offers other names."""
    assert isinstance(kind, Choice | Names)
    return replace(kind, names=tuple(names))


def gains(standard: Mapping[str, Mapping[str, float]], observer_of: Callable[[str], Observer]) -> Group:
    """Gains by the observers' names and their own, with the values that they open with."""
    groups = {
        name: GainsOf(
            {gain: Number(value, -1e300, 1e300) for gain, value in values.items()},
            partial=True,
            observer=partial(observer_of, name),
        )
        for name, values in standard.items()
    }
    return Group(groups, partial=True, about="for each observer, its gains by name")


def own_gains(observers: Mapping[str, Texts]) -> dict[str, dict[str, float]]:
    """The gains that observers have of their own, from what is printed of them for the page."""
    return {name: {gain["name"]: gain["value"] for gain in told["gains"]} for name, told in observers.items()}


def noise(**sizes: Number) -> Group:
    """The noise of a camera: its kind, and its sizes by their names."""
    kind = Choice("uniform", ("uniform", "gaussian"), label="Noise")
    return Group({"kind": kind, **sizes}, about=f"of the camera: a mapping of kind, {', '.join(sizes)}")


SEED = Number(0, 0, 2**32 - 1, (0, 100), 1, whole=True, about="of what is drawn at random", topic="camera")
DROPOUT = Number(
    0.0, 0, 0.95, (0, 0.9), 0.01, label="lost samples", about="share of samples that are lost", topic="camera"
)
KEPT = Optional(Whole(), about="None, or the settings of the run that is kept to compare with")
