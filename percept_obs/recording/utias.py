"""UTIAS recording: landmarks at known places, seen by one moving stereo camera.

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
from pathlib import Path

from percept_obs.recording import Recording
from percept_obs.recording.stereo_mat import StereoTracks, read_stereo_mat
from percept_obs.validation import checked, write_whole

UTIAS_ADDRESS = (
    "https://raw.githubusercontent.com/utiasSTARS/msckf-swf-comparison/"
    "ad9566ef35c3e4792a89b04623e1fa2f99238435/datasets/dataset3.mat"
)
UTIAS_SHA256 = "ac7f9d90199d376875ef13a472d94b728e84f38ce70b7c7ed145060c895e02e5"
UTIAS_FILE = "dataset3.mat"
UTIAS_CUT = Path(__file__).parent / "utias_cut" / "dataset3_cut.mat"
"""Cut of the recording that comes with this package: all poses, and all tracks of 3 s or more."""
UTIAS_VARIABLE = "PERCEPT_OBS_UTIAS"

PIXEL_SIGMA = 4.0  # pixels, standard deviation of an image point from where the poses predict it


@checked
def find_utias(path: str | os.PathLike[str] | None = None) -> Path:
    """Return the recording's file on this machine, its SHA-256 checked; it is fetched on first use, or a cut is taken.

    Parameters
    ----------
    path : str or path, optional
        The file dataset3.mat or a folder that holds it; the environment variable PERCEPT_OBS_UTIAS when left out.
        Without either the file is fetched once from the laboratory's repository and kept in this user's cache.  Where
        that fails, it is `UTIAS_CUT`, which has all that `load_utias` reads, and a printed sentence says so.

    Raises
    ------
    FileNotFoundError
        If the path or the variable names nothing, or a folder without dataset3.mat.
    ValueError
        If the file there is neither the recording nor the cut, byte for byte.

    See Also
    --------
    load_utias : Reads it.

    Examples
    --------
    >>> find_utias(UTIAS_CUT).name
    'dataset3_cut.mat'
    """
    if path is not None:
        return _checked(Path(path), "path=")
    if place := os.environ.get(UTIAS_VARIABLE):
        return _checked(Path(place), f"the environment variable {UTIAS_VARIABLE}")
    return _fetched()


@checked
def load_utias(path: str | os.PathLike[str] | None = None) -> tuple[Recording, ...]:
    """Return 44 tracks of landmarks seen by a moving camera, as recordings with both image coordinates.

    The motion is rigid: the point rests and the camera moves, as of `rigid`.  The truth is
    the known landmark seen from the fitted pose; `Recording.distances` has the independent ``"stereo"`` depth. A
    measured pixel agrees with the poses to about `PIXEL_SIGMA` pixels, which sets the noise variance.  They last 3.0 to
    8.6 s.

    Parameters
    ----------
    path : path, optional
        See `find_utias`, also for the exceptions.

    See Also
    --------
    percept_obs.points.utias.load_utias_points : All landmarks as one state.

    Examples
    --------
    >>> len(load_utias(UTIAS_CUT))
    44
    """
    return utias_tracks(path).recordings("UTIAS", PIXEL_SIGMA)


@checked
def utias_tracks(path: str | os.PathLike[str] | None = None) -> StereoTracks:
    """Return the camera's motion and the landmarks' tracks in the recording.

    The camera's position, orientation, velocity and angular velocity come from quadratics in time, fitted around each
    sample to the recorded poses within 0.30 s, or to the nearest five where these are fewer.  The recorded gyroscope is
    not used: it agrees poorly with the motion of the image.  A track is a landmark seen at consecutive samples for at
    least 3 s, without a gap of more than 0.30 s.  There are 1900 samples of the camera, 20 landmarks and 44 tracks with
    2739 measurements.

    Parameters
    ----------
    path : path, optional
        See `find_utias`, also for the exceptions.

    See Also
    --------
    load_utias : Each track as a recording.

    Notes
    -----
    The recorded poses miss the measured pixels by slowly varying offsets: in the median 4 to 13 px, about one
    degree of attitude, in 42 tracks, but 22 and 19 px in tracks 14 and 15.  Treat a pixel as known to about
    4 px.

    Examples
    --------
    >>> len(utias_tracks(UTIAS_CUT).tracks)
    44
    """
    return read_stereo_mat(find_utias(path))


def _checked(place: Path, origin: str) -> Path:
    """Return the file that a path or a folder names, its hash checked."""
    place = place.expanduser()
    file = place / UTIAS_FILE if os.path.isdir(place) else place
    if not os.path.isfile(file):
        problem = f"a folder without {UTIAS_FILE}" if os.path.isdir(place) else "neither a file nor a folder"
        raise FileNotFoundError(
            f"{origin} names '{place}', which is {problem}; name {UTIAS_FILE} or a folder that holds it, "
            f"or name nothing and it is fetched from {UTIAS_ADDRESS}"
        )
    found = _digest(file.read_bytes())
    if found not in (UTIAS_SHA256, _digest(UTIAS_CUT.read_bytes())):
        raise ValueError(
            f"{origin} names '{file}', which is another file or a damaged one: its SHA-256 is {found}, "
            f"expected {UTIAS_SHA256}; download it again from {UTIAS_ADDRESS}"
        )
    return file


def _fetched() -> Path:
    """Return the file in the system's cache, fetched if it is not there, or the cut if it cannot be."""
    from platformdirs import user_cache_path

    file = user_cache_path("percept_obs") / UTIAS_FILE
    if file.is_file() and _digest(file.read_bytes()) == UTIAS_SHA256:
        return file
    try:
        with urllib.request.urlopen(UTIAS_ADDRESS, timeout=5) as answer:  # seconds, for each address of the server
            content = answer.read()
        found = _digest(content)
        if found != UTIAS_SHA256:
            raise ConnectionError(f"another file came, such as a login page of the network: its SHA-256 is {found}")
        file.parent.mkdir(parents=True, exist_ok=True)
        write_whole(file, content)
    except OSError as error:
        print(
            f"The UTIAS recording could not be fetched ({error}), so a cut that comes with percept_obs is read; it has "
            f"the same tracks. To have the whole, download {UTIAS_ADDRESS} and name its folder in the environment "
            f"variable {UTIAS_VARIABLE}."
        )
        return UTIAS_CUT
    return file


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
