"""Recordings of a real camera, and motions that vary, as tables for the page."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.compile import Array, vectorised
from percept_obs.compile.integrator import LONGEST_STEP
from percept_obs.labs.observer.registry import Registry
from percept_obs.labs.observer.texts import BLOCKS
from percept_obs.labs.shared.schema import Settings
from percept_obs.labs.shared.typed_motion import MOST, read_motion
from percept_obs.recording import Recording, Scenario
from percept_obs.recording.footage import Footage
from percept_obs.system.motion import TIME, Motion, affine
from percept_obs.system.surfaces import ImagingSurface

LONGEST = 200.0
"""Seconds up to which a sampled motion is known; after its last sample it stays as it is there."""

MOST_TRACKS = 12
"""Tracks of a film that the lab offers, so that its page stays small."""

SHORTEST = 1.0
"""Seconds that a track of a film lasts at least, or there is little to see of it."""

VARIES = "it needs a motion with constant coefficients, but the {} varies"


def tracks_of(film: Footage) -> tuple[str, dict[str, Recording]]:
    """Tracks of a film for the lab, spread over it, in metres; first the name of the longest one with a truth."""
    whole = [r for r in film if isinstance(r.view, ImagingSurface) and r.elapsed[-1] >= SHORTEST]
    if not whole:
        raise ValueError(
            f"the film {film.source!r} has no track of one point that lasts {SHORTEST:g} s; move the camera more "
            "slowly, in more light, past things with corners"
        )
    longest = {r.source: r for r in sorted(whole, key=lambda r: float(r.elapsed[-1]))}
    opening = max(longest.values(), key=lambda r: (r.truth is not None, r.elapsed[-1]))
    others = [r for r in whole if r is longest[r.source] and r is not opening]
    spread = np.linspace(0, len(others) - 1, min(len(others), MOST_TRACKS - 1)).astype(int)
    shown = {opening, *(others[k] for k in spread)}
    return opening.source, {r.source: replace(r, unit=1.0) for r in whole if r in shown}


def track_for_the_page(recording: Recording, motion: str, surface: str, registry: Registry) -> dict[str, Any]:
    """A recording in numbers, with the name of its own motion; times count from its first sample.

    A lost sample is null, and so is a truth that is not known, since JSON knows no NaN.
    """
    measured = next(iter(recording.distances.items()), None) if recording.truth is None else None
    return {
        "names": recording.names,
        "begin": float(recording.time[0]),
        "time": recording.elapsed.tolist(),
        "samples": _numbers(recording.outputs),
        "truth": None if recording.truth is None else _numbers(recording.truth),
        "measured": measured and [measured[0], _numbers(measured[1])],
        **fitting(recording, surface),
        "kind": motion,
        "refused": refused_for(recording.motion, registry, "recording's"),
    }


def _numbers(values: Array) -> list[Any]:
    """Return numbers as lists, with None for NaN."""
    numbers = values.astype(object)
    numbers[np.isnan(values)] = None
    found: list[Any] = numbers.tolist()
    return found


def fitting(recording: Recording, surface: str) -> Settings:
    """Settings that fit a recording."""
    duration = float(np.ptp(recording.time))
    return {"surface": surface, "outputs": list(recording.names), "duration": duration, "window": min(duration, 2.0)}


def refused_for(motion: Motion, registry: Registry, whose: str) -> dict[str, str]:
    """Observers that cannot follow a motion, with the reasons."""
    if motion.signal is None or motion.signal.constant:
        return {}
    return {name: VARIES.format(whose) for name, make in registry.observers.items() if make.constant_motion}


def with_affine_motions(
    recordings: Mapping[str, Recording], surfaces: Mapping[str, ImagingSurface]
) -> dict[str, Recording]:
    """Recordings with the motion's A and b in samples, so that the lab's observers fit them; lengths by their units.

    Those that share a motion share its samples.
    """
    sharing: dict[tuple[Motion, float], list[Recording]] = {}
    for each in recordings.values():
        sharing.setdefault((each.motion, each.unit), []).append(each)
    known = {which: _over(those) for which, those in sharing.items()}
    return {
        name: replace(
            each,
            view=surfaces[name],
            motion=known[each.motion, each.unit],
            truth=None if each.truth is None else each.truth * each.scale,
            distances={other: values / each.unit for other, values in each.distances.items()},
            noise_variance=each.effective_variance,
            unit=1.0,
        )
        for name, each in recordings.items()
    }


def _over(recordings: list[Recording]) -> Motion:
    """The motion that recordings share, in samples at all of their times."""
    motion, times = recordings[0].motion, np.unique(np.concatenate([r.time for r in recordings]))
    constant = motion.signal is not None and motion.signal.constant
    if motion.signal is not None and motion.signal.times is not None:
        inside = (motion.signal.times > times[0]) & (motion.signal.times < times[-1])
        times = np.unique(np.concatenate([times, motion.signal.times[inside]]))
    return sampled(motion, times[:1] if constant else times, recordings[0].unit)


def sampled(motion: Motion, times: np.ndarray, unit: float = 1.0) -> Motion:
    """A motion's A and b in numbers at some times, by a unit of length; one time stands for a constant motion."""
    columns = motion.known(times).T if motion.parameters else [np.zeros(1)]
    entries = vectorised(motion.parameters or (TIME,), [*motion.A, *motion.b])(*columns)
    rows = np.broadcast_to(np.stack(entries, axis=-1), (len(times), 12))
    A, b = rows[:, :9].reshape(-1, 3, 3), rows[:, 9:] / unit
    return affine(A[0], b[0]) if len(times) == 1 else affine(A, b, times)


def typed_text(motion: Motion) -> str:
    """Text of a motion in expressions of time, as the setting takes it; empty if there is none."""
    if motion.parameters != (TIME,):
        return ""
    symbols = [symbol for block in BLOCKS.values() for symbol in block]
    entries = zip(symbols, (*motion.A, *motion.b), strict=True)
    text = "; ".join(f"{symbol} = {sp.sstr(entry)}" for symbol, entry in entries if entry.has(TIME))
    try:  # sympy writes more than is read; what is not is sampled
        return text if len(text) <= MOST and read_motion(text, BLOCKS) else ""
    except ValueError:
        return ""


def table_of(scenario: Scenario) -> Motion | None:
    """The motion of a scenario by its unit, if it varies, in samples up to `LONGEST`; a function every 10 ms."""
    motion = scenario.motion
    if motion.signal is None or motion.signal.constant:
        return None
    times = motion.signal.breaks(scenario.duration)
    if motion.signal.times is None:
        times = np.union1d(times, np.arange(0, scenario.duration + LONGEST_STEP / 2, LONGEST_STEP))
    times = np.asarray(times)
    inside = np.unique(np.concatenate([[0.0], times[(times > 0) & (times < LONGEST)]]))
    found = sampled(motion, inside, scenario.unit)
    signal = found.signal
    assert signal is not None
    assert not callable(signal.samples)
    rows = np.concatenate([signal.samples, signal.samples[-1:]])
    return affine(rows[:, :9].reshape(-1, 3, 3), rows[:, 9:], [*inside, LONGEST])
