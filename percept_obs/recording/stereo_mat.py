"""Tracks of a stereo camera in the MATLAB files of the STARS Laboratory: its own recording, and drives of KITTI.

The files hold t, y_k_j (4 x K x L: left u, v, right u, v; -1 where not seen), r_i_vk_i and theta_vk_i (position and
rotation vector of the body), C_c_v and rho_v_c_v (how the camera is mounted), rho_i_pj_i (places of the landmarks,
where they are known), fu, fv, cu, cv and b; see https://github.com/utiasSTARS/msckf-swf-comparison.
"""

from __future__ import annotations

import os
import zlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatReadError
from scipy.spatial.transform import Rotation

from percept_obs.compile import Array, Flags
from percept_obs.recording import Recording, Sighting
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.plausibility import Unlikely
from percept_obs.recording.poses import CameraPath, Poses
from percept_obs.recording.text_table import existing
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import pinhole
from percept_obs.system.view import View
from percept_obs.validation import checked, numbers, warn

NOT_SEEN = -1.0
SHORTEST_TRACK = 3.0  # s
LONGEST_GAP = 0.30  # s, between two samples of one track

VARIABLES = ("t", "y_k_j", "r_i_vk_i", "theta_vk_i", "C_c_v", "rho_v_c_v", "fu", "fv", "cu", "cv", "b")
LANDMARKS = "rho_i_pj_i"
"""The variable with their places, of shape (3, L); a file of tracked corners has none."""


@dataclass(frozen=True, eq=False)
class StereoTracks:
    """Tracks of L landmarks in K samples of a stereo camera, and how it moves.

    Parameters
    ----------
    poses : Poses
        Of the left camera, as recorded.
    path : CameraPath
        Smoothed poses and velocities.
    images : array of shape (K, L, 4)
        (u, v) in the left image and in the right one; NaN outside the tracks.
    camera : PixelCamera
        Of the left images, which are rectified.
    baseline : float
        Distance from the left to the right camera in metres.
    tracks : tuple of Sighting
        When a landmark is seen without interruption, in the order in which they begin and end.
    landmarks : array of shape (L, 3) or None
        Places in the world, in metres.

    See Also
    --------
    read_stereo_mat : Reads them.

    Examples
    --------
    >>> from percept_obs.recording.utias import utias_tracks, UTIAS_CUT
    >>> track = utias_tracks(UTIAS_CUT).recordings("UTIAS", pixel_sigma=4.0)[0]
    >>> round(track.distances["stereo"][0].item(), 4)
    0.8313
    """

    poses: Poses
    path: CameraPath
    images: Array
    camera: PixelCamera
    baseline: float
    tracks: tuple[Sighting, ...]
    landmarks: Array | None

    @property
    def time(self) -> Array:
        """Seconds, increasing, not evenly spaced, shape (K,)."""
        return self.poses.time

    @property
    def motion(self) -> Motion:
        """Motion of a point at rest in the camera's frame: X' = -v - w x X."""
        return self.path.motion

    @property
    def pixels(self) -> Array:
        """Measured (u, v) in the left image, shape (K, L, 2); NaN outside the tracks."""
        return self.images[..., :2]

    @cached_property
    def stereo_depth(self) -> Array:
        """Depth fx baseline / (u_left - u_right) in metres, shape (K, L): independent of the poses."""
        disparity = self.images[..., 0] - self.images[..., 2]
        with np.errstate(divide="ignore"):
            return np.where(disparity > 0, self.camera.focal[0] * self.baseline / disparity, np.nan)

    @cached_property
    def points(self) -> Array:
        """Landmarks in the camera's frame, from the smoothed poses, in metres, shape (K, L, 3), if they are known."""
        if self.landmarks is None:
            raise ValueError(f"the file has no {LANDMARKS}, so it is not known where the landmarks are")
        return self.path.at(self.time).sees(self.landmarks)

    def recording(
        self,
        rows: slice,
        columns: int | list[int],
        view: View,
        truth: Array | None,
        source: str,
        pixel_sigma: float | None,
    ) -> Recording:
        """Return the recording of some samples of one landmark or of several, seen as a view."""
        return Recording(
            self.time[rows],
            self.camera.image(self.pixels[rows, columns]),
            ("y1", "y2"),
            view,
            self.motion,
            truth=truth,
            noise_variance=None if pixel_sigma is None else self.camera.variance(pixel_sigma),
            distances={"stereo": self.stereo_depth[rows, columns]},
            source=source,
        )

    def recordings(self, name: str, pixel_sigma: float | None = None) -> tuple[Recording, ...]:
        """Return a recording of each track, its source named; the truth is the landmark from the smoothed pose.

        The standard deviation of the noise is in pixels, if it is known.
        """
        surface, found = pinhole(), []
        for number, track in enumerate(self.tracks):
            rows = slice(track.first, track.last + 1)
            truth = None if self.landmarks is None else surface.project(self.points[rows, track.point])
            source = f"{name} track {number}, landmark {track.point}"
            found.append(self.recording(rows, track.point, surface, truth, source, pixel_sigma))
        return tuple(found)


