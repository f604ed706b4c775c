"""The UTIAS recording: landmarks at known places, seen by one moving stereo camera.

The data were recorded for the course AER1513 of the University of Toronto Institute for Aerospace Studies
(UTIAS) and are published at https://github.com/utiasSTARS/msckf-swf-comparison under the MIT licence,
(c) 2017 STARS Laboratory.  Credit both the course and the laboratory wherever the data are used.

The camera's frame has x to the right, y down and z forward; a point's places in the world and in that frame
are related by X_world = R X_camera + p.  A point at rest in the world then obeys X' = -v - w x X.
"""

from __future__ import annotations

import hashlib
import os
import urllib.request
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat
from scipy.spatial.transform import Rotation

from percept_obs.recording import Recording
from percept_obs.system.motion import rigid
from percept_obs.system.surfaces import pinhole

UTIAS_ADDRESS = (
    "https://raw.githubusercontent.com/utiasSTARS/msckf-swf-comparison/"
    "ad9566ef35c3e4792a89b04623e1fa2f99238435/datasets/dataset3.mat"
)
UTIAS_SHA256 = "ac7f9d90199d376875ef13a472d94b728e84f38ce70b7c7ed145060c895e02e5"
UTIAS_FILE = "dataset3.mat"
UTIAS_VARIABLE = "PERCEPT_OBS_UTIAS"

NOT_SEEN = -1.0
SHORTEST_TRACK = 3.0  # s
LONGEST_GAP = 0.30  # s, between two samples of one track
HALF_WINDOW = 0.30  # s, of the fit to the camera's poses
FEWEST_POSES = 5  # in a fit

PIXEL_SIGMA = 4.0  # pixels to which a measured one agrees with the poses

Values = NDArray[np.float64]
Indices = NDArray[np.intp]


class DatasetUnavailable(ConnectionError):
    """The recording is not on this machine and could not be fetched."""


