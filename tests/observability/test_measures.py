"""Each measure of observability says what it must where the answer is known, and the table says why they disagree."""

import random
from functools import cache

import numpy as np
import pytest
import sympy as sp
from examples import AFFINE, BOTH, ON_SPHERE, ONE, SQUARE
from refusals import refuses
from scipy.linalg import expm

from percept_obs import (
    Camera,
    Gaussian,
    PerspectiveSystem,
    Scenario,
    affine,
    chained,
    cramer_rao,
    figures,
    how_observable,
    lie_derivatives,
    pinhole,
    record,
    scenarios,
)
from percept_obs.observability import empirical_gramian, error_gramian
from percept_obs.system.forms import partition
from percept_obs.system.motion import TIME

CHAINED = chained()
CAMERA = Camera(0.05, Gaussian(0.01))
EQ35 = scenarios.ma2005_eq35().motion
A35 = np.array(EQ35.A.subs(EQ35.values), dtype=float)
B35 = np.array(EQ35.b.subs(EQ35.values), dtype=float)[:, 0]


@cache
def crossing():
    """A point on (35) that is at the focus of expansion after 1 s, 3 m deep."""
    whole = np.zeros((4, 4))
    whole[:3, :3], whole[:3, 3] = A35, B35
    start = expm(-whole) @ np.append(3 * B35 / B35[2], 1)
    return record(Scenario("crossing", EQ35, start[:3], 8, pinhole()), camera=CAMERA)


@cache
def staying():
    """A point that stays at the focus of expansion: A = 0, and the point along b."""
    return record(Scenario("staying", affine(np.zeros((3, 3)), B35), 4 * B35, 8, pinhole()), camera=CAMERA)


@cache
def counter_example():
    A = np.zeros((3, 3))
    A[0, 1] = 1
    return record(Scenario("counter-example", affine(A, [1, 0, 0]), (0, 1, 2), 8, pinhole()), camera=CAMERA)


def said(found):
    return {measure.name: measure.holds for measure in found.measures}


def test_the_counter_example_to_20():
    """(20) as printed says yes, and all others say no, with the direction (0, 1, -1)."""
    found = how_observable(counter_example(), ONE)
    assert said(found).pop("(20) as printed")
    assert not any(measure.holds for measure in found.measures if measure.name != "(20) as printed")
    assert {measure.lost for measure in found.measures if not measure.holds} == {("y2 - y3",)}
    assert found["bound"].value == pytest.approx(1, abs=1e-6)
    assert "the smaller eigenvalue" in found.disagreements[0]


def test_eq36_is_not_excited_and_is_observable_nevertheless():
    found = how_observable(record(scenarios.ma2005_eq36(), 80, Camera(0.1)), ONE)
    assert said(found) == {
        "(20) as printed": True,
        "instant": False,
        "excitation": False,
        "Lie rank": True,
        "error Gramian": True,
        "empirical Gramian": True,
        "bound": True,
    }
    assert found.excitation.least < 1e-9
    assert found.error.least > 0.018
    assert found.error.smallest[-1] > 0.058
    assert any("is seen through g" in reason for reason in found.disagreements)


def test_crossing_the_focus_of_expansion():
    """Zero at the instant; windows dip and stay positive, later than it; the bound stops shrinking for a while only."""
    recording, window = crossing(), 0.5
    found = how_observable(recording, BOTH, window)
    assert said(found) == said(found) | {"instant": False, "excitation": True, "Lie rank": True, "bound": True}
    assert found["instant"].time == 1
    assert found["instant"].value < 1e-12
    assert found["instant"].lost == ("y3",)
    least = found.excitation.time[np.argmin(found.excitation.smallest)]
    assert 1 < least < 1 + window
    assert found.excitation.least > 1e-4
    until = {end: cramer_rao(recording.between(0, end + 1e-9), BOTH) for end in (0.1, 1, 2, 8)}
    kept = {end: bound.kept()[0][-1] for end, bound in until.items()}
    assert kept[1] < kept[0.1] / 3
    assert 0.9 * kept[1] < kept[2] < kept[1]
    assert kept[8] < kept[2] / 3


