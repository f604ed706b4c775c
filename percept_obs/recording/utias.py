"""The UTIAS recording: landmarks at known places, seen by one moving stereo camera.

The data were recorded for the course AER1513 of the University of Toronto Institute for Aerospace Studies
(UTIAS) and are published at https://github.com/utiasSTARS/msckf-swf-comparison under the MIT licence,
(c) 2017 STARS Laboratory.  Credit both the course and the laboratory wherever the data are used.

The camera's frame has x to the right, y down and z forward; a point's places in the world and in that frame
are related by X_world = R X_camera + p.  A point at rest in the world then obeys X' = -v - w x X.

Another dataset is another file like this one, with a function that reads it and returns recordings.
"""

from __future__ import annotations

import hashlib
import os
import urllib.request
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.spatial.transform import Rotation

from percept_obs.border import checked, write_whole
from percept_obs.compile import Array, Flags
from percept_obs.recording import Recording, Sighting
from percept_obs.system.motion import Motion, rigid
from percept_obs.system.surfaces import pinhole
from percept_obs.system.view import View

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


class DatasetUnavailable(ConnectionError):
    """The recording is not on this machine and could not be fetched."""


@dataclass(frozen=True, eq=False)
class UtiasTables:
    """The recording, converted: K samples of the left camera, which follows L landmarks.

    Parameters
    ----------
    time : array of shape (K,)
        Seconds, increasing, not evenly spaced.
    position : array of shape (K, 3)
        The camera's place p in the world, in metres.
    orientation : Rotation
        K rotations R from the camera's frame to the world.
    velocity, angular_velocity : arrays of shape (K, 3)
        v in m/s and w in rad/s, in the camera's frame.
    landmarks : array of shape (L, 3)
        Places in the world, in metres.
    tracks : tuple of Sighting
        When a landmark is seen without interruption, in the order in which they begin and end.
    pixels : array of shape (K, L, 2)
        Measured (u, v) in the left image; NaN outside the tracks.
    stereo_depth : array of shape (K, L)
        Depth fx baseline / (u_left - u_right) in metres; no pose enters, so it is an independent check.
    focal, centre : arrays of shape (2,)
        Focal lengths fx, fy and principal point cx, cy in pixels; the images are rectified, without distortion.
    baseline : float
        Distance from the left to the right camera in metres.
    """

    time: Array
    position: Array
    orientation: Rotation
    velocity: Array
    angular_velocity: Array
    landmarks: Array
    tracks: tuple[Sighting, ...]
    pixels: Array
    stereo_depth: Array
    focal: Array
    centre: Array
    baseline: float

    @cached_property
    def points(self) -> Array:
        """The landmarks in the camera's frame, in metres, from the fitted poses, shape (K, L, 3)."""
        to_camera = self.orientation.inv()
        return np.stack([to_camera.apply(landmark - self.position) for landmark in self.landmarks], axis=1)

    def recording(self, rows: slice, columns: int | list[int], view: View, truth: Array, source: str) -> Recording:
        """Some samples of one landmark or of several, with what is known of them in all cases."""
        return Recording(
            self.time[rows],
            ((self.pixels - self.centre) / self.focal)[rows, columns],
            ("y1", "y2"),
            view,
            self.motion,
            truth=truth,
            noise_variance=float(np.mean((PIXEL_SIGMA / self.focal) ** 2)),
            distances={"stereo": self.stereo_depth[rows, columns]},
            source=source,
        )

    @cached_property
    def motion(self) -> Motion:
        """That of a point at rest in the camera's frame: X' = -v - w x X."""
        return rigid(-self.angular_velocity, self.velocity, np.zeros(3), times=self.time)


@checked
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


@checked
def load_utias(path: str | os.PathLike[str] | None = None) -> tuple[Recording, ...]:
    """Tracks of landmarks seen by a moving camera, as recordings with both image coordinates.

    The motion is rigid: the point rests and the camera moves, with angular velocity w = -(the camera's).  The truth is
    the known landmark seen from the fitted pose; `Recording.distances` has the independent ``"stereo"`` depth.
    A measured pixel agrees with the poses to about `PIXEL_SIGMA` pixels, which sets the noise variance.

    For the path and what is raised see `find_utias`.

    Returns
    -------
    tuple of Recording
        44 tracks of 3.0 to 8.6 s.
    """
    tables, surface, recordings = utias_tables(path), pinhole(), []
    for number, track in enumerate(tables.tracks):
        rows = slice(track.first, track.last + 1)
        truth = surface.project(tables.points[rows, track.point])
        source = f"UTIAS track {number}, landmark {track.point}"
        recordings.append(tables.recording(rows, track.point, surface, truth, source))
    return tuple(recordings)


