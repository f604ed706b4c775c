"""Structure and motion: every choice of unknowns that can be told apart is a canonical form, every other is refused."""

from functools import cache
from itertools import chain, combinations

import numpy as np
import pytest
import sympy as sp
from corollaries import corollary_of
from hypothesis import given
from hypothesis import strategies as st
from refusals import refuses
from scipy.spatial.transform import Rotation

from percept_obs import PerspectiveSystem, instantaneous, pinhole, rigid
from percept_obs.compile import vectorised
from percept_obs.structure import (
    COROLLARIES,
    QUANTITIES,
    ImpossibleChoice,
    LinearView,
    StructureAndMotion,
    scaled_dynamics,
)

y1, y2, ybar3, d_s, w_c1, w_c2, w_c3 = sp.symbols("y1 y2 ybar3 d_s w_c1 w_c2 w_c3", real=True)
v_c1, v_c2, v_c3, v_p1, v_p2, v_p3 = sp.symbols("v_c1:4 v_p1:4", real=True)
ALL = (d_s, v_c1, v_c2, v_c3, v_p1, v_p2, v_p3)
W = (w_c1, w_c2, w_c3)
VELOCITIES = QUANTITIES[1:]
STILL = ("v_p1", "v_p2", "v_p3")


def subsets(names, up_to):
    return chain.from_iterable(combinations(names, k) for k in range(up_to + 1))


def every_choice():
    """All unknowns, at most three, with all sets of zero velocities among the rest."""
    for unknown in subsets(QUANTITIES, 3):
        rest = [name for name in VELOCITIES if name not in unknown]
        yield from ((unknown, zero) for zero in subsets(rest, len(rest)))


def possible(unknown, zero):
    try:
        return StructureAndMotion(unknown, zero)
    except ImpossibleChoice:
        return None


@cache
def all_possible():
    return [choice for unknown, zero in every_choice() if (choice := possible(unknown, zero))]


numbers = st.floats(-2, 2).filter(lambda v: abs(v) > 0.05)
choices = st.deferred(lambda: st.sampled_from(all_possible()))


def test_the_rotation_is_that_of_the_camera():
    """A fixed point seen by a camera that turns with a rate of its own, in its own frame."""
    body_rate, point, step = np.array([0.1, -0.2, 0.3]), np.array([0.4, -0.3, 2.0]), 1e-5

    def seen(t):
        return pinhole().project(Rotation.from_rotvec(body_rate * t).inv().apply(point))

    rate = (seen(step) - seen(-step)) / (2 * step)
    at = dict(zip((y1, y2, ybar3), seen(0.0), strict=True)) | {d_s: 1} | dict.fromkeys(ALL[1:], 0)
    found = {
        sign: scaled_dynamics().rate.subs({**at, **dict(zip(W, sign * body_rate, strict=True))}) for sign in (1, -1)
    }
    np.testing.assert_allclose(np.array(found[1], dtype=float).ravel(), rate, rtol=1e-6)
    assert np.abs(np.array(found[-1], dtype=float).ravel() - rate).max() > 0.1


DETERMINANTS = {1: v_c1, 2: -1, 3: v_c3, 4: -v_c2, 5: -(d_s**3), 6: d_s**3, 7: -(d_s**3)}


@pytest.mark.parametrize("corollary", COROLLARIES, ids=lambda c: str(c.number))
def test_determinants_of_the_seven_corollaries(corollary):
    choice = corollary.choice()
    assert choice.determinant == DETERMINANTS[corollary.number] * ybar3**4
    assert corollary_of(choice) == corollary
    assert instantaneous(choice.form).suffices
    assert sp.expand(instantaneous(choice.form).determinant - choice.determinant**2) == 0


def test_corollaries_say_where_they_stand():
    assert str(COROLLARIES[2]) == "corollary 3, section V.A: dynamic camera, object in general motion"
    turned = COROLLARIES[3].choice("231")
    assert turned.unknown == ("d_s", "v_c1", "v_p2")
    assert corollary_of(turned).number == 4
    assert corollary_of(StructureAndMotion(("d_s",), STILL)) is None
    with pytest.raises(ValueError, match="must be 1, 2 and 3 in some order"):
        COROLLARIES[0].choice("xyz")


def test_three_hundred_choices_that_the_paper_does_not_state():
    assert len(all_possible()) > 800
    assert sum(corollary_of(choice) is None for choice in all_possible() if len(choice.unknown) == 3) > 150