def test_staying_at_the_focus_of_expansion():
    """Nothing tells the distance: the bound is the prediction without measurements."""
    found = how_observable(staying(), BOTH)
    assert not any(said(found).values())
    assert {measure.lost for measure in found.measures} == {("y3",)}
    np.testing.assert_allclose(found.bound.of("y3"), found.bound.predicted_deviation[:, 2], rtol=1e-9)
    assert found.bound.of("y1")[-1] < 0.2 * found.bound.predicted_deviation[-1, 0]
    assert found.disagreements == ("All measures agree: it is not observable.",)


def test_at_the_focus_of_expansion_one_more_derivative_is_needed():
    """On (35) with both outputs: rank 2 with first derivatives there, 3 with second; with A = 0 it stays 2."""
    focus = {s: v for s, v in zip(AFFINE.coordinates, (*(B35[:2] / B35[2]), 0.4), strict=True)}
    derivatives = lie_derivatives(BOTH, 3)
    assert derivatives.ranks_at(focus | EQ35.values) == (2, 2, 3, 3)
    assert derivatives.ranks_at(focus | EQ35.values | {AFFINE.coordinates[0]: 0.5}) == (2, 3, 3, 3)
    still = EQ35.values | dict.fromkeys(affine().A, 0.0)
    assert derivatives.ranks_at(focus | still) == (2, 2, 2, 2)


def drawn(seed):
    """A random polynomial system of three or four states, of which the first is measured, and a place in it."""
    draw = random.Random(seed)
    n = draw.choice((3, 4))
    x = sp.symbols(f"x1:{n + 1}", real=True)
    rates = []
    for _ in x:
        terms = [
            draw.choice((-2, -1, 1, 2)) * draw.choice(x) * draw.choice((1, *x)) for _ in range(draw.choice((1, 2)))
        ]
        rates.append(sum(terms, sp.S.Zero))
    place = {s: sp.Rational(draw.randint(1, 9), draw.randint(1, 5)) for s in x}
    return partition(x, sp.ImmutableMatrix(rates), [x[0].name], ()), place


def rank_by_power_series(form, place, orders):
    """Rank of the coefficients of d y(t) / d x(0) up to an order, in exact fractions and without Lie derivatives.

    State and transition matrix are expanded in powers of the time, term by term (Sedoglavic, J. Symbolic Computation
    33 (2002)).
    """
    t, x, f = sp.Symbol("t"), form.coordinates, form.rate
    state, Phi = sp.Matrix([place[s] for s in x]), sp.eye(len(x))
    for k in range(orders):
        at = dict(zip(x, state, strict=True))
        moved = f.subs(at, simultaneous=True), f.jacobian(x).subs(at, simultaneous=True) * Phi
        state, Phi = (
            old + rate.applyfunc(lambda e: e.expand().coeff(t, k) * t ** (k + 1) / (k + 1))  # noqa: B023
            for old, rate in zip((state, Phi), moved, strict=True)
        )
    return sp.Matrix(orders + 1, len(x), lambda k, j: Phi[0, j].expand().coeff(t, k)).rank()


@pytest.mark.slow
def test_ranks_agree_with_exact_power_series_on_ten_random_systems():
    found = []
    for seed in range(10):
        form, place = drawn(seed)
        n = len(form.coordinates)
        found.append((lie_derivatives(form).ranks_at(place)[-1], rank_by_power_series(form, place, n - 1), n))
    assert [rank for rank, _, _ in found] == [rank for _, rank, _ in found]
    assert {rank == n for rank, _, n in found} == {True, False}, "some are observable, some are not"


def test_what_is_lost_changes_no_output():
    """The kernel of the counter-example in symbols: moving the state along it leaves y1 and its derivatives."""
    form = partition(*_numbers(counter_example().motion), ["y1"], ())
    found = lie_derivatives(form)
    assert found.rank == 2
    direction = found.unobservable[:, 0] / found.unobservable[1, 0]
    np.testing.assert_allclose(direction, [0, 1, -1], atol=1e-12)
    assert (found.matrix * sp.Matrix([0, 1, -1])).expand() == sp.zeros(3, 1)
    assert r"\text{rank } 2 \text{ of } 3" in found._repr_latex_()


def _numbers(motion):
    rational = {symbol: sp.Rational(repr(value)) for symbol, value in motion.values.items()}
    return AFFINE.coordinates, AFFINE.rate.subs(rational)


