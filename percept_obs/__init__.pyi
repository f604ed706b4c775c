"""The public names, where each is defined; `__init__.py` imports it from there when it is asked for."""

from percept_obs.checking import CannotRead, Review, check
from percept_obs.observability import (
    Bound,
    BoundMap,
    Efficiency,
    bound_map,
    cramer_rao,
    efficiency,
    how_observable,
    instantaneous,
    lie_derivatives,
    steered,
    steering,
    windowed,
)
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
from percept_obs.recording import Camera, Gaussian, Recording, Scenario, Uniform, record, scenarios, seen_on
from percept_obs.recording.folders import read_folder
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.pose_files import read_euroc, read_kitti, read_tum
from percept_obs.recording.poses import Poses, rigid_from_poses
from percept_obs.recording.text_table import Clock
from percept_obs.structure import StructureAndMotion
from percept_obs.structure.stages import semigeneral
from percept_obs.studies.consistency import check_consistency
from percept_obs.studies.diagnosis import diagnose
from percept_obs.studies.ensemble import ensemble
from percept_obs.system.apparent_size import sized
from percept_obs.system.forms import CanonicalForm, NotAffine, PartitionedSystem
from percept_obs.system.motion import Motion, affine, linear, rigid
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import (
    BehindCamera,
    ImagingSurface,
    chained,
    ellipsoid,
    pinhole,
    plane,
    sphere,
    unified,
)
from percept_obs.tracking.following import DoesNotFit, track
from percept_obs.tracking.function import FunctionObserver
from percept_obs.tracking.run import Run
from percept_obs.validation import TooMuchWork, WrongKind

__version__: str

__all__ = [
    "BehindCamera",
    "Bound",
    "BoundMap",
    "Camera",
    "CannotRead",
    "CanonicalForm",
    "Clock",
    "DoesNotFit",
    "Efficiency",
    "FirstSight",
    "FunctionObserver",
    "Gaussian",
    "ImagingSurface",
    "Motion",
    "NotAffine",
    "Observer",
    "PartitionedSystem",
    "PerspectiveSystem",
    "PixelCamera",
    "PointsForm",
    "PointsScenario",
    "Poses",
    "Recording",
    "Review",
    "Run",
    "Scenario",
    "StructureAndMotion",
    "TooMuchWork",
    "Uniform",
    "WrongKind",
    "affine",
    "bound_map",
    "chained",
    "check",
    "check_consistency",
    "cramer_rao",
    "diagnose",
    "efficiency",
    "ekf",
    "ellipsoid",
    "ensemble",
    "extended_kalman",
    "how_observable",
    "ibo",
    "identifier_based",
    "instantaneous",
    "integral_sliding_mode",
    "ismo",
    "lie_derivatives",
    "linear",
    "luenberger",
    "pinhole",
    "plane",
    "read_euroc",
    "read_folder",
    "read_kitti",
    "read_tum",
    "record",
    "rigid",
    "rigid_from_poses",
    "scenarios",
    "seen_on",
    "semigeneral",
    "sized",
    "sliding_mode",
    "smo",
    "sphere",
    "steered",
    "steering",
    "track",
    "unified",
    "windowed",
    "with_point",
]
