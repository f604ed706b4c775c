"""Observers for perspective dynamic systems: a camera sees directions, an observer recovers distance."""

from percept_obs.border import TooMuchWork, WrongKind
from percept_obs.checking import CannotRead, Review, check
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
from percept_obs.points import FirstSight, PointsForm, PointsScenario, luenberger
from percept_obs.recording import Camera, Gaussian, Recording, Scenario, Uniform, record, scenarios
from percept_obs.structure import StructureAndMotion
from percept_obs.structure.stages import semigeneral
from percept_obs.studies.consistency import check_consistency
from percept_obs.system.forms import CanonicalForm, NotAffine, PartitionedSystem
from percept_obs.system.motion import Motion, affine, linear, rigid
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import BehindCamera, ImagingSurface, chained, pinhole, plane, sphere
from percept_obs.tracking.following import DoesNotFit, track
from percept_obs.tracking.run import Run

__version__ = "0.1.0"

__all__ = [
    "BehindCamera",
    "Camera",
    "CannotRead",
    "CanonicalForm",
    "DoesNotFit",
    "FirstSight",
    "Gaussian",
    "ImagingSurface",
    "Motion",
    "NotAffine",
    "Observer",
    "PartitionedSystem",
    "PerspectiveSystem",
    "PointsForm",
    "PointsScenario",
    "Recording",
    "Review",
    "Run",
    "Scenario",
    "StructureAndMotion",
    "TooMuchWork",
    "Uniform",
    "WrongKind",
    "affine",
    "chained",
    "check",
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
    "rigid",
    "scenarios",
    "semigeneral",
    "sliding_mode",
    "smo",
    "sphere",
    "track",
    "windowed",
    "with_point",
]
