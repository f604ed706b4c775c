"""Small pictures of a film without the lens's distortion, to be shown behind tracks."""

from __future__ import annotations

from typing import Any

import numpy as np

from percept_obs.film.sighting import Sighting
from percept_obs.recording import Frames
from percept_obs.recording.pixels import PixelCamera


def undistorted(sighting: Sighting, camera: PixelCamera) -> Frames:
    """Return the small pictures of a film, straightened, by its clock."""
    import cv2

    first: Any = cv2.imdecode(np.frombuffer(sighting.small[0], np.uint8), cv2.IMREAD_UNCHANGED)
    (height, width), (whole, _) = first.shape[:2], camera.size or first.shape[1::-1]
    factor = width / whole
    focal = factor * np.array(camera.focal)
    centre = factor * (np.array(camera.centre) + 0.5) - 0.5
    matrix = np.array([[focal[0], 0, centre[0]], [0, focal[1], centre[1]], [0, 0, 1]])
    (left, upper), (right, lower) = (-0.5 - centre) / focal, (np.array([width, height]) - 0.5 - centre) / focal
    files = sighting.small
    if camera.bends:
        lens: Any = np.array(camera.distortion or np.zeros(4))
        rectify = cv2.fisheye.initUndistortRectifyMap if camera.lens == "equidistant" else cv2.initUndistortRectifyMap
        maps = rectify(matrix, lens, np.eye(3), matrix, (width, height), cv2.CV_16SC2)
        read = (cv2.imdecode(np.frombuffer(file, np.uint8), cv2.IMREAD_UNCHANGED) for file in files)
        straight = (cv2.remap(picture, *maps, cv2.INTER_LINEAR) for picture in read)
        files = tuple(cv2.imencode(".jpg", each, [cv2.IMWRITE_JPEG_QUALITY, 80])[1].tobytes() for each in straight)
    return Frames(files, sighting.shown, (left, right, lower, upper))
