"""A film through an equidistant lens is straightened before poses are found, and its pictures too."""

from types import SimpleNamespace

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from percept_obs import PixelCamera
from percept_obs.film import Board
from percept_obs.film.lens import find_poses
from percept_obs.film.pictures import undistorted
from percept_obs.film.reading import straightened
from percept_obs.film.sighting import Sighting

LENS = PixelCamera((300, 300), (400, 300), (800, 600), (-0.01, 0.05, -0.05, 0.01), "equidistant")


def test_poses_through_a_fisheye_are_those_of_its_corners():
    places, time = Board().points, np.arange(5) / 10
    turns = Rotation.from_rotvec(np.outer(time, [0.5, 1.0, 0.2]) + np.array([np.pi, 0, 0]))
    position = places.mean(axis=0) + np.stack([0.1 * time, 0 * time, 0.25 + 0 * time], axis=1)
    seen = np.stack([turns.inv().apply(place - position) for place in places], axis=1)
    corners = LENS.pixels(seen[..., :2] / seen[..., 2:]) + np.random.default_rng(0).normal(0, 0.02, (5, len(places), 2))
    nothing = {"time": time, "corners": corners, "tracked": np.full((2, 2), np.nan)}
    empty = dict.fromkeys(set(Sighting.__dataclass_fields__) - nothing.keys())
    flat = straightened(Sighting(**empty, **nothing), LENS)
    found = find_poses(time, flat.corners, places, LENS.straight)
    np.testing.assert_allclose(found.poses.position, position, atol=1e-3)
    assert (found.poses.rotation.inv() * turns).magnitude().max() < 5e-3


def test_pictures_of_a_fisheye_are_straightened():
    image = np.stack(np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-0.7, 0.7, 7)), axis=-1).reshape(-1, 2)
    picture = np.zeros((600, 800), np.uint8)
    for place in LENS.pixels(image):
        cv2.circle(picture, tuple(map(int, np.round(place))), 4, 255, -1)
    small = (cv2.imencode(".png", picture)[1].tobytes(),)
    straight = undistorted(SimpleNamespace(small=small, shown=np.zeros(1)), LENS)
    shown = cv2.imdecode(np.frombuffer(straight.images[0], np.uint8), cv2.IMREAD_UNCHANGED)
    places = np.round(LENS.straight.pixels(image)).astype(int)
    inside = ((places > 5) & (places < [795, 595])).all(axis=1)
    assert inside.sum() > 20
    assert (shown[places[inside, 1], places[inside, 0]] > 120).all()
