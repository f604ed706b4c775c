"""Surfaces differ by how they spread pixels over angles: with equal angles they tell the same."""

import numpy as np
import pytest
import sympy as sp

from percept_obs import (
    Camera,
    PerspectiveSystem,
    Scenario,
    affine,
    cramer_rao,
    ellipsoid,
    figures,
    pinhole,
    plane,
    record,
    sphere,
    unified,
)
from percept_obs.studies.fields import field_bound, pixel
from percept_obs.system.surfaces import POINT

STILL = np.zeros((3, 3))
SIDEWAYS = affine(STILL, [0.5, 0, 0])
TURNING = affine([[0, 0, 0.1], [0, 0, 0], [-0.1, 0, 0]], [0.5, 0.1, 0.1])
SURFACES = (pinhole(), plane([0.3, 0, 1]), sphere(), sphere(3), ellipsoid(np.diag([1, 1, 4.0])), unified(0.8))
SMALL = {"size": 9, "period": 0.2}
RIGHT = np.radians(90)


@pytest.mark.slow
def test_with_noise_of_equal_angle_every_surface_tells_the_same():
    first, *others = (field_bound(surface, TURNING, RIGHT, angle=0.002, **SMALL) for surface in SURFACES)
    for other in others:
        np.testing.assert_allclose(other.relative, first.relative, rtol=1e-9)


def test_with_one_output_they_do_not():
    one, other = (field_bound(s, TURNING, RIGHT, angle=0.002, measured=("y1",), **SMALL) for s in (pinhole(), sphere()))
    assert not np.allclose(one.relative, other.relative, rtol=0.1, equal_nan=True)


def test_a_direction_that_is_measured_sideways_has_the_error_of_triangulation():
    """Two samples of the ray straight ahead, a baseline apart: the range's error is that of the angle between them."""
    sigma, distance, baseline = 1e-4, 5.0, 0.5
    found = field_bound(sphere(), SIDEWAYS, 2.0, angle=sigma, seconds=1, distance=distance, period=1, size=3)
    assert found.relative[1, 1] == pytest.approx(np.sqrt(2) * sigma * distance / baseline, rel=0.02)


@pytest.mark.parametrize("degrees", [40, 150])
def test_a_wide_field_in_as_many_pixels_is_better_on_the_sphere_in_the_middle(degrees):
    flat, curved = (field_bound(s, SIDEWAYS, np.radians(degrees)) for s in (pinhole(), sphere()))
    edge = np.radians(degrees) / 2
    ratio = flat.within(0, edge / 3) / curved.within(0, edge / 3)
    # how much finer the middle is: dr/dtheta over the radius of the picture
    expected = (np.tan(edge) / 1) / (np.tan(edge / 2) / 0.5)
    assert ratio == pytest.approx(expected, rel=0.07)
    assert (ratio > 2) == (degrees == 150)


def test_on_the_sphere_three_numbers_with_equal_noise_are_a_ray_with_the_noise_of_an_angle():
    angle = 0.5 * pixel(sphere(3), RIGHT, 640)
    whole, rays = (field_bound(sphere(3), TURNING, RIGHT, angle=each, **SMALL) for each in (None, angle))
    np.testing.assert_allclose(whole.relative, rays.relative, rtol=1e-9)


def test_a_third_output_of_a_plane_that_faces_the_camera_tells_nothing():
    two, three = (field_bound(plane([0, 0, 1], outputs), TURNING, RIGHT, **SMALL) for outputs in (2, 3))
    np.testing.assert_allclose(two.relative, three.relative, rtol=1e-12)
    tilted = [field_bound(plane([0.5, 0, 1], outputs), TURNING, 1.0, **SMALL) for outputs in (2, 3)]
    assert (tilted[1].relative < tilted[0].relative)[np.isfinite(tilted[0].relative)].all()


def test_what_leaves_the_field_of_view_tells_no_more():
    found = field_bound(pinhole(), affine(STILL, [1.0, 0, 0]), RIGHT, angle=0.002, size=21)
    assert found.relative[10, -1] > 0.7
    assert found.relative[10, 0] < 0.01


@pytest.mark.parametrize("surface", [pinhole(), sphere()], ids=["pinhole", "sphere"])
def test_it_is_the_bound_of_the_trajectory(surface):
    away, seconds, prior = 4.0, 1.0, 0.5
    motion = affine([[0.0, -0.1, 0.0], [0.1, 0.0, 0.2], [0.0, -0.2, 0.0]], [0.5, 0.1, 0.2])
    found = field_bound(surface, motion, RIGHT, seconds=seconds, distance=away, size=5, prior=prior)
    start = away * np.array([np.sin(RIGHT / 4), 0.0, np.cos(RIGHT / 4)])
    variance = (0.5 * pixel(surface, RIGHT, 640)) ** 2
    recording = record(Scenario("one direction", motion, start, seconds, surface), camera=Camera(0.05))
    seen = sp.Matrix([*surface.image, 1 / surface.distance]).jacobian(POINT)
    there = np.array(seen.subs(dict(zip(POINT, start, strict=True))), dtype=float)
    form = PerspectiveSystem(motion, surface).measure("y1", "y2")
    bound = cramer_rao(recording, form, there @ there.T * (prior * away) ** 2, variance)
    end = recording.points[-1]
    back = np.linalg.inv(np.array(seen.subs(dict(zip(POINT, end, strict=True))), dtype=float))
    along = end / np.linalg.norm(end) @ back
    expected = np.sqrt(along @ bound.covariance[-1] @ along) / np.linalg.norm(end)
    assert found.relative[2, 3] == pytest.approx(expected, rel=1e-6)


def test_a_motion_that_varies_in_name_only_tells_the_same():
    constant = field_bound(pinhole(), affine(STILL, [0.5, 0, 0]), RIGHT, **SMALL)
    sampled = affine([STILL, STILL], [[0.5, 0, 0]] * 2, [0.0, 5.0])
    found = field_bound(pinhole(), sampled, RIGHT, **SMALL)
    np.testing.assert_allclose(found.relative, constant.relative)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"field_of_view": np.radians(190)}, "the pinhole sees 180"),
        ({"field_of_view": 0.0}, "in radians"),
        ({"measured": ("y3",)}, "has the outputs y1, y2"),
        ({"measured": ()}, "cannot be measured"),
        ({"distance": -1.0}, "distance is -1.0"),
        ({"pixels": 0.0}, "positive"),
        ({"motion": affine()}, "has no numbers"),
        ({"size": 10**5}, "fewer directions"),
    ],
)
def test_what_makes_no_sense_is_refused(change, words):
    with pytest.raises(ValueError, match=words):
        field_bound(**{"surface": pinhole(), "motion": SIDEWAYS} | change)


def test_the_figure_draws_and_tells_each_surface():
    found = [field_bound(s, SIDEWAYS, RIGHT, **SMALL) for s in (pinhole(), sphere())]
    figure = figures.fields(found)
    assert [ax.get_title() for ax in figure.axes] == ["pinhole", "sphere"]
    assert all(ax.images[0].get_clim() == figure.axes[0].images[0].get_clim() for ax in figure.axes)
    assert f"pinhole, y1, y2 measured: {100 * found[0].within(0, RIGHT / 6):.2g} %" in figure.text
    given = figures.fields(found[0], axes=[figure.axes[0]])
    assert given.axes == figure.axes[:1]
    with pytest.raises(ValueError, match="FieldBound"):
        figures.fields([])
    assert "FieldBound of y1, y2 on the pinhole" in repr(found[0])