@pytest.mark.slow
def test_a_choice_is_refused_exactly_where_the_unknowns_cannot_be_told_apart():
    """The rank of the rate's derivative with respect to the unknown quantities, at a point drawn at random."""
    draw = np.random.default_rng(1)
    jacobian = scaled_dynamics().rate.jacobian(ALL)
    at = {s: sp.Float(draw.uniform(0.3, 1.5)) for s in (*ALL, *W, y1, y2, ybar3)}
    for unknown, zero in every_choice():
        if not unknown:
            continue
        numbers_ = at | {s: sp.Float(0) for s in ALL if s.name in zero}
        columns = [k for k, name in enumerate(QUANTITIES) if name in unknown]
        rank = np.linalg.matrix_rank(np.array(jacobian.xreplace(numbers_), dtype=float)[:, columns], tol=1e-9)
        assert (rank == len(unknown)) == (possible(unknown, zero) is not None)


test_impossible_choices_are_refused_with_the_reason = refuses(
    lambda unknown, settings: StructureAndMotion(unknown, **settings),
    ((), {}, "nothing is unknown; name one to three of d_s, v_c1"),
    (("d_s", "v_c1", "v_c2", "v_p3"), {}, "4 unknowns .* 3 components.* know at least 1 of them"),
    (QUANTITIES, {}, "7 unknowns"),
    (("v_c2", "v_p2"), {}, "v_c2 and v_p2 act through their difference only"),
    (("d_s", "v_c1", "v_p1"), {}, "v_c1 and v_p1 act through their difference only"),
    (("d_s",), {"zero": VELOCITIES}, "the scale d_s multiplies every velocity, and none is known"),
    (("d_s", "v_c2", "v_c3"), {"zero": ("v_c1", *STILL)}, "know such a velocity, or d_s"),
    (("d_s", "v_c1", "v_p2"), {"zero": ("v_c3", "v_p3")}, "none is known that is not zero along an axis"),
    (("d_s", "v_p4"), {}, "there is no quantity v_p4; there are d_s, v_c1"),
    (("d_s",), {"zero": ("w_c1",)}, "there is no quantity w_c1"),
    (("d_s", "d_s"), {}, "unknown names a quantity twice"),
    (("v_c1",), {"zero": ("v_c1",)}, "v_c1 cannot be unknown and known at once"),
    (("d_s", "v_c1"), {"earlier": ("d_s",)}, "d_s cannot be unknown and known at once"),
    (("v_c1",), {"zero": ("d_s",)}, "d_s is one over a distance, so it is not zero"),
    (("d_s",), {"scale": 2.0}, "d_s cannot be unknown and known to be 2"),
    (("v_c1",), {"scale": -2.0}, "d_s is -2.0; it is one over a distance"),
    error=ImpossibleChoice,
)


def values_of(choice, draws):
    """Numbers for every symbol, zero where the choice says so."""
    at = dict(zip((*ALL, *W, y1, y2, ybar3), draws, strict=True))
    at |= {s: 0.0 for s in ALL if s.name in choice.zero} | {d_s: abs(at[d_s]), ybar3: abs(at[ybar3])}
    return at


draws = st.lists(numbers, min_size=13, max_size=13)


@pytest.mark.slow
@given(choices, draws)
def test_every_form_is_the_rate_of_the_dynamics(choice, drawn):
    at = values_of(choice, drawn)
    theta = [expression.subs(at) for expression in choice.theta]
    form = choice.form
    rate = form.rate.subs({**at, **dict(zip(form.x2, theta, strict=True))})
    expected = [*scaled_dynamics().rate.subs(at), *[0] * len(theta)]
    np.testing.assert_allclose(np.array(rate, dtype=float).ravel(), np.array(expected, dtype=float), atol=1e-9)


@pytest.mark.slow
@given(choices, draws)
def test_the_determinant_vanishes_exactly_where_the_condition_fails(choice, drawn):
    at = values_of(choice, drawn)
    assert bool(choice.condition.subs(at)) == (abs(choice.determinant.subs(at)) > 1e-14)
    standing = at | dict.fromkeys(set().union(*(v.free_symbols for v in choice.known_velocity), set()), 0.0)
    assert (choice.determinant.subs(standing) == 0) == (not choice.condition.subs(standing))
    assert choice.determinant.subs({**at, ybar3: 0}) == 0


@pytest.mark.slow
@given(choices, draws)
def test_quantities_and_theta_are_each_others_inverse(choice, drawn):
    at = values_of(choice, drawn)
    motion = rigid(
        camera_angular_velocity=[at[s] for s in W],
        camera_velocity=[at[s] for s in ALL[1:4]],
        point_velocity=[at[s] for s in ALL[4:]],
    )
    theta = choice.theta_values(at[d_s], motion, [0.0, 1.0])
    assert theta.shape == (2, len(choice.unknown))
    for name, found in choice.quantities(theta).items():
        np.testing.assert_allclose(found, at[sp.Symbol(name, real=True)])


def test_quantities_of_a_scale_that_was_estimated_earlier():
    second = COROLLARIES[1].choice(scale=4.0)
    assert second.theta == (d_s * v_p1, d_s * v_p2, d_s * v_p3)
    assert second.quantities([1.0, -2.0, 0.0]) == {"v_p1": 0.25, "v_p2": -0.5, "v_p3": 0.0}
    with pytest.raises(ValueError, match="estimate of d_s from the earlier stage is missing"):
        COROLLARIES[1].choice().quantities([1.0, -2.0, 0.0])


