"""Pixels and image coordinates are each other's inverse, and a homography gives back motion and depth."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refuses
from scipy.spatial.transform import Rotation

from percept_obs.recording.pixels import PixelCamera
from percept_obs.structure.pixels import CHWA_CAMERA, SignalToNoise, homography

small = st.floats(-0.3, 0.3)
vectors = st.tuples(small, small, small)


def patch(count, seed=0, normal=(-0.3, 0.2, 1.0)):
    """Points on a plane n . X = d in front of the camera, with n and d."""
    offsets = np.random.default_rng(seed).uniform(-0.3, 0.3, (count, 2)) @ np.linalg.svd([normal])[2][1:]
    points = offsets + np.array([0.3, 0.2, 2.0])
    return points, np.array(normal), points[0] @ normal


def seen(points):
    return points[..., :2] / points[..., 2:]


@given(st.floats(10, 2000), st.floats(10, 2000), st.tuples(small, small))
def test_pixels_and_image_coordinates_are_each_others_inverse(f1, f2, image):
    camera = PixelCamera((f1, f2), (320, 240))
    pixels = camera.pixels(image)
    np.testing.assert_allclose(camera.image(pixels), image, atol=1e-12)
    np.testing.assert_allclose(camera.matrix @ [*image, 1], [*pixels, 1])


def test_the_intrinsic_matrix_is_that_of_the_paper():
    np.testing.assert_array_equal(CHWA_CAMERA.matrix, [[720, 0, 320], [0, 720, 240], [0, 0, 1]])


test_a_camera_that_is_none_is_refused = refuses(
    lambda settings: PixelCamera(**settings),
    ({"focal": (720, 0)}, "focal is .* two positive numbers"),
    ({"focal": (720,)}, "focal is"),
    ({"focal": (720, 720), "centre": (np.nan, 0)}, "centre is .* two finite numbers"),
    ({"focal": (720, 720), "size": (640, -1)}, "size is"),
)


LENS = PixelCamera((500, 400), (320, 240), distortion=(-0.3, 0.1, 0.01, 0.02, 0.05))


def test_a_lens_distorts_as_opencv_has_it():
    """By hand, at (0.5, 0.25), where r^2 = 0.3125."""
    radial = 1 - 0.3 * 0.3125 + 0.1 * 0.3125**2 + 0.05 * 0.3125**3
    x = 0.5 * radial + 2 * 0.01 * 0.125 + 0.02 * (0.3125 + 2 * 0.25)
    y = 0.25 * radial + 0.01 * (0.3125 + 2 * 0.0625) + 2 * 0.02 * 0.125
    np.testing.assert_allclose(LENS.pixels([0.5, 0.25]), [320 + 500 * x, 240 + 400 * y], rtol=1e-14)
    rational = PixelCamera((1, 1), distortion=(-0.3, 0.1, 0, 0, 0.05, 0.2, 0.3, 0.4))
    below = 1 + 0.2 * 0.3125 + 0.3 * 0.3125**2 + 0.4 * 0.3125**3
    np.testing.assert_allclose(rational.pixels([0.5, 0.25]), np.array([0.5, 0.25]) * radial / below, rtol=1e-14)


@given(st.lists(st.tuples(st.floats(-0.7, 0.7), st.floats(-0.7, 0.7)), min_size=1, max_size=5))
def test_what_a_lens_did_is_undone(images):
    np.testing.assert_allclose(LENS.image(LENS.pixels(images)), images, rtol=1e-12, atol=1e-13)


def test_a_lens_that_sees_nothing_there_says_so():
    assert np.isnan(LENS.image([np.nan, np.nan])).all()
    folds = PixelCamera((500, 500), distortion=(-2, 0, 0, 0))  # its images end at r = 0.272
    np.testing.assert_allclose(folds.pixels(folds.image([100.0, 80.0])), [100, 80], rtol=1e-12)
    with pytest.raises(ValueError, match=r"no direction is seen at the pixel \(300, 200\).*in the order k1, k2, p1"):
        folds.image([[100.0, 80.0], [300.0, 200.0]])
    for wrong in ((0.1,), (0.1, 0, 0, np.nan), (0.1,) * 6):
        with pytest.raises(ValueError, match=r"the distortion is .*4, 5, 8 finite numbers"):
            PixelCamera((1, 1), distortion=wrong)


FISHEYE = PixelCamera((282, 281), (416, 397), distortion=(-0.003, 0.054, -0.052, 0.011), lens="equidistant")


@given(st.lists(st.tuples(st.floats(0, 1.4), st.floats(0, 6.28)), min_size=1, max_size=5))
def test_what_a_fisheye_did_is_undone(directions):
    angle, around = np.array(directions).T
    image = np.tan(angle)[:, None] * np.stack([np.cos(around), np.sin(around)], axis=1)
    pixels = FISHEYE.pixels(image)
    a, (k1, k2, k3, k4) = angle, FISHEYE.distortion
    seen = a * (1 + k1 * a**2 + k2 * a**4 + k3 * a**6 + k4 * a**8)
    np.testing.assert_allclose(np.linalg.norm((pixels - FISHEYE.centre) / FISHEYE.focal, axis=1), seen, atol=1e-12)
    np.testing.assert_allclose(FISHEYE.image(pixels), image, rtol=1e-9, atol=1e-12)


def test_a_fisheye_is_that_of_opencv():
    image = np.random.default_rng(0).uniform(-3, 3, (20, 2))
    expected = cv2.fisheye.distortPoints(image[None], FISHEYE.matrix, np.array(FISHEYE.distortion))[0]
    np.testing.assert_allclose(FISHEYE.pixels(image), expected, atol=1e-9)


def test_a_fisheye_shows_nothing_on_a_plane_beyond_a_right_angle():
    wide = PixelCamera((100, 100), lens="equidistant")
    assert np.isnan(wide.directions([[158.0, 0.0], [200.0, 0.0]])).all()
    with pytest.raises(ValueError, match=r"no direction is seen at the pixel \(158, 0\).*in the order k1, k2, k3, k4"):
        wide.image([158.0, 0.0])


def test_a_ratio_of_powers():
    pixels = np.array([[300.0, 400.0], [0.0, 0.0]])
    assert SignalToNoise(20).sigma(pixels) == pytest.approx(np.sqrt(500**2 / 4) / 10)
    noisy = SignalToNoise(40).sigma(np.full((10_000, 2), 500.0)) * np.random.default_rng(0).normal(size=(10_000, 2))
    assert 10 * np.log10(500**2 / np.mean(noisy**2)) == pytest.approx(40, abs=0.1)
    with pytest.raises(ValueError, match="must be finite"):
        SignalToNoise(float("inf"))


@given(vectors, vectors, st.integers(4, 12))
def test_a_homography_is_the_motion_of_the_patch(turn, shift, count):
    """H = R + t n^T / d, with the second singular value 1, and (H m*)_3 the ratio of the depths."""
    points, normal, distance = patch(count)
    R = Rotation.from_rotvec(turn).as_matrix()
    moved = points @ R.T + shift
    H = homography(seen(points), seen(np.stack([points, moved])))
    expected = R + np.outer(shift, normal) / distance
    np.testing.assert_allclose(H[0], np.eye(3), atol=1e-7)
    np.testing.assert_allclose(H[1], expected, atol=1e-7)
    np.testing.assert_allclose(np.linalg.svd(H[1], compute_uv=False)[1], 1, atol=1e-9)
    ratio = H[1][2] @ np.vstack([seen(points).T, np.ones(count)])
    np.testing.assert_allclose(ratio, moved[:, 2] / points[:, 2], atol=1e-7)


def test_more_points_leave_less_noise():
    spread = []
    for count in (9, 81):
        points, *_ = patch(count, normal=(0, 0, 1.0))
        images = seen(np.broadcast_to(points, (400, count, 3)))
        H = homography(seen(points), images + np.random.default_rng(1).normal(0, 1e-4, images.shape))
        spread.append((H[:, 2] @ [*seen(points)[0], 1]).std())
    assert spread[1] < 0.6 * spread[0]


test_points_that_give_no_homography_are_refused = refuses(
    lambda reference, images: homography(reference, images),
    (np.zeros((3, 2)), np.zeros((3, 2)), "at least 4 points"),
    (np.zeros((4, 2)), np.zeros((5, 2)), r"shape \(4, 2\) and the images \(5, 2\)"),
    (np.full((4, 2), np.nan), np.zeros((4, 2)), "not finite"),
    (np.column_stack([np.arange(4.0)] * 2), np.eye(4)[:, :2], "lie on a line"),
)
