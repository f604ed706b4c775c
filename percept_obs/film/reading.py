"""Read a film: lens and poses from a board in it, or poses that are given; tracks and distances of its points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from percept_obs.compile import Array
from percept_obs.film.board import Board, other_markers
from percept_obs.film.faults import LIMITS as FAULTS
from percept_obs.film.faults import Faults, find_faults
from percept_obs.film.film import BOARD, TRIANGULATION, Film
from percept_obs.film.lens import FEWEST_CORNERS, Seen, find_lens, find_poses
from percept_obs.film.pictures import undistorted
from percept_obs.film.sighting import LIMITS as TRACKS
from percept_obs.film.sighting import Sighting, sight
from percept_obs.film.triangulation import triangulate
from percept_obs.film.video import Video, open_film
from percept_obs.recording import Recording
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.poses import CameraPath, Poses
from percept_obs.recording.smoother import FEWEST as FEWEST_POSES
from percept_obs.recording.text_table import PathLike
from percept_obs.recording.track_table import runs
from percept_obs.system.surfaces import pinhole
from percept_obs.validation import checked

SPOILS = ("unknown", "focus", "stabilisation", "board", "lens", "noise")
"""Keys of the mistakes that are not corrected, and with which no estimate is trusted."""


@dataclass(frozen=True)
class Limits:
    """Limits that a film must keep to be read, and those by which its points are chosen."""

    looked_at: int = 8  # pictures in which other boards are looked for, where this one is not seen
    shortest: float = 1.5  # seconds that a film lasts at least
    gap: float = 0.3  # seconds without a pose or a corner, a tremor of the hand, after which another part begins
    jump: float = 20.0  # median steps from picture to picture, and metres a second, beyond which both the camera cannot
    fastest: float = 5.0  # have moved: the film was cut there
    alike: float = 1.0  # seconds of samples that count as one: errors of blur and of the lens stay alike so long
    spread: float = 2.0  # pixels by which samples of a point at rest scatter at most
    sure: float = 0.1  # largest relative standard deviation of a triangulated distance


LIMITS = Limits()


@checked
def read_film(
    path: PathLike,
    board: Board | PathLike | None = None,
    camera: PixelCamera | None = None,
    poses: Poses | None = None,
) -> Film:
    """Read a film of a printed board and of things at rest around it.

    Parameters
    ----------
    path : path
        A film that PyAV reads, such as MP4.
    board : Board or path of its file, optional
        Board in the film; the default `Board` when left out.
    camera : PixelCamera, optional
        In pixels of the upright film; found from the board when left out.
    poses : Poses, optional
        Of the camera, by the film's clock, for a film without a board; a camera is then needed.

    Returns
    -------
    Film
        A sequence of recordings, which `all_observers`, `diagnose` and `observer_lab` take as it is.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ModuleNotFoundError
        If PyAV or OpenCV is missing.
    ValueError
        If it is no film, shows no board, too little of it or two, nothing for long enough, or camera or poses do not
        fit: the camera is of another size, or poses come with a board.

    See Also
    --------
    Film : The result.
    percept_obs.recording.colmap.read_colmap : Poses of a film without a board.

    Notes
    -----
    Corners of the board, calibration, poses and optical flow are OpenCV's.  A rolling shutter is measured from the
    board, and corners are put to where they were at the time of the picture's middle.  What was seen in the pictures
    is kept in the cache of the system for the next time.

    Examples
    --------
    >>> from percept_obs.film import example_film
    >>> film = read_film(example_film())
    >>> film[0].source
    'board corner 0'
    """
    if poses is not None and camera is None:
        raise ValueError("poses are given and no camera; give also camera=PixelCamera(...), in pixels of the film")
    if poses is not None and board is not None:
        raise ValueError("poses and a board are given, and poses are for a film without a board; leave one of them out")
    video = open_film(path)
    if camera is not None and camera.size is not None and camera.size != video.size:
        raise ValueError(f"camera has the size {camera.size}, the film {video.size}; give the numbers for this size")
    printed = board if isinstance(board, Board) else Board() if board is None else Board.from_json(board)
    sighting = raw = sight(video, printed)
    fisheye = camera if camera is not None and camera.lens == "equidistant" else None
    if fisheye:  # what finds poses and faults knows the other lens
        sighting, camera = straightened(sighting, fisheye), fisheye.straight
    seen, faults, unsure = None, None, 0.0
    if poses is None:
        _refuse_unseen(sighting, printed, video)
        places = printed.points
        given = camera or find_lens(sighting.corners, places, video.size).camera
        seen = find_poses(sighting.time, sighting.corners, places, given)
        faults = find_faults(sighting.time, sighting.corners, printed, video.size, given, seen.poses, sighting.width)
        sighting = replace(sighting, corners=faults.corners, tracked=_at_the_middle(sighting, faults.readout, video))
        if camera is None:
            lens = find_lens(sighting.corners, places, video.size)
            camera, unsure = lens.camera, lens.deviation
        seen = find_poses(sighting.time, sighting.corners, places, camera)
        poses = seen.poses
    assert camera is not None
    travelled = _path(poses)
    doubt = _doubt(faults)
    found = [*_corners(sighting, printed, camera, travelled)] if seen else []
    found += _others(sighting, camera, travelled)
    if not found:
        raise ValueError(
            f"'{video.path}' shows no point for {TRACKS.shortest:g} s while the camera's pose is known; move slowly, "
            "with the board in the picture"
        )
    if fisheye:
        sighting, camera = raw, fisheye
    return Film(
        tuple(replace(each, doubt=doubt, noise_variance=_noise(each, seen)) for each in found),
        (BOARD, TRIANGULATION),
        undistorted(sighting, camera),
        video.path.name,
        video,
        camera,
        travelled,
        faults.findings if faults else (),
        sighting,
        unsure,
        printed,
        seen,
    )


def straightened(sighting: Sighting, camera: PixelCamera) -> Sighting:
    """Return a sighting with the pixels of a camera's rectified images."""
    corners, tracked = (
        camera.straight.pixels(camera.directions(pixels)) for pixels in (sighting.corners, sighting.tracked)
    )
    return replace(sighting, corners=corners, tracked=tracked)