@checked
def read_stereo_mat(
    path: str | os.PathLike[str],
    shortest: float = SHORTEST_TRACK,
    gap: float = LONGEST_GAP,
) -> StereoTracks:
    """Return the tracks in a MATLAB file of a stereo camera.

    Parameters
    ----------
    path : path
        Up to version 7 of the format.
    shortest : float
        Seconds that a track lasts at least.
    gap : float
        Seconds between two samples of a track at most.

    Warns
    -----
    Unlikely
        If there are poses beyond the last time, as in most drives of KITTI: those of the times are the first ones.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no such file, a variable is missing or has another shape, values are not finite, or times do not
        increase.

    See Also
    --------
    StereoTracks : What is read.
    percept_obs.recording.utias.load_utias : A file of this kind.

    Examples
    --------
    >>> from percept_obs.recording.utias import UTIAS_CUT
    >>> tracks = read_stereo_mat(UTIAS_CUT, shortest=5.0)
    >>> len(tracks.tracks), tracks.images.shape
    (13, (1900, 20, 4))
    """
    file = existing(path, "a MATLAB file of stereo tracks")
    try:
        recorded = loadmat(file, variable_names=(*VARIABLES, LANDMARKS))
    except (ValueError, TypeError, IndexError, NotImplementedError, MatReadError, OSError, zlib.error) as error:
        raise ValueError(
            f"the path names '{file}', which is no MATLAB file up to version 7 ({error}); save it with -v7"
        ) from None
    if missing := [name for name in VARIABLES if name not in recorded]:
        raise ValueError(f"'{file}' has no variable {', '.join(missing)}; it needs {', '.join(VARIABLES)}")

    def variable(name: str, *shape: int) -> Array:
        """Return a variable; MATLAB keeps vectors as matrices, and drops a last dimension of 1."""
        array = numbers(recorded[name], f"the variable {name} of '{file}'")
        if np.squeeze(array).shape != tuple(size for size in shape if size != 1) or not np.isfinite(array).all():
            raise ValueError(
                f"the variable {name} of '{file}' has the shape {array.shape}, or is not finite; expected finite "
                f"numbers of shape {shape}, and {NOT_SEEN:g} for what was not seen"
            )
        return array.reshape(shape)

    samples, points = np.size(recorded["t"]), recorded["y_k_j"].shape[2] if recorded["y_k_j"].ndim == 3 else 1
    images = np.moveaxis(variable("y_k_j", 4, samples, points), 0, -1)
    place, turned = recorded["r_i_vk_i"], recorded["theta_vk_i"]
    if place.shape == turned.shape == (3, there := place.size // 3) and there > samples:
        recorded |= {"r_i_vk_i": place[:, :samples], "theta_vk_i": turned[:, :samples]}
        warn(
            Unlikely(
                f"'{file}' has {there} poses and {samples} times: the first {samples} poses are read, and the last "
                f"{there - samples}, for which there are no images, are cut"
            )
        )
    landmarks = variable(LANDMARKS, 3, points).T if LANDMARKS in recorded else None
    fx, fy, cx, cy, baseline = (float(variable(name)) for name in ("fu", "fv", "cu", "cv", "b"))
    if not baseline > 0:
        raise ValueError(f"'{file}' has the baseline b = {baseline} m; it must be positive")

    turn = Rotation.from_rotvec(variable("theta_vk_i", 3, samples).T).as_quat()
    body = Poses(variable("t", samples), variable("r_i_vk_i", 3, samples).T, turn)
    poses = body.mounted(variable("rho_v_c_v", 3), variable("C_c_v", 3, 3).T)
    seen = np.asarray((images != NOT_SEEN).all(axis=-1))
    tracks, followed = _tracks(body.time, seen, shortest, gap), np.zeros_like(seen)
    for track in tracks:
        followed[track.first : track.last + 1, track.point] = True
    images = np.where(followed[..., None], images, np.nan)
    camera = PixelCamera((fx, fy), (cx, cy))
    return StereoTracks(poses, poses.path(), images, camera, baseline, tracks, landmarks)


def _tracks(time: Array, seen: Flags, shortest: float, gap: float) -> tuple[Sighting, ...]:
    """Return when landmarks are seen at consecutive samples, long enough and without a gap; `seen` is (K, L)."""
    tracks = []
    for landmark, column in enumerate(seen.T):
        samples = np.flatnonzero(column)
        interrupted = (np.diff(samples) > 1) | (np.diff(time[samples]) > gap)
        for run in np.split(samples, np.flatnonzero(interrupted) + 1):
            if run.size > 1 and time[run[-1]] - time[run[0]] >= shortest:
                tracks.append(Sighting(landmark, int(run[0]), int(run[-1])))
    return tuple(sorted(tracks, key=lambda track: (track.first, track.last, track.point)))