def test_a_motion_that_varies_has_derivatives_too():
    """A translation that turns shows y1 alone what a constant one hides: with b(t) known, b'(t) counts."""
    turning = affine(np.zeros((3, 3)), [sp.cos(TIME), sp.sin(TIME), 0])
    system = type(AFFINE)(turning, pinhole())
    recording = record(Scenario("turning", turning, (0, 0, 2), 3, pinhole()), camera=CAMERA)
    assert how_observable(recording, system).lie.holds
    frozen = lie_derivatives(system.measure("y1", "y2"), 2, varying=True)
    assert [len(each) for each in frozen.derivatives] == [1]
    still = system.rate.diff(TIME)
    assert not still.is_zero_matrix


@pytest.mark.parametrize("form", [ONE, BOTH], ids=["y1", "y1+y2"])
def test_perturbed_runs_give_the_gramian_of_the_linearised_system(form):
    recording = record(scenarios.ma2005_eq35(), 6, CAMERA, seed=2)
    linear, runs = error_gramian(recording, form, 2), empirical_gramian(recording, form, 2)
    same = np.searchsorted(linear.time, runs.time - 1e-9)
    np.testing.assert_allclose(linear.matrices[same], runs.matrices, atol=1e-4 * runs.matrices.max())


@pytest.mark.slow
def test_without_a_canonical_form_the_other_measures_speak():
    surface = ON_SPHERE.surface
    recording = record(scenarios.ma2005_eq35(surface), 4, CAMERA)
    found = how_observable(recording, ON_SPHERE.partition("y1"))
    assert list(said(found)) == ["Lie rank", "error Gramian", "empirical Gramian", "bound"]
    assert found.excitation is None


def test_the_table_is_shown_as_text_and_in_a_notebook():
    found = how_observable(counter_example(), ONE)
    assert "excitation" in str(found)
    assert "<Observability of y1\n" in repr(found)
    markdown = found._repr_markdown_()
    assert "| (20) as printed | does an instant show anything hidden? | yes |" in markdown
    assert markdown.count("\n| ") == 8
    found = how_observable(record(scenarios.ma2005_eq35(), 3, CAMERA), ONE)
    largest, printed = found.instant.eigenvalues[:, -1], found["(20) as printed"]
    assert (printed.value, printed.time) == (largest.min(), found.recording.elapsed[largest.argmin()])
    assert largest.max() > 1.1 * largest.min()


def test_lost_samples_show_nothing():
    blind = crossing().without(0.01, 6)
    assert not error_gramian(blind, BOTH, 0.5).holds
    assert error_gramian(crossing(), BOTH, 0.5).holds


@pytest.mark.parametrize("measure", [error_gramian, empirical_gramian])
@pytest.mark.parametrize("window", [0, 9, 0.01])
def test_windows_that_do_not_fit_are_refused(measure, window):
    with pytest.raises(ValueError, match="the window is"):
        measure(crossing(), BOTH, window)


test_other_requests_that_make_no_sense_are_refused = refuses(
    lambda call: call(),
    (lambda: lie_derivatives(BOTH, -1), "order 0"),
    (lambda: lie_derivatives(BOTH, 10**12), "fewer orders"),
    (lambda: lie_derivatives(BOTH).ranks_at({}), "no values for"),
    (lambda: how_observable(crossing(), SQUARE), "made for no view"),
    (lambda: figures.observability(3), "expected an Observability"),
)


def test_the_figure_draws_every_measure():
    found = how_observable(crossing(), BOTH)
    figure = figures.observability(found)
    assert len(figure.axes) == 4
    drawn = {line.get_label(): line.get_ydata() for ax in figure.axes for line in ax.lines}
    np.testing.assert_array_equal(drawn["error Gramian (beginning)"], found.error.smallest)
    np.testing.assert_array_equal(drawn["bound of $y_{3}$"], found.bound.of("y3"))
    for measure in found.measures:
        assert f"{measure.name}: {'yes' if measure.holds else 'no'}, {measure.said}" in figure.text
    alone = how_observable(record(scenarios.ma2005_eq35(CHAINED), 4, CAMERA), PerspectiveSystem(affine(), CHAINED))
    assert "All measures agree" in figures.observability(alone).text
