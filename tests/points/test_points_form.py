"""Images of many points, freed of their division, are linear in the state; what no image shows is named at once."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from refusals import refuses

from percept_obs import PointsForm, affine, chained, linear, pinhole, plane, rigid, sphere
from percept_obs.observability.directions import in_words, mainly
from percept_obs.points import NotLinear, UnseenDirection, body_with_origin, independent_points, point_block, rigid_body
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import POINT

y1, y2 = sp.symbols("y1 y2", real=True)
SURFACES = {
    "pinhole": pinhole(),
    "chained": chained(),
    "plane": plane((0.1, -0.2, 0.9)),
    "plane with three outputs": plane((0.1, -0.2, 0.9), outputs=3),
}


def generic(points, states, surface=None):
    """A form in which every entry of A, v and C is a symbol."""
    C = [sp.Matrix(3, states, lambda i, j, k=k: sp.Symbol(f"c{k}_{i}_{j}", real=True)) for k in range(points)]
    return PointsForm(linear(states=states), C, surface or pinhole())


@pytest.mark.parametrize("points", [1, 2, 3])
def test_the_innovation_is_linear_in_the_error(points):
    """y - H(C xhat) = E(xhat) B(y) C (x - xhat) with y = H(C x), for symbols in every place."""
    form = generic(points, 4)
    x = sp.Matrix(form.state)
    x_hat = sp.Matrix(sp.symbols("h1:5", real=True))
    images = dict(zip(form.y, form.H(x), strict=True))
    left = sp.Matrix(form.y) - form.H(x_hat) - form.E(x_hat) * form.B * form.stacked * (x - x_hat)
    for entry in left.subs(images, simultaneous=True):
        assert sp.together(entry).as_numer_denom()[0].expand() == 0


@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
def test_every_surface_with_linear_distance_has_a_block(surface):
    block = point_block(surface)
    there = dict(zip(block.y, surface.image, strict=True))
    on_the_ray = (block.B * sp.Matrix(POINT)).subs(there, simultaneous=True).subs(dict(surface.values))
    assert all(sp.cancel(entry) == 0 for entry in on_the_ray)


def test_curved_surfaces_are_refused():
    with pytest.raises(NotLinear, match="sphere"):
        PointsForm(linear(np.eye(3), np.ones(3)), np.eye(3), sphere())


@pytest.mark.slow
@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1), st.sampled_from(sorted(SURFACES)))
def test_numbers_are_those_of_the_symbols(seed, name):
    draw = np.random.default_rng(seed)
    form = PointsForm(
        linear(draw.normal(size=(5, 5)), draw.normal(size=5)), draw.normal(size=(2, 3, 5)), SURFACES[name]
    )
    x, y = draw.normal(size=5), draw.normal(size=(2, len(form.image_coordinates)))
    values = dict(zip(form.y, y.ravel(), strict=True)) | dict(form.surface.values)
    rows = np.array((form.B * form.stacked).subs(values), dtype=float)
    np.testing.assert_allclose(form.rows(y), rows, atol=1e-12)
    np.testing.assert_allclose(form.information(y), rows.T @ rows, atol=1e-12)
    seen = np.array(form.H(x).subs(values), dtype=float).reshape(2, -1)
    np.testing.assert_allclose(form.outputs(x)[form.inverse(x) > 0], seen[form.inverse(x) > 0], rtol=1e-9)
    assert np.isnan(form.outputs(x)[form.inverse(x) <= 0]).all()


def test_coefficients_are_those_of_the_motion():
    A, v = np.arange(9.0).reshape(3, 3), np.array([0.0, 1, 0])
    form = PointsForm(linear(np.stack([A, 3 * A]), v, times=[0, 2]), np.eye(3))
    found = form.coefficients([0.0, 1.0])
    np.testing.assert_allclose(found[0], [A, 2 * A])
    np.testing.assert_allclose(found[1], [v, v])
    assert form.motion.A[0, 0] == 0
    assert PointsForm(linear(np.zeros((2, 2)), np.zeros(2)), np.eye(3)[:, :2]).coefficients(0.0)[0].tolist() == [
        [[0, 0], [0, 0]]
    ]


def test_a_rigid_body_moves_like_its_points():
    """x' of the body agrees with the velocities of its points in the camera's frame."""
    w_c, v_c, w_b, v_p = np.random.default_rng(0).normal(size=(4, 3))
    form = rigid_body(3, w_c, v_c, w_b, v_p)
    x = np.random.default_rng(1).normal(size=9)
    A, v = (part[0] for part in form.coefficients(0.0))
    points, rates = form.locate(x), form.locate(A @ x + v)
    for point, rate in zip(points, rates, strict=True):
        in_the_world = v_p + np.cross(w_b, point - points[0])
        np.testing.assert_allclose(rate, in_the_world - v_c - np.cross(w_c, point))
    assert form.names[:4] == ("r_x", "r_y", "r_z", "d2_x")
    assert form.unseen.shape == (9, 0)


def test_independent_points_share_a_motion():
    form = independent_points(rigid(camera_angular_velocity=[-0.1, -0.2, -0.3], camera_velocity=[1, 2, 3]), 2)
    A, v = (part[0] for part in form.coefficients(0.0))
    x = np.arange(6.0)
    for k in range(2):
        np.testing.assert_allclose(
            (A @ x + v)[3 * k : 3 * k + 3], np.cross([0.1, 0.2, 0.3], x[3 * k : 3 * k + 3]) - [1, 2, 3]
        )


def test_an_origin_without_a_point_is_named_before_any_run():
    with pytest.warns(UnseenDirection, match="3 directions of the state.*o_x - d1_x - d2_x; o_y - d1_y - d2_y; o_z"):
        body_with_origin(2, [0.1, 0.2, 0.3])


def test_a_state_is_named_that_neither_c_nor_a_brings_into_the_images():
    motion = linear(np.diag([0.0, 0, 0, -1]), np.ones(4))
    with pytest.warns(UnseenDirection, match="a direction of the state.*: c"):
        form = PointsForm(motion, np.eye(4)[:3], names=("a1", "a2", "a3", "c"))
    np.testing.assert_allclose(np.abs(form.unseen.ravel()), [0, 0, 0, 1], atol=1e-12)
    assert PointsForm(linear(np.eye(6, k=3), np.zeros(6)), np.eye(6)[:3]).unseen.shape[1] == 0


def test_whatever_the_motion_is_taken_seriously():
    """With symbols for a motion, a direction is unseen only if no values of them show it."""
    with pytest.warns(UnseenDirection):
        PointsForm(Motion("still", sp.zeros(4), sp.zeros(4, 1), ()), np.eye(4)[:3])
    assert PointsForm(linear(states=4), np.eye(4)[:3]).unseen.shape[1] == 0


@pytest.mark.parametrize("mixed", [[[0, 1], [1, 0]], [[1, 1], [1, -1]], [[0.1, 2], [3, 0.2]]])
def test_directions_are_named_alike_however_they_are_mixed(mixed):
    apart = np.array([[1, 0, -1, 0], [0, 1, 0, -1]], dtype=float).T
    assert in_words(apart @ np.array(mixed, dtype=float), ["r_x", "r_y", "d_x", "d_y"]) == ("r_x - d_x", "r_y - d_y")


def test_an_observer_fits_recordings_of_as_many_points_on_the_same_surface():
    two = independent_points(affine(), 2)
    assert two.fits(rigid_body(2))
    assert not two.fits(independent_points(affine(), 3))
    assert not two.fits(independent_points(affine(), 2, plane((0.1, 0, 1))))
    assert not two.fits(pinhole())


test_wrong_forms_are_refused = refuses(
    lambda C, names: PointsForm(linear(np.eye(3), np.ones(3)), C, names=names),
    (np.eye(4)[:3], (), r"blocks of shape \(3, 4\); the motion has 3 states"),
    (np.zeros((0, 3, 3)), (), "blocks of shape none"),
    (np.full((3, 3), np.nan), (), "give a finite real number"),
    (np.eye(3), ("a", "b"), "2 names were given for 3 states"),
    (np.eye(3), ("a", "b", "a"), "a name of its own"),
)


test_wrong_bodies_and_motions_are_refused = refuses(
    lambda call: call(),
    (lambda: rigid_body(0), "whole number, at least 1"),
    (lambda: independent_points(affine(), -1), "whole number, at least 1"),
    (lambda: independent_points(linear(np.eye(6), np.ones(6)), 2), "has 6 states; that of a single point has 3"),
    (lambda: linear(), "pass states="),
    (lambda: linear(np.eye(2), np.ones(3)), r"shape \(3,\); expected \(2,\)"),
)


def test_the_derivation_tells_the_block():
    text = str(PointsForm(linear(np.eye(3), np.ones(3)), np.eye(3)).derivation())
    assert sp.latex(point_block(pinhole()).B) in text
    assert "1 = 1" not in text
    assert "R" in PointsForm(linear(np.eye(3), np.ones(3)), np.eye(3))._repr_latex_()


def test_directions_of_many_states_are_told_by_their_first_or_by_their_largest():
    names = [f"x{k + 1}" for k in range(8)]
    assert in_words(np.ones((8, 1)), names) == ("x1 + x2 + x3 + x4 + x5 and 3 more states",)
    assert in_words(np.eye(8)[:, :1] - np.eye(8)[:, 6:7], names) == ("x1 - x7",)
    assert mainly(np.array([0.1, -0.9, 0.2, 0.9]), names[:4]) == "x2, x4, x3"
    assert mainly(np.array([0.0, 2.0, 0.0]), names[:3]) == "x2"
