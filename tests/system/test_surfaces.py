"""A point is found again from its image and distance on every surface, and what has no image is refused."""

from functools import partial

import numpy as np
import pytest
import sympy as sp
from examples import SURFACES
from hypothesis import given
from hypothesis import strategies as st
from refusals import refuses

from percept_obs import ImagingSurface, chained, ellipsoid, pinhole, plane, sphere, unified
from percept_obs.system.surfaces.base import X, Y, Z

coordinate = st.floats(-3, 3)
point = st.tuples(coordinate, st.floats(0.2, 3), st.floats(1.5, 9))


@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
@given(point=point)
def test_a_point_is_found_again(surface, point):
    np.testing.assert_allclose(surface.locate(surface.project(point)), point, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
@given(point=point, scale=st.floats(0.1, 10))
def test_the_image_stays_and_the_distance_scales(surface, point, scale):
    near, far = surface.project(point), surface.project(np.multiply(scale, point))
    np.testing.assert_allclose(far[:-1], near[:-1], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(far[-1] * scale, near[-1], rtol=1e-9)


def test_an_inverse_distance_that_is_not_positive_has_no_finite_point():
    located = pinhole().locate([[0.1, 0.2, 0.0], [0.1, 0.2, -1.0], [0.1, 0.2, 0.5]])
    assert np.isinf(located[:2]).all()
    np.testing.assert_allclose(located[2], [0.2, 0.4, 2])


test_points_and_shapes_that_are_none_are_refused = refuses(
    lambda call: call(),
    *((partial(pinhole().project, p), r"\(\.\.\., 3\), all finite") for p in ([1, 2], [[1, 2, 3, 4]], [1, np.nan, 2])),
    (lambda: pinhole().locate([1, 2]), r"y1, y2, y3 have the shape .* expected \(\.\.\., 3\)"),
    (lambda: plane().project([1, 2, 3]), "no values for n1, n2, n3"),
    *((partial(plane, normal), "normal vector") for normal in ((0, 0, 0), (1, 0, 0), (1, 2), (1, np.nan, 1))),
    (lambda: plane(outputs=4), "2 or 3 outputs"),
    (lambda: sphere(4), "2 or 3 outputs, not 4"),
    (lambda: ellipsoid(outputs=1), "2 or 3 outputs, not 1"),
    (lambda: ellipsoid(np.diag([1.0, 1.0, -1.0])), "the eigenvalue -1"),
    (lambda: ellipsoid([[1, 1, 0], [0, 1, 0], [0, 0, 1]]), "symmetric matrix"),
    (lambda: ellipsoid(np.eye(2)), r"shape \(2, 2\)"),
    (lambda: unified(-0.1), "xi of the unified model is -0.1"),
    (lambda: unified(np.inf), "0 or more and finite"),
)


def test_a_ray_off_the_surface_is_refused():
    y1, y2 = sp.symbols("y1 y2", real=True)
    with pytest.raises(ValueError, match="must be the point"):
        ImagingSurface("wrong", (X / Z, Y / Z), Z, (y1, y2, 2))
    with pytest.raises(ValueError, match="ray of three entries"):
        ImagingSurface("flat", (X / Z, Y / Z), Z, (y1, y2))


def test_what_is_derived_for_a_symbolic_plane_fits_every_plane():
    assert plane().fits(plane((0.1, 0.2, 1)))
    assert not plane((0.1, 0.2, 1)).fits(plane((0.2, 0.2, 1)))
    assert not pinhole().fits(chained())
