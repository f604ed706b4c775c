"""Observers for perspective dynamic systems: a camera sees directions, an observer recovers distance."""

from percept_obs import scenarios
from percept_obs.consistency import check_consistency
from percept_obs.forms import CanonicalForm, NotAffine, PartitionedSystem
from percept_obs.motion import Motion, affine, linear, rigid
from percept_obs.observability import instantaneous, windowed
from percept_obs.observers import (
    Observer,
    ekf,
    extended_kalman,
    ibo,
    identifier_based,
    integral_sliding_mode,
    ismo,
    sliding_mode,
    smo,
    with_point,
)
from percept_obs.perspective import PerspectiveSystem
from percept_obs.points import (
    PointsForm,
    PointsRecording,
    PointsScenario,
    luenberger,
    record_points,
    track_points,
)
from percept_obs.recording import Camera, Gaussian, Recording, Scenario, Uniform, record
from percept_obs.run import Run
from percept_obs.structure import StructureAndMotion, record_structure
from percept_obs.surfaces import BehindCamera, ImagingSurface, chained, pinhole, plane
from percept_obs.tracking import DoesNotFit, track
from percept_obs.two_stage import semigeneral

__version__ = "0.1.0"

__all__ = [
    "BehindCamera",
    "Camera",
    "CanonicalForm",
    "DoesNotFit",
    "Gaussian",
    "ImagingSurface",
    "Motion",
    "NotAffine",
    "Observer",
    "PartitionedSystem",
    "PerspectiveSystem",
    "PointsForm",
    "PointsRecording",
    "PointsScenario",
    "Recording",
    "Run",
    "Scenario",
    "StructureAndMotion",
    "Uniform",
    "affine",
    "chained",
    "check_consistency",
    "ekf",
    "extended_kalman",
    "ibo",
    "identifier_based",
    "instantaneous",
    "integral_sliding_mode",
    "ismo",
    "linear",
    "luenberger",
    "pinhole",
    "plane",
    "record",
    "record_points",
    "record_structure",
    "rigid",
    "scenarios",
    "semigeneral",
    "sliding_mode",
    "smo",
    "track",
    "track_points",
    "windowed",
    "with_point",
]
