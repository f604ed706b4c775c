"""Sentences of Python on a run of many points: inequalities, guaranteed decay, observability."""

from typing import Any

import numpy as np

from percept_obs.labs.shared.common_settings import window_in
from percept_obs.points import PointsRun
from percept_obs.points.form import points_form
from percept_obs.points.gramian import decay_bound, gramian, linear_gramian
from percept_obs.points.ray import ray_turning

BOUND_WINDOW = 4.0
"""Seconds of the windows over which the decay is bounded; longer ones promise less, for corrections hide more."""

STILL = 1e-6
"""rad/s below which a ray counts as at rest."""


def in_words(run: PointsRun, window: float) -> dict[str, Any]:
    """Sentences, and the rate in 1/s at which the error decays at least, or None where nothing is guaranteed.

    The Gramian's windows last `window` seconds, as window_in() has it.
    """
    recording = run.recording
    window = window_in(recording, window)
    seen, sentences, bound = gramian(recording, window).holds, [], None
    if not seen and (pair := linear_gramian(recording, window)).holds:
        sentences.append(
            f"With their depths the points would tell everything, with a smallest eigenvalue of {pair.least:.2g}: the "
            "pair (C, A) is uniformly observable, and only the images do not show it."
        )
    if len(run.kept):
        sentences.append(f"{run.conditions().verdict()}.".replace("(15)", "Inequality (15)", 1))
        bound, sentence = _guaranteed(run, seen, window)
        sentences.append(sentence)
    sentences.append(_turning(run))
    return {"sentences": sentences, "bound": bound}


def _guaranteed(run: PointsRun, seen: bool, window: float) -> tuple[float | None, str]:
    """Rate of decay that the proof of Theorem 3.4 guarantees, and a sentence on it."""
    if not seen:
        return None, "Theorem 3.4 guarantees no decay here, for it needs (14)."
    try:
        rate = decay_bound(run.recording, run.observer, min(window, BOUND_WINDOW)).rate
    except ValueError:
        return None, "Theorem 3.4 guarantees no rate here, for it needs a given P that meets (15)."
    return rate, f"The proof of Theorem 3.4 guarantees that errors decay by {rate:.2g} per second on average."


def _turning(run: PointsRun) -> str:
    """Sentence on the turning of rays, which bounds the decay with a constant P."""
    recording = run.recording
    assert recording.truth is not None
    turning = ray_turning(points_form(recording), recording.time, recording.truth).mean(axis=0)
    slowest = int(np.argmin(turning))
    if turning[slowest] < STILL:
        return f"The input turns no ray of point {slowest + 1}, so that nothing carries an error along it across."
    return (
        f"The input turns the rays by {turning[slowest]:.2g} rad/s on average (least, point {slowest + 1}): about "
        "as fast, and no faster, may the error of one point decay with a constant P."
    )
