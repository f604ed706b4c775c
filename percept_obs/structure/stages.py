"""Two stages: structure of an object that stands still, then its motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, Literal

import numpy as np

from percept_obs.compile import Array
from percept_obs.observers import Observer, integral_sliding_mode
from percept_obs.recording import Recording
from percept_obs.structure import COROLLARIES, StructureAndMotion, seen_as
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import Motion, rigid
from percept_obs.system.signal import slack_of
from percept_obs.tracking.following import track
from percept_obs.tracking.run import Run
from percept_obs.validation import checked

_OBJECT = tuple(symbol.name for symbol in rigid().parameters[6:])


@checked
@dataclass(frozen=True, eq=False)
class SemigeneralRun:
    """Runs while the object stands still and while it moves; d_s in 1/m and velocities in m/s from the first."""

    static: Run
    moving: Run
    found: dict[str, float]

    @cached_property
    def object_velocity(self) -> Array:
        """Estimates of v_p in m/s at the samples of the second stage, shape (K, 3)."""
        choice = self.moving.recording.view
        assert isinstance(choice, StructureAndMotion)
        velocities = choice.quantities(self.moving.estimate[:, -len(choice.unknown) :])
        return np.stack([velocities[name] for name in _OBJECT], axis=-1)


AVERAGED = 0.5
"""Seconds before the object moves over which estimates are averaged."""


@checked
def semigeneral(
    recording: Recording,
    motion: Motion,
    moves_at: float,
    make: Callable[[CanonicalForm], Observer] = integral_sliding_mode,
    camera: Literal["kept", "given"] = "kept",
    scale: float | None = None,
    **settings: Any,
) -> SemigeneralRun:
    """Estimate d_s and the camera's velocity while the object stands still, and then the object's velocity.

    Parameters
    ----------
    recording : Recording
        Of (y1, y2, ybar3), through both stages.
    motion : Motion
        From `rigid`.  Known are its angular velocity and v_c1, as in corollary 1; the rest is not used unless the truth
        is asked for, or the camera's velocity is given.
    moves_at : float
        When the object starts to move, in seconds.  The first stage's estimates are averaged over the half second
        before it to be handed on.
    make : function of a form
        The observer of both stages.
    camera : "kept" or "given"
        "kept" if the camera keeps the velocity that the first stage found; "given" if `motion` gives it anew.
    scale : float, optional
        The true d_s, if the runs are to be compared with the truth.
    **settings
        Passed to `track`, such as ``hold`` and ``step``.

    Returns
    -------
    SemigeneralRun
        With a run of each stage.

    Raises
    ------
    ValueError
        If `moves_at` leaves one of the stages without two samples, `camera` is neither word, or the first stage has no
        estimate of a positive d_s to hand on.

    See Also
    --------
    StructureAndMotion : One stage.

    Notes
    -----
    Chwa 2019, section IV, corollaries 1 and 2, pp. 6-7.

    Examples
    --------
    >>> from percept_obs import affine, record, semigeneral
    >>> from percept_obs.structure import ScaledDepthCamera
    >>> from percept_obs.structure.scenarios import chwa2019_experiment
    >>> scene = chwa2019_experiment("IV.A")
    >>> both = semigeneral(record(scene, 2, ScaledDepthCamera(0.01)), scene.motion, moves_at=1, step=0.01)
    >>> both.object_velocity[-1].round(2).tolist()
    [0.0, 0.0, -0.0]
    """
    choice = COROLLARIES[0].choice()
    begin, end = recording.time[[1, -2]]
    if not begin <= moves_at <= end:
        raise ValueError(f"the object moves at {moves_at} s; each stage needs two samples: {begin:.4g} to {end:.4g} s")
    first = seen_as(recording.between(-np.inf, moves_at), choice, motion, scale)
    static = track(first, make(choice.form), **settings)
    last = static.estimate[static.time >= moves_at - AVERAGED - slack_of(static.time), -len(choice.unknown) :]
    usable = last[np.isfinite(last).all(axis=1)]
    found = {n: float(v) for n, v in choice.quantities(usable.mean(axis=0)).items()} if len(usable) else {}
    if not found.get("d_s", np.nan) > 0:
        raise ValueError(
            f"in the last {AVERAGED} s before {moves_at} s there is no estimate of a positive d_s "
            f"({static.verdict()}); let the first stage last longer"
        )
    second = StructureAndMotion(_OBJECT, earlier=choice.unknown, scale=found["d_s"])
    believed = second.known_motion(_with_velocities(motion, found) if camera == "kept" else motion)
    rest = replace(seen_as(recording.between(moves_at, np.inf), second, motion, scale), motion=believed)
    return SemigeneralRun(static, track(rest, make(second.form), **settings), found)


def _with_velocities(motion: Motion, found: dict[str, float]) -> Motion:
    """Motion with some parameters replaced by constants."""
    names = [symbol.name for symbol in motion.parameters]
    columns = {names.index(name): found[name] for name in set(names) & set(found)}
    return replace(motion, signal=motion.signal and motion.signal.mapped(partial(_put, columns)))


def _put(columns: dict[int, float], rows: Array) -> Array:
    rows = rows.copy()
    for column, value in columns.items():
        rows[:, column] = value
    return rows
