"""Rendered films hold the truth: their corners, times, depths and occlusions are where the truth says they are."""

from dataclasses import replace

import av
import cv2
import numpy as np
import pytest
from film_renderer import BOARD, Faults, Motion, Truth, paper, pictures, placements, quick_film, scene, stored

from percept_obs import PixelCamera

LENS = (0.08, -0.02, 0.0003, -0.0004)
TELEPHONE = {"readout": 0.06, "exposure": 0.02, "focus": 0.02, "stabilised": 5.0, "uneven": 0.5}
"""Faults; the shutter is slow, so that it is seen beside the noise of corners."""


def truth_of(sheets, size=(640, 360), **faults):
    """Three frames a second apart."""
    time, motion, faults = np.arange(3.0), Motion(seed=1), Faults(**faults)
    camera = PixelCamera((500, 501), (size[0] / 2 + 4, size[1] / 2 - 3), size, LENS)
    return Truth(time, camera, sheets, motion, faults, placements(time, camera, motion, faults, 1))


@pytest.mark.parametrize("size", [(640, 360), (360, 640)])
def test_rays_meet_the_board_where_its_corners_are(size):
    truth = truth_of((paper(500),), size, readout=0.03, focus=0.02, stabilised=5.0)
    time = truth.row_time(2, truth.corners(2))
    position, rotation = truth.motion.pose(time)
    expected = rotation.inv().apply(BOARD.points - position)[:, 2]
    assert truth.distance_at(time, truth.corners(2)) == pytest.approx(expected, rel=1e-9)
    assert np.ptp(time) > 0.005
    assert np.isnan(truth.distance_at(2.0, np.zeros((1, 2)))).all()


def test_camera_of_an_upright_picture_turns_with_it():
    camera, image = truth_of((), (360, 640)).camera, np.array([[0.2, 0.1], [-0.1, 0.3]])
    u, v = camera.pixels(image).T
    assert stored(camera).pixels(image[:, ::-1] * [1, -1]) == pytest.approx(np.stack([v, 359 - u], axis=1))


@pytest.mark.slow
def test_nearest_sheets_are_seen():
    sheets = scene(4, density=300)
    flat = tuple(replace(sheet, texture=np.full_like(sheet.texture, 10 * k + 5)) for k, sheet in enumerate(sheets))
    truth = truth_of(flat, noise=0.0)
    pixels = np.random.default_rng(0).integers(1, [639, 359], (500, 2))
    grey = next(pictures(truth))
    inside = cv2.erode(grey, np.ones((3, 3))) == cv2.dilate(grey, np.ones((3, 3)))
    depth, seen = truth.distance_at(0.0, pixels), set()
    for (u, v), z in zip(pixels, depth, strict=True):
        if inside[v, u]:
            k = (grey[v, u] - 5) // 10
            assert z == pytest.approx(*replace(truth, sheets=flat[k : k + 1]).distance_at(0.0, np.array([[u, v]])))
            seen.add(k)
    assert len(seen) > 8


@pytest.mark.slow
@pytest.mark.parametrize(("size", "faults"), [((640, 360), {}), ((360, 640), TELEPHONE)])
def test_board_is_found_in_a_film_where_the_truth_says(tmp_path, size, faults):
    path, truth = quick_film(2, tmp_path, size, 1.0, rate=8, black=(4,), **faults)
    found, unshuttered = [], []
    still = replace(truth, faults=replace(truth.faults, readout=0.0))
    with av.open(str(path)) as film:
        frames = list(film.decode(video=0))
    assert [frame.time for frame in frames] == pytest.approx(truth.time, abs=1e-6)
    assert len(frames) == 8
    for number, frame in enumerate(frames):
        grey = np.ascontiguousarray(np.rot90(frame.to_ndarray(format="gray"), frame.rotation // 90))
        assert grey.shape == size[::-1]
        if number == 4:
            assert grey.mean() < 10
            continue
        corners, pixels, *_ = BOARD.detect(grey)
        found.append(pixels - truth.corners(number)[corners])
        unshuttered.append(pixels - still.corners(number)[corners])
    found, unshuttered = np.concatenate(found), np.concatenate(unshuttered)
    assert len(found) > 0.95 * 7 * len(BOARD.points)
    assert np.sqrt(np.mean(found**2)) < 0.15
    assert np.abs(found.mean(axis=0)).max() < 0.03
    if truth.faults.readout:
        assert np.sqrt(np.mean(unshuttered**2)) > 2 * np.sqrt(np.mean(found**2))
