"""The Luenberger-type observer's error obeys linear equations, and P meets the inequalities that it claims."""

import numpy as np
import pytest
import sympy as sp
from refusals import refuses
from sample_sizes import slow_but
from test_points_form import generic

from percept_obs import PointsForm, linear, luenberger, record, track
from percept_obs.points import constant, lyapunov, riccati, scheduled
from percept_obs.points.scenarios import moving_body


@pytest.mark.slow
def test_the_gain_has_no_division():
    observer = luenberger(generic(2, 3))
    form = observer.form
    assert all(entry.is_polynomial(*observer.estimate, *form.y) for entry in observer.gain)
    assert all(entry.is_polynomial(*observer.estimate, *form.y) for entry in observer.flow)
    images = form.E(observer.estimate).inv() * (sp.Matrix(form.y) - form.H(observer.estimate))
    assert all(sp.cancel(entry) == 0 for entry in images - observer.scaled_innovation)
    with_gain = observer.gain * (sp.Matrix(form.y) - form.H(observer.estimate))
    rest = observer.flow - form.motion.A * sp.Matrix(observer.estimate) - form.motion.b - with_gain
    assert all(sp.cancel(entry) == 0 for entry in rest)


def weights():
    return {
        "constant": (constant(2.0), True, True),
        "scheduled, shrinking": (scheduled(lambda t: 2 + np.exp(-t)), True, True),
        "scheduled, growing": (scheduled([1.0, 3.0], times=[0, 60]), False, False),
        "Lyapunov": (lyapunov(2.0), True, True),
        "Lyapunov with a decrease": (lyapunov(2.0, 0.01), True, True),
        "Riccati": (riccati(0.1, 0.3), False, True),
        "Riccati that forgets nothing": (riccati(0.1, 0), False, True),
    }


@pytest.mark.parametrize("name", slow_but("scheduled, growing", "Lyapunov", "Riccati", among=weights()))
def test_the_inequalities_are_told_apart(name):
    weight, printed, weaker = weights()[name]
    recording = record(moving_body(), 6)
    found = track(recording, luenberger(recording.view, weight)).conditions()
    assert (found.printed_holds, found.weaker_holds, (found.least > 0).all()) == (printed, weaker, True)
    assert ("(15) holds throughout" in found.verdict()) == printed


@pytest.mark.slow
def test_the_error_in_the_metric_of_p_never_grows():
    """V = rho^T P rho decreases wherever one of the inequalities holds."""
    recording = record(moving_body(), 10)
    for weight in (3.0, riccati(0.1, 0.3), lyapunov(2.0, 0.01)):
        run = track(recording, luenberger(recording.view, weight), hold="exact")
        rho = run.error[run.kept]
        V = np.einsum("ti,tij,tj->t", rho, run.P, rho)
        assert (np.diff(V) <= 1e-9 * V[0]).all()
        assert V[-1] < 0.2 * V[0]


test_wrong_ps_are_refused = refuses(
    lambda P: luenberger(PointsForm(linear(np.eye(3), np.ones(3)), np.eye(3)), P),
    (0.0, "must be positive definite"),
    (-1.0, "must be positive definite"),
    (np.nan, "not finite"),
    (np.eye(2), r"scheduled with 4 entries; expected 1 or 3 x 3"),
    (np.arange(9.0).reshape(3, 3), "finite symmetric"),
    (riccati(np.eye(2)), r"shape \(2, 2\); expected a number or \(3, 3\)"),
    (riccati(-1.0), "must be positive definite"),
    (lyapunov(1.0, -1.0), "positive semidefinite"),
    (scheduled([1.0, -1.0], times=[0, 1]), "sample 1, has the eigenvalue -1"),
)


def test_wrong_forgetting_and_samples_without_times_are_refused():
    for forgetting in (-0.1, np.inf):
        with pytest.raises(ValueError, match="finite and not negative"):
            riccati(1.0, forgetting)
    with pytest.raises(ValueError, match="need their times"):
        scheduled([1.0, 2.0])


def test_it_shows_itself():
    observer = luenberger(moving_body().form, riccati())
    assert "P^{-1}" in observer._repr_latex_()
    assert observer.name == "Luenberger, Riccati"
    assert observer.about.claim.startswith("global")


def test_a_sampled_p_changes_as_its_samples_do_up_to_the_last_one():
    sampled = scheduled([[1.0], [2.0], [2.5]], [0.0, 1.0, 2.0]).sized(2)
    rates = sampled.rate([0.0, 0.5, 1.5, 2.0])
    np.testing.assert_allclose(rates, np.array([1, 1, 0.5, 0.5])[:, None, None] * np.eye(2), atol=1e-9)
    np.testing.assert_allclose(sampled.at([0.5, 2.0]), np.array([1.5, 2.5])[:, None, None] * np.eye(2))
    assert constant(2.0).sized(2).rate([0.0, 1.0]).tolist() == np.zeros((2, 2, 2)).tolist()