def _noise(recording: Recording, seen: Seen | None) -> float:
    """Return the variance of white noise that is as bad as the errors of a track, and of the poses if they are known.

    Velocities of poses integrate to the poses again, so that errors of these count like errors of the image.
    """
    variance = recording.noise_variance or 0.0
    if seen is not None:
        spread = np.median(np.diagonal(seen.covariance, axis1=1, axis2=2), axis=0)
        depth = float(np.median(recording.distances[TRIANGULATION]))
        variance += float(spread[:3].mean() + spread[3:].mean() / depth**2)
    return variance * max(1.0, LIMITS.alike / float(np.median(recording.intervals)))


def _doubt(faults: Faults | None) -> str:
    """Return why estimates are not to be trusted, if a fault is not corrected."""
    spoiled = [each.sentence for each in faults.findings if each.key in SPOILS] if faults else []
    return ", and ".join(spoiled)


def _at_the_middle(sighting: Sighting, readout: Array, video: Video) -> Array:
    """Return the pixels of tracks at the times of their pictures, from those when their row or column was read."""
    moved = [np.empty((0, 2))]
    for first, pixels in sighting.tracks:
        speed = np.gradient(pixels, sighting.time[first : first + len(pixels)], axis=0)
        late = (pixels / video.size - 0.5) @ readout
        moved.append(pixels - speed * late[:, None])
    return np.concatenate(moved)


def _refuse_unseen(sighting: Sighting, board: Board, video: Video) -> None:
    """Refuse a film in which too few pictures show enough of the board."""
    count = np.isfinite(sighting.corners).all(axis=2).sum(axis=1)
    enough = int((count >= FEWEST_CORNERS).sum())
    if sighting.twice.mean() > 0.1:
        raise ValueError(f"'{video.path}' shows two boards with the same markers; leave one in the picture")
    if np.ptp(sighting.time) < LIMITS.shortest or len(count) < FAULTS.fewest:
        raise ValueError(
            f"'{video.path}' is too short: {len(count)} pictures in {np.ptp(sighting.time):.1f} s; film for 10 to 20 s"
        )
    if enough < FAULTS.fewest:
        instead = _seen_instead(video, len(count)) or "Is it this board (board=...)?"
        raise ValueError(
            f"{enough} of {len(count)} pictures of '{video.path}' show {FEWEST_CORNERS} corners of the board, "
            f"{board.name}, and {FAULTS.fewest} are needed. {instead} It must "
            "lie flat, be sharp, and fill a third of the picture's width. Without a board, give poses=... and "
            "camera=..., as of read_colmap"
        )


