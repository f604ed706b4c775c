"""Recordings of a real camera, in the numbers that the page takes."""

from dataclasses import replace
from typing import Any

import numpy as np

from percept_obs.compile import vectorised
from percept_obs.labs.observer.texts import BY_NAME
from percept_obs.labs.shared.offered import SURFACES
from percept_obs.labs.shared.schema import Settings
from percept_obs.recording import Recording
from percept_obs.system.motion import affine


def track_for_the_page(recording: Recording, motion: str) -> dict[str, Any]:
    """A recording in numbers, with the name of its own motion; times count from its first sample.

    A lost sample is null, since JSON knows no NaN.
    """
    signal = recording.motion.signal
    if signal is None or callable(signal.samples):
        raise ValueError(f"the motion of {recording.source!r} has no sampled numbers; bind it to numbers first")
    begun = recording.time[0]
    times = [0.0] if signal.times is None else (signal.times - begun).tolist()
    return {
        "names": recording.names,
        "time": recording.elapsed.tolist(),
        "samples": [[None if np.isnan(v) else v for v in row] for row in recording.outputs.tolist()],
        "truth": None if recording.truth is None else recording.truth.tolist(),
        "motion": {"times": times, "rows": signal.samples.tolist()},
        **fitting(recording),
        "kind": motion,
        "refused": refused_for(recording),
    }


def fitting(recording: Recording) -> Settings:
    """Settings that a recording brings with it."""
    duration = float(np.ptp(recording.time))
    surface = next(kind for kind in SURFACES if recording.view.fits(SURFACES[kind]()))
    return {"surface": surface, "outputs": list(recording.names), "duration": duration, "window": min(duration, 2.0)}


def refused_for(recording: Recording) -> dict[str, str]:
    """Observers that cannot follow a recording, with the reasons."""
    signal = recording.motion.signal
    if signal is None or signal.constant:
        return {}
    reason = "it needs a motion with constant coefficients, but the recording's varies"
    return {name: reason for name, make in BY_NAME.items() if make.constant_motion}


def with_affine_motion(name: str, recording: Recording) -> Recording:
    """The same recording with the motion's A and b sampled, so that the lab's observers fit it."""
    motion, times = recording.motion, recording.time
    constant = motion.signal is not None and motion.signal.constant
    if motion.signal is not None and motion.signal.times is not None:
        inside = (motion.signal.times > times[0]) & (motion.signal.times < times[-1])
        times = np.unique(np.concatenate([times, motion.signal.times[inside]]))
    entries = vectorised(motion.parameters, [*motion.A, *motion.b])(*motion.known(times).T)
    rows = np.stack(entries, axis=-1)
    if not any(recording.view.fits(SURFACES[kind]()) for kind in ("pinhole", "chained")):
        raise ValueError(f"the recording {name!r} was seen on the {recording.view.name}; the lab knows the pinhole")
    A, b = rows[:, :9].reshape(-1, 3, 3), rows[:, 9:]
    return replace(recording, motion=affine(A[0], b[0]) if constant else affine(A, b, times))