@checked
def utias_tables(path: str | os.PathLike[str] | None = None) -> UtiasTables:
    """Convert the recording to the camera's motion and the landmarks' tracks.

    The camera's position, orientation, velocity and angular velocity come from quadratics in time, fitted
    around each sample to the recorded poses within 0.30 s, or to the nearest five where these are fewer.  The
    recorded gyroscope is not used: it agrees poorly with the motion of the image.  A track is a landmark seen
    at consecutive samples for at least 3 s, without a gap of more than 0.30 s.

    These are 1900 samples of the camera, 20 landmarks and 44 tracks with 2739 measurements; for the path see
    `find_utias`.

    Notes
    -----
    The recorded poses miss the measured pixels by slowly varying offsets: in the median 4 to 13 px, about one
    degree of attitude, in 42 tracks, but 22 and 19 px in tracks 14 and 15.  Treat a pixel as known to about
    4 px.
    """
    recorded = loadmat(find_utias(path), squeeze_me=True)
    time, images = recorded["t"], np.moveaxis(recorded["y_k_j"], 0, -1)
    tracks = _tracks(time, (images != NOT_SEEN).all(axis=-1))
    followed = np.zeros(images.shape[:2], dtype=bool)
    for track in tracks:
        followed[track.first : track.last + 1, track.point] = True
    images = np.where(followed[..., None], images, np.nan)  # u and v on the left, then on the right
    fx, fy, cx, cy, baseline = (float(recorded[name]) for name in ("fu", "fv", "cu", "cv", "b"))
    return UtiasTables(
        time,
        *_camera_path(recorded),
        landmarks=recorded["rho_i_pj_i"].T,
        tracks=tracks,
        pixels=images[..., :2],
        stereo_depth=fx * baseline / (images[..., 0] - images[..., 2]),
        focal=np.array([fx, fy]),
        centre=np.array([cx, cy]),
        baseline=baseline,
    )


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
        write_whole(file, content)
    except OSError as error:
        raise DatasetUnavailable(
            f"the UTIAS recording could not be fetched ({error}); is there no network?  Download "
            f"{UTIAS_ADDRESS} by hand and give its place as path= or in the environment variable "
            f"{UTIAS_VARIABLE}"
        ) from error
    return file


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _camera_path(recorded: dict[str, Any]) -> tuple[Array, Rotation, Array, Array]:
    """Position, orientation, velocity and angular velocity of the left camera."""
    world_from_body = Rotation.from_rotvec(recorded["theta_vk_i"].T)
    # from_matrix() takes the nearest rotation, so C_c_v need not be orthonormal to the last digit.
    world_from_camera = world_from_body * Rotation.from_matrix(recorded["C_c_v"]).inv()
    camera_in_world = recorded["r_i_vk_i"].T + world_from_body.apply(recorded["rho_v_c_v"])

    time = recorded["t"]
    fit = np.array([_local_fit(time, camera_in_world, world_from_camera, k) for k in range(time.size)])
    (position, rotation), (position_rate, rotation_rate) = (np.split(fit[:, i], 2, axis=1) for i in (0, 1))
    orientation = world_from_camera * Rotation.from_rotvec(rotation)
    # The first two terms of the series for w in the fit's correction phi.  The others change w by less than
    # 1e-4 rad/s in every track, and by up to 0.007 rad/s only outside them, at an outlying attitude at 10 s.
    angular_velocity = rotation_rate - np.cross(rotation, rotation_rate) / 2
    return position, orientation, orientation.inv().apply(position_rate), angular_velocity


def _local_fit(time: Array, position: Array, attitude: Rotation, k: int) -> Array:
    """Values (row 0) and rates (row 1) at t_k of the quadratics fitted to p and phi = log(R_k^T R)."""
    distance = np.abs(time - time[k])
    near = np.flatnonzero(distance <= HALF_WINDOW)
    if near.size < FEWEST_POSES:
        near = np.argsort(distance, kind="stable")[:FEWEST_POSES]
    rotation = (attitude[k].inv() * attitude[near]).as_rotvec()
    powers = np.vander(time[near] - time[k], 3, increasing=True)
    coefficients: Array = np.linalg.lstsq(powers, np.hstack([position[near], rotation]), rcond=None)[0]
    return coefficients[:2]


def _tracks(time: Array, seen: Flags) -> tuple[Sighting, ...]:
    """Landmarks seen at consecutive samples, long enough and without a gap; `seen` has the shape (K, L)."""
    tracks = []
    for landmark, column in enumerate(seen.T):
        samples = np.flatnonzero(column)
        interrupted = (np.diff(samples) > 1) | (np.diff(time[samples]) > LONGEST_GAP)
        for run in np.split(samples, np.flatnonzero(interrupted) + 1):
            if run.size and time[run[-1]] - time[run[0]] >= SHORTEST_TRACK:
                tracks.append(Sighting(landmark, int(run[0]), int(run[-1])))
    return tuple(sorted(tracks, key=lambda track: (track.first, track.last, track.point)))