def _seen_instead(video: Video, pictures: int) -> str:
    """Return which other markers some of so many pictures show, in a sentence, or nothing."""
    every, scale = max(1, pictures // LIMITS.looked_at), min(1.0, TRACKS.widest / max(video.size))
    shots = (shot for k, (_, shot) in enumerate(video.shots("looking for other boards")) if k % every == 0)
    seen = [name for shot in shots for name in other_markers(shot(scale, "gray"))]
    if not seen:
        return ""
    return f"It shows a board with {max(set(seen), key=seen.count)}: print the one of percept-obs board."


def _path(poses: Poses) -> CameraPath:
    """Return smoothed poses and velocities of each part without a gap that is long enough."""
    far = np.linalg.norm(np.diff(poses.position, axis=0), axis=1)
    farthest = np.maximum(LIMITS.jump * np.median(far), LIMITS.fastest * np.diff(poses.time))
    jumps = 1 + np.flatnonzero(far > farthest)  # as at a cut
    whole = np.split(np.arange(len(poses.time)), jumps)
    parts = [part for each in whole for part in runs(poses.time, each, LIMITS.gap) if len(part) >= FEWEST_POSES]
    if not parts:
        raise ValueError(
            f"the poses have gaps of more than {LIMITS.gap:g} s everywhere; keep the board in the picture while you "
            "move"
        )
    found = [Poses(poses.time[part], poses.position[part], poses.orientation[part]).path() for part in parts]
    longest = max(found, key=lambda each: len(each.time))
    assert longest.errors is not None
    names = ("time", "position", "orientation", "velocity", "angular_velocity")
    raw = {"time": poses.time, "position": poses.position, "turns": poses.rotation.as_matrix()}
    arrays = {name: np.concatenate([getattr(each, name) for each in found]) for name in names}
    return CameraPath(**arrays, errors=replace(longest.errors, **raw))


def _corners(sighting: Sighting, board: Board, camera: PixelCamera, path: CameraPath) -> Iterator[Recording]:
    """Yield recordings of the board's corners, with their truth."""
    for number, place in enumerate(board.points):
        rows = np.flatnonzero(np.isfinite(sighting.corners[:, number]).all(axis=1))
        yield from _recordings(
            f"board corner {number}", sighting.time[rows], sighting.corners[rows, number], camera, path, place
        )


def _others(sighting: Sighting, camera: PixelCamera, path: CameraPath) -> Iterator[Recording]:
    """Yield recordings of other points at rest."""
    for number, (first, pixels) in enumerate(sighting.tracks, 1):
        time = sighting.time[first : first + len(pixels)]
        yield from _recordings(f"point {number}", time, pixels, camera, path)


def _recordings(
    name: str, time: Array, pixels: Array, camera: PixelCamera, path: CameraPath, known: Array | None = None
) -> Iterator[Recording]:
    """Yield a recording of each part of a track for which poses are known, if the point rests where rays meet."""
    row = np.searchsorted(path.time, time)
    there = (row < len(path.time)) & (path.time[np.minimum(row, len(path.time) - 1)] == time)
    surface, turns = pinhole(), path.rotation
    parts = runs(time, np.flatnonzero(there), LIMITS.gap)
    for part in parts:
        if time[part[-1]] - time[part[0]] < TRACKS.shortest:
            continue
        image = camera.directions(pixels[part])
        inside = np.isfinite(image).all(axis=1)  # the lens may end before the picture does
        part, image = part[inside], image[inside]
        if len(part) < FEWEST_POSES:
            continue
        at = row[part]
        place = triangulate(path.position[at], turns[at].as_matrix(), image)
        first = int(place.agree.argmax())  # observers start from the first sample
        if known is None and not (place.deviation < LIMITS.sure and place.spread * camera.focal[0] < LIMITS.spread):
            continue
        local = {
            key: turns[at].inv().apply(point - path.position[at])
            for key, point in ((TRIANGULATION, place.position), (BOARD, known))
            if point is not None
        }
        if not all((points[:, 2] > 0).all() for points in local.values()):
            continue
        distances = {key: points[first:, 2] for key, points in local.items()}
        yield Recording(
            time[part][first:],
            np.where(place.agree[:, None], image, np.nan)[first:],
            ("y1", "y2"),
            surface,
            path.motion,
            truth=None if known is None else surface.project(local[BOARD])[first:],
            noise_variance=place.spread**2,
            distances={**distances, BOARD: distances.get(BOARD, np.full(len(part) - first, np.nan))},
            source=name if len(parts) == 1 else f"{name}, from {time[part[0]]:.1f} s",
        )
