"""Places of a map side by side: runs that differ in some numbers of the settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from percept_obs.compile import Array
from percept_obs.compile.integrator import LONGEST_STEP
from percept_obs.labs.shared.finer_map import DIVERGED, FOLLOWED, NOT_YET
from percept_obs.labs.shared.schema import Settings
from percept_obs.observers import Observer
from percept_obs.recording import Camera, Scenario
from percept_obs.studies.counting import OUTCOMES
from percept_obs.studies.part import DONE, Plan
from percept_obs.system.motion import Motion
from percept_obs.tracking.following import named_start
from percept_obs.tracking.verdict import TOLERANCE

NAMES = {"noise.size": "noise"} | {
    f"{place}.{k}": name
    for place, names in {
        "X0": ("X", "Y", "Z"),
        "b": ("b1", "b2", "b3"),
        "believed.b": ("believed_b1", "believed_b2", "believed_b3"),
        "start.values": ("start_y1", "start_y2", "start_y3"),
    }.items()
    for k, name in enumerate(names)
}
"""What `ensemble` calls the settings that a map goes over; gains and others have the last part of their own name."""


def side_by_side(
    scene: tuple[Scenario, Camera],
    observer: Observer,
    start: Sequence[float] | None,
    believed: Motion | None,
    settings: Settings,
    varied: Mapping[str, Array],
) -> Array:
    """What becomes of runs under constant motions, shape (L, 3); NOT_YET first where the point leaves the camera."""
    scenario, camera = scene
    columns = {NAMES.get(name, name.rpartition(".")[2]): values for name, values in varied.items()}
    plan = Plan(
        scenario,
        observer,
        settings["duration"],
        camera,
        named_start(start, observer.form.coordinates),
        settings["hold"],
        believed or scenario.motion,
        LONGEST_STEP,
        TOLERANCE,
        after=0.0,
        coordinates=(),
        prior=None,
        language="numba",
        noises_alike=not {"noise", "dropout"} & set(columns),
        settled_part=0.0,
    )
    columns["seed"] = np.full(len(next(iter(columns.values()))), settings["seed"])
    found = dict(zip(plan.statistics, plan.compute(columns).T, strict=True))
    kind = np.where(found["outcome"] == OUTCOMES.index("diverged"), DIVERGED, FOLLOWED)
    kind = np.where(found["status"] == DONE, kind, NOT_YET)
    return np.stack([kind, found["settling_time"], found["judged"]], axis=-1)