@dataclass(frozen=True)
class Intrinsics:
    """Constants of the rectified stereo camera, which has no distortion.

    Parameters
    ----------
    fx, fy : float
        Focal lengths in pixels.
    cx, cy : float
        Principal point in pixels.
    baseline : float
        Distance from the left to the right camera in metres.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    baseline: float


@dataclass(frozen=True, eq=False)
class CameraPath:
    """Pose and motion of the left camera at K times.

    Parameters
    ----------
    time : array of shape (K,)
        Times in seconds, increasing, not evenly spaced.
    position : array of shape (K, 3)
        The camera's place p in the world, in metres.
    orientation : array of shape (K, 4)
        Unit quaternion (x, y, z, w) of the rotation R from the camera's frame to the world.  Its sign means
        nothing.
    velocity : array of shape (K, 3)
        Linear velocity v in the camera's frame, in m/s.
    angular_velocity : array of shape (K, 3)
        Angular velocity w in the camera's frame, in rad/s.
    """

    time: Values
    position: Values
    orientation: Values
    velocity: Values
    angular_velocity: Values


@dataclass(frozen=True, eq=False)
class Track:
    """One landmark while the camera sees it without interruption, at k times.

    Parameters
    ----------
    point_id : int
        Number of the track.
    landmark_id : int
        Which landmark it is; the same landmark may have several tracks.
    sample : integer array of shape (k,)
        Rows of the camera's path at which the landmark is seen.
    time : array of shape (k,)
        Times in seconds.
    pixels : array of shape (k, 2)
        Measured (u, v) in the left image, in pixels.
    depth : array of shape (k,)
        True depth Z in metres, from the known landmark and the camera's pose.
    stereo_depth : array of shape (k,)
        Depth fx baseline / (u_left - u_right) in metres; no pose enters, so it is an independent check.
    """

    point_id: int
    landmark_id: int
    sample: Indices
    time: Values
    pixels: Values
    depth: Values
    stereo_depth: Values


@dataclass(frozen=True, eq=False)
class UtiasTables:
    """The recording, converted.

    Parameters
    ----------
    camera : CameraPath
        Pose and motion of the left camera.
    tracks : tuple of Track
        Uninterrupted views of single landmarks, in the order in which they begin and end.
    landmarks : array of shape (20, 3)
        The landmarks' places in the world, in metres; a track's `landmark_id` is a row.
    intrinsics : Intrinsics
        Constants of the stereo camera.
    """

    camera: CameraPath
    tracks: tuple[Track, ...]
    landmarks: Values
    intrinsics: Intrinsics


def find_utias(path: str | os.PathLike[str] | None = None) -> Path:
    """Find the recording's file on this machine, or fetch it on first use.

    Parameters
    ----------
    path : str or path, optional
        The file dataset3.mat or a folder that holds it.  Without it the environment variable
        PERCEPT_OBS_UTIAS is read, in the same two forms; without that, too, the file is fetched once from the
        laboratory's repository and kept in this user's cache.

    Returns
    -------
    pathlib.Path
        The file, its SHA-256 checked.

    Raises
    ------
    FileNotFoundError
        If the path or the variable names nothing, or a folder without dataset3.mat.
    ValueError
        If the file there is not the recording, byte for byte.
    DatasetUnavailable
        If the file has to be fetched and cannot be.
    """
    if path is not None:
        return _checked(Path(path), "path=")
    if place := os.environ.get(UTIAS_VARIABLE):
        return _checked(Path(place), f"the environment variable {UTIAS_VARIABLE}")
    return _fetched()


def load_utias(path: str | os.PathLike[str] | None = None) -> tuple[Recording, ...]:
    """Tracks of landmarks seen by a moving camera, as recordings with both image coordinates.

    The motion is rigid: the point rests and the camera moves, with angular velocity w = -(the camera's).  The truth is
    the known landmark seen from the fitted pose; `Recording.distances` has the independent ``"stereo"`` depth.
    A measured pixel agrees with the poses to about `PIXEL_SIGMA` pixels, which sets the noise variance.

    Parameters
    ----------
    path : path, optional
        See `find_utias`.

    Returns
    -------
    tuple of Recording
        44 tracks of 3.0 to 8.6 s.

    Raises
    ------
    FileNotFoundError, DatasetUnavailable, ValueError
        See `find_utias`.
    """
    tables = utias_tables(path)
    camera, lens = tables.camera, tables.intrinsics
    focal, centre = np.array([lens.fx, lens.fy]), np.array([lens.cx, lens.cy])
    motion = rigid(-camera.angular_velocity, camera.velocity, np.zeros(3), times=camera.time)
    surface = pinhole()
    recordings = []
    for track in tables.tracks:
        pose = Rotation.from_quat(camera.orientation[track.sample])
        points = pose.inv().apply(tables.landmarks[track.landmark_id] - camera.position[track.sample])
        recordings.append(
            Recording(
                track.time,
                (track.pixels - centre) / focal,
                ("y1", "y2"),
                surface,
                motion,
                truth=surface.project(points),
                noise_variance=float(np.mean((PIXEL_SIGMA / focal) ** 2)),
                distances={"stereo": track.stereo_depth},
                source=f"UTIAS track {track.point_id}, landmark {track.landmark_id}",
            )
        )
    return tuple(recordings)


def utias_tables(path: str | os.PathLike[str] | None = None) -> UtiasTables:
    """Convert the recording to the camera's motion and the landmarks' tracks.

    The camera's position, orientation, velocity and angular velocity come from quadratics in time, fitted
    around each sample to the recorded poses within 0.30 s, or to the nearest five where these are fewer.  The
    recorded gyroscope is not used: it agrees poorly with the motion of the image.  A track is a landmark seen
    at consecutive samples for at least 3 s, without a gap of more than 0.30 s.

    Parameters
    ----------
    path : str or path, optional
        Where the recording is, as in `find_utias`.

    Returns
    -------
    UtiasTables
        1900 samples of the camera and 44 tracks with 2739 measurements.

    Raises
    ------
    FileNotFoundError, ValueError, DatasetUnavailable
        As `find_utias` does.

    Notes
    -----
    The recorded poses miss the measured pixels by slowly varying offsets: in the median 4 to 13 px, about one
    degree of attitude, in 42 tracks, but 22 and 19 px in tracks 14 and 15.  Treat a pixel as known to about
    4 px.

    References
    ----------
    STARS Laboratory, University of Toronto Institute for Aerospace Studies (UTIAS), recorded for the course
    AER1513; https://github.com/utiasSTARS/msckf-swf-comparison, datasets/dataset3.mat, MIT licence,
    (c) 2017 STARS Laboratory.
    """
    recorded = loadmat(find_utias(path), squeeze_me=True)
    intrinsics = Intrinsics(*(float(recorded[name]) for name in ("fu", "fv", "cu", "cv", "b")))
    landmarks = recorded["rho_i_pj_i"].T
    camera = _camera_path(recorded)
    tracks = _tracks(recorded["y_k_j"], landmarks, camera, intrinsics)
    return UtiasTables(camera, tracks, landmarks, intrinsics)


def _checked(place: Path, origin: str) -> Path:
    place = place.expanduser()
    file = place / UTIAS_FILE if place.is_dir() else place
    if not file.is_file():
        problem = f"a folder without {UTIAS_FILE}" if place.is_dir() else "neither a file nor a folder"
        raise FileNotFoundError(
            f"{origin} names '{place}', which is {problem}; name {UTIAS_FILE} or a folder that holds it, "
            f"or name nothing and it is fetched from {UTIAS_ADDRESS}"
        )
    found = _digest(file.read_bytes())
    if found != UTIAS_SHA256:
        raise ValueError(
            f"{origin} names '{file}', which is another file or a damaged one: its SHA-256 is {found}, "
            f"expected {UTIAS_SHA256}; download it again from {UTIAS_ADDRESS}"
        )
    return file


def _fetched() -> Path:
    """The recording in the system's cache, which it enters only if it is the one."""
    from platformdirs import user_cache_path

    file = user_cache_path("percept_obs") / UTIAS_FILE
    if file.is_file() and _digest(file.read_bytes()) == UTIAS_SHA256:
        return file
    try:
        with urllib.request.urlopen(UTIAS_ADDRESS, timeout=60) as answer:
            content = answer.read()
        found = _digest(content)
        if found != UTIAS_SHA256:
            raise ConnectionError(f"another file came, such as a login page of the network: its SHA-256 is {found}")
        file.parent.mkdir(parents=True, exist_ok=True)
        new = file.with_suffix(f".{os.getpid()}")
        new.write_bytes(content)
        new.replace(file)  # at once, so that half a file is never found here
    except OSError as error:
        raise DatasetUnavailable(
            f"the UTIAS recording could not be fetched ({error}); is there no network?  Download "
            f"{UTIAS_ADDRESS} by hand and give its place as path= or in the environment variable "
            f"{UTIAS_VARIABLE}"
        ) from error
    return file


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _camera_path(recorded: dict[str, Any]) -> CameraPath:
    time = recorded["t"]
    world_from_body = Rotation.from_rotvec(recorded["theta_vk_i"].T)
    # from_matrix() takes the nearest rotation, so C_c_v need not be orthonormal to the last digit.
    world_from_camera = world_from_body * Rotation.from_matrix(recorded["C_c_v"]).inv()
    camera_in_world = recorded["r_i_vk_i"].T + world_from_body.apply(recorded["rho_v_c_v"])

    fit = np.array([_local_fit(time, camera_in_world, world_from_camera, k) for k in range(time.size)])
    (position, rotation), (position_rate, rotation_rate) = (np.split(fit[:, i], 2, axis=1) for i in (0, 1))
    orientation = world_from_camera * Rotation.from_rotvec(rotation)
    # The first two terms of the series for w in the fit's correction phi.  The others change w by less than
    # 1e-4 rad/s in every track, and by up to 0.007 rad/s only outside them, at an outlying attitude at 10 s.
    angular_velocity = rotation_rate - np.cross(rotation, rotation_rate) / 2
    return CameraPath(
        time=time,
        position=position,
        orientation=orientation.as_quat(),
        velocity=orientation.inv().apply(position_rate),
        angular_velocity=angular_velocity,
    )


def _local_fit(time: Values, position: Values, attitude: Rotation, k: int) -> Values:
    """Values (row 0) and rates (row 1) at t_k of the quadratics fitted to p and phi = log(R_k^T R)."""
    distance = np.abs(time - time[k])
    near = np.flatnonzero(distance <= HALF_WINDOW)
    if near.size < FEWEST_POSES:
        near = np.argsort(distance, kind="stable")[:FEWEST_POSES]
    rotation = (attitude[k].inv() * attitude[near]).as_rotvec()
    powers = np.vander(time[near] - time[k], 3, increasing=True)
    coefficients: Values = np.linalg.lstsq(powers, np.hstack([position[near], rotation]), rcond=None)[0]
    return coefficients[:2]


def _tracks(images: Values, landmarks: Values, camera: CameraPath, intrinsics: Intrinsics) -> tuple[Track, ...]:
    seen = (images != NOT_SEEN).all(axis=0)
    runs = [(run, landmark) for landmark, column in enumerate(seen.T) for run in _runs(camera.time, column)]
    runs.sort(key=lambda item: (item[0][0], item[0][-1], item[1]))

    tracks = []
    for point_id, (run, landmark) in enumerate(runs):
        u_left, v_left, u_right, _ = images[:, run, landmark]
        camera_from_world = Rotation.from_quat(camera.orientation[run]).inv()
        track = Track(
            point_id=point_id,
            landmark_id=landmark,
            sample=run,
            time=camera.time[run],
            pixels=np.column_stack([u_left, v_left]),
            depth=camera_from_world.apply(landmarks[landmark] - camera.position[run])[:, 2],
            stereo_depth=intrinsics.fx * intrinsics.baseline / (u_left - u_right),
        )
        tracks.append(track)
    return tuple(tracks)


def _runs(time: Values, seen: NDArray[np.bool_]) -> list[Indices]:
    samples = np.flatnonzero(seen)
    interrupted = (np.diff(samples) > 1) | (np.diff(time[samples]) > LONGEST_GAP)
    runs = np.split(samples, np.flatnonzero(interrupted) + 1)
    return [run for run in runs if run.size and time[run[-1]] - time[run[0]] >= SHORTEST_TRACK]