def test_no_velocity_follows_from_a_scale_that_is_not_positive():
    found = COROLLARIES[0].choice().quantities([[0.0, 1.0, 2.0], [-1.0, 1.0, 2.0], [2.0, 1.0, 2.0]])
    np.testing.assert_array_equal(found["d_s"], [np.nan, np.nan, 2])
    np.testing.assert_array_equal(found["v_c2"], [np.nan, np.nan, 0.5])
    with pytest.raises(ValueError, match=r"theta = .* have the shape \(2,\); expected"):
        COROLLARIES[0].choice().quantities([1.0, 2.0])


def test_a_choice_is_a_view_of_points():
    draw = np.random.default_rng(2)
    points = draw.uniform(0.5, 2.0, (5, 3))
    ybar = pinhole().project(points) / [1, 1, 4.0]
    first, fifth = COROLLARIES[0].choice(), COROLLARIES[4].choice(scale=4.0)
    theta = np.column_stack([np.full(5, 4.0), draw.normal(size=(5, 2))])
    np.testing.assert_allclose(first.locate(np.hstack([ybar, theta])), points)
    np.testing.assert_allclose(fifth.locate(np.hstack([ybar, theta])), points)
    linear = LinearView(first)
    np.testing.assert_allclose(linear.scaled(ybar), 4.0 * points)
    np.testing.assert_allclose(linear.locate(np.hstack([linear.scaled(ybar), theta])), points)
    assert np.isinf(first.locate(np.hstack([ybar, -theta]))).all()
    assert first.coordinates == (*first.image_coordinates, *sp.symbols("theta1:4", real=True))
    assert first.form.view is first
    assert linear.form.view is linear


def test_which_choices_fit_each_other():
    known = COROLLARIES[4].choice()
    assert known.fits(COROLLARIES[4].choice(scale=3.0))
    assert not COROLLARIES[4].choice(scale=3.0).fits(COROLLARIES[4].choice(scale=4.0))
    assert not known.fits(COROLLARIES[5].choice())
    assert not known.fits(pinhole())
    assert LinearView(known).fits(LinearView(COROLLARIES[4].choice(scale=3.0)))
    assert not LinearView(known).fits(known)
    assert COROLLARIES[4].choice(scale=3.0).values == {d_s: 3.0}


@pytest.mark.slow
@given(choices, draws)
def test_the_linear_view_is_linear_and_moves_as_the_points_do(choice, drawn):
    at = values_of(choice, drawn)
    form = LinearView(choice).form
    assert not form.w.free_symbols & set(form.x1)
    assert not form.phi.jacobian(form.x1).free_symbols & {*form.x1, *form.x2}
    motion = rigid()
    X = np.array([at[y1], at[y2], 1.0]) / (at[d_s] * at[ybar3])
    velocity = np.array((motion.A * sp.Matrix(X) + motion.b).subs(at), dtype=float).ravel()
    there = dict(zip(form.x1, at[d_s] * X, strict=True))
    there |= dict(zip(form.x2, (e.subs(at) for e in choice.theta), strict=True))
    found = np.array(form.rate.subs(there).subs(at), dtype=float).ravel()
    np.testing.assert_allclose(found[:3], at[d_s] * velocity, rtol=1e-9, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("corollary", COROLLARIES, ids=lambda c: str(c.number))
def test_sensitivity_against_a_finite_difference(corollary):
    """theta recovered from a scaled inverse depth and a rate that are a little wrong."""
    choice = corollary.choice()
    form = choice.form
    rate = sp.symbols("r1:4", real=True)
    recovered = (form.w.T).LUsolve(sp.Matrix(rate) - form.phi)
    draw = np.random.default_rng(3)
    symbols = (*form.x1, *form.parameters, *rate)
    at = dict(zip(symbols, draw.uniform(0.3, 1.0, len(symbols)), strict=True))
    at |= dict(zip(form.x2, (e.subs(at) for e in recovered), strict=True))
    expected = [[float(e.diff(s).subs(at)) for s in (ybar3, rate[2])] for e in recovered]
    np.testing.assert_allclose(np.array(choice.sensitivity().subs(at), dtype=float), expected, rtol=1e-9)


def test_the_scaled_system_is_the_perspective_one_for_a_scale_of_one():
    system = PerspectiveSystem(rigid(), pinhole())
    renamed = scaled_dynamics().rate.subs({d_s: 1, ybar3: system.coordinates[2]})
    evaluate = vectorised((*system.coordinates, *system.parameters), list(system.rate - renamed))
    np.testing.assert_allclose(evaluate(*np.random.default_rng(4).normal(size=(12, 20))), 0, atol=1e-12)
