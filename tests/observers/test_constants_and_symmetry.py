"""One output is slow for Ma's observer and not for the data; the equivariant filter keeps its range positive."""

import numpy as np
import pytest
import sympy as sp
from basin_study import study as basin
from examples import BOTH, FORMS, ON_SPHERE, ONE
from one_output_study import study as one_output

from percept_obs import Camera, PerspectiveSystem, Uniform, ekf, pinhole, record, rigid, scenarios, sized, sphere, track
from percept_obs.checking.deciding import same
from percept_obs.observers import NeedsMotion, equivariant_filter, gpebo
from percept_obs.observers.gpebo import forgetting, gamma, mu
from percept_obs.observers.parts import sigma2


@pytest.mark.slow
def test_with_one_output_the_observer_of_constants_is_as_fast_as_the_filter_and_mas_is_not():
    rows = [row for row, _ in one_output(2, 6, (ONE,), {"uniform 0.01": Uniform(0.01)})]
    median = {(row[2], row[3]): row[4] for row in rows}
    for start in (0.0, 1.0):
        assert median["identifier_based", start] > 2.5 * median["gpebo", start]
        assert median["gpebo", start] < 1.5 * median["extended_kalman", start]


@pytest.mark.slow
def test_from_wrong_ranges_the_equivariant_filter_settles_and_claims_too_much_where_it_began_too_near():
    rows = {(factor, key): (share, nees) for factor, key, share, _, nees, _ in basin(5, (0.1, 10.0))}
    assert all(share == 1 for share, _ in rows.values())
    assert rows[0.1, "equivariant_filter"][1] > 3 * rows[0.1, "extended_kalman"][1]
    assert rows[10.0, "equivariant_filter"][1] < 2


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_a_start_at_infinity_needs_no_guard_and_no_other_time(form):
    recording = record(scenarios.ma2005_eq35(), 5, Camera(0.01))
    near, far = (track(recording, gpebo(form), {"y3": y3}).settling_time(0.1) for y3 in (1.0, 0.0))
    assert far == pytest.approx(near, abs=0.2)
    assert far < 5


CONSTANTS = gpebo(BOTH)
STATE, RATES = (sp.Matrix(part) for part in (CONSTANTS.equations.state, CONSTANTS.equations.flow))
THETA = sp.Matrix(sp.symbols("theta1:4", real=True))
A, B = BOTH.motion.A, BOTH.motion.b


def vanish(*expressions):
    return all(same(e, sp.S.Zero) for e in expressions)


def test_the_state_is_known_but_for_constants_in_which_the_outputs_are_linear():
    """Ortega et al. 2020: X = (Phi (q1, q2, 1) + rho xi) / rho moves as the point does, and Q theta = Y stays true."""
    point = (sp.Matrix(3, 3, STATE[:9]) * sp.Matrix([*THETA[:2], 1]) + THETA[2] * STATE[9:12, :]) / THETA[2]
    assert vanish(*(point.jacobian(STATE[:12]) * RATES[:12, :] - A * point - B))
    left = symmetric_of(RATES[12:18]) * THETA - RATES[18:21, :] + forgetting * (square() * THETA - STATE[18:21, :])
    seen = dict(zip(BOTH.x1, (point[0] / point[2], point[1] / point[2]), strict=True))
    assert vanish(*left.subs(seen | {sigma2: 0}))


def test_each_constant_has_an_error_of_its_own():
    """DREM: with Y = Q theta its rate is -gamma D^2 / (mu + D^2) times it, whatever the others are."""
    D, put = square().det(), dict(zip(STATE[18:21], square() * THETA, strict=True))
    share = gamma * D**2 / (mu + D**2)
    assert vanish(*(RATES[21:, :].xreplace(put) - share * (THETA - STATE[21:, :])))


def symmetric_of(entries):
    a, b, c, d, e, f = entries
    return sp.Matrix([[a, b, c], [b, d, e], [c, e, f]])


def square():
    return symmetric_of(STATE[12:18])


def test_the_equivariant_error_moves_linearly_and_is_seen_to_the_third_order():
    """van Goor et al. 2020: p = G (e3 + d) has d' = F d, F that of the Riccati equation; a turn by s misses s^3/12."""
    equations, size, s = equivariant_filter(BOTH).equations, sp.Symbol("a", positive=True), sp.Symbol("s")
    here = dict(zip(equations.state[:9], size * sp.eye(3), strict=True)) | {sp.Symbol("Q", real=True): 0}
    rate = sp.Matrix(equations.flow).xreplace(here)
    e3, d, S = sp.Matrix([0, 0, 1]), sp.Matrix(sp.symbols("d1:4")), symmetric_of(equations.state[9:])
    G, moved = size * sp.eye(3), sp.Matrix(3, 3, rate[:9])
    assert vanish(*(moved * e3 - A * G * e3 - B))
    error = G.inv() * (A * G * (e3 + d) + B - moved * (e3 + d))
    F = error.jacobian(d)
    assert vanish(*(error - F * d), *(F * S + S * F.T - symmetric_of(rate[9:])))
    eta = sp.Matrix([sp.sin(s), 0, sp.cos(s)])
    miss = eta - e3 - e3.cross(sp.Matrix([s, 0, 0])).cross(e3 + eta) / 2
    assert [miss[0].diff(s, k).subs(s, 0) for k in range(4)] == [0, 0, 0, sp.Rational(1, 2)]


@pytest.mark.slow
def test_a_range_stays_positive_whatever_is_seen():
    filtered = track(
        record(scenarios.ma2005_eq35(), 2, Camera(0.05, Uniform(0.3))), equivariant_filter(BOTH), {"y3": 5}
    )
    assert filtered.estimate[:, 2].min() > 0
    assert np.isfinite(filtered.estimate).all()
    assert filtered.nis.shape == filtered.nees("y3").shape


def test_without_motion_or_with_what_gives_no_equation_they_say_so():
    with_size = PerspectiveSystem(rigid(), sized(pinhole())).measure("y1", "y2", "s")
    for make in (gpebo, equivariant_filter):
        assert isinstance(make.objection(with_size), NeedsMotion)
        assert "hidden" in make.refusal(ONE) or make is gpebo
    on_sphere = PerspectiveSystem(rigid(), sphere(3)).partition("y1", "y2", "y3")
    assert "has 3 outputs" in gpebo.refusal(on_sphere)
    assert "too long to compile" in equivariant_filter.refusal(on_sphere)
    assert not gpebo.refusal(ON_SPHERE.measure("y1", "y2"))
    assert ekf(BOTH).form.motion.A == BOTH.motion.A
