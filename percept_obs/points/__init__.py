"""Many points of one state that moves linearly, and their Luenberger-type observer (Inaba et al. 2005)."""

from percept_obs.points.block import NotLinear, point_block
from percept_obs.points.bodies import body_with_origin, independent_points, rigid_body
from percept_obs.points.camera_imu import camera_imu, trusting
from percept_obs.points.form import PointsForm, UnseenDirection
from percept_obs.points.luenberger import LuenbergerObserver, luenberger
from percept_obs.points.lyapunov_matrix import LyapunovMatrix, constant, lyapunov, riccati, scheduled
from percept_obs.points.run import PointsRun
from percept_obs.points.scenarios import LeavesEveryBound, PointsScenario
from percept_obs.points.tracking import FirstSight

__all__ = [
    "FirstSight",
    "LeavesEveryBound",
    "LuenbergerObserver",
    "LyapunovMatrix",
    "NotLinear",
    "PointsForm",
    "PointsRun",
    "PointsScenario",
    "UnseenDirection",
    "body_with_origin",
    "camera_imu",
    "constant",
    "independent_points",
    "luenberger",
    "lyapunov",
    "point_block",
    "riccati",
    "rigid_body",
    "scheduled",
    "trusting",
]
