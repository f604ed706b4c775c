"""A run of many points obeys the error dynamics, bears with points that come and go, and says what went wrong."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from refusals import refuses
from sample_sizes import slow_but
from scipy.integrate import solve_ivp

from percept_obs import (
    Camera,
    FirstSight,
    Gaussian,
    PointsForm,
    PointsScenario,
    Recording,
    linear,
    luenberger,
    plane,
    record,
    rigid,
    track,
)
from percept_obs.points import constant, independent_points, lyapunov, riccati, rigid_body, scheduled
from percept_obs.points.scenarios import LeavesEveryBound, moving_body
from percept_obs.studies.comparison import relative_distance_errors
from percept_obs.tracking.following import DoesNotFit

ERROR = np.array([0.3, -0.2, 0.5, 0.2, -0.1, 0.3])


@lru_cache
def body(points=1, duration=4.0, period=0.01):
    return record(moving_body(points), duration, Camera(period))


def turning(points=2, duration=4.0, **settings):
    """Points of their own before a camera that turns and moves."""
    form = independent_points(
        rigid(camera_angular_velocity=[-0.05, 0.1, -0.2], camera_velocity=[0.6, -0.3, 0.05]), points
    )
    places = [[0.4 * k - 0.3, 0.2 * k, 3.0 + k] for k in range(points)]
    return record(PointsScenario("turning", form, np.ravel(places), duration), **settings)


@pytest.mark.parametrize("points", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_the_error_obeys_its_equation_to_the_fourth_order(points):
    """rho' = (A - P^-1 C^T B^T B C) rho, solved beside by another method; half the step, a sixteenth of the miss."""
    scenario, rho = moving_body(points), ERROR[: 3 * points]
    form, n = scenario.form, 3 * points
    P = 2 * np.eye(n) + 0.2

    def both(t, state):
        (A,), (v,) = form.coefficients(t)
        x, rho = state[:n], state[n:]
        return np.concatenate([A @ x + v, (A - np.linalg.solve(P, form.information(form.outputs(x)))) @ rho])

    expected = solve_ivp(both, (0, 4), [*scenario.state, *rho], "DOP853", [4.0], rtol=1e-11, atol=1e-12).y[n:, -1]
    whole = body(points, 4.0, 0.1)
    miss = {}
    for step in (0.1, 0.05):
        run = track(whole, luenberger(form, P), scenario.state - rho, hold="exact", step=step)
        miss[step] = np.abs(run.error[-1] - expected).max()
    assert miss[0.1] < 1e-3
    assert 12 < miss[0.1] / miss[0.05] < 20


WEIGHTS = {
    "constant": constant(2.0),
    "constant and full": constant(2 * np.eye(6) + 0.3),
    "scheduled": scheduled(lambda t: 2 + np.exp(-t)),
    "Lyapunov": lyapunov(2.0, 0.01),
    "Riccati": riccati(0.1, 0.3),
}


@pytest.mark.parametrize("name", slow_but("scheduled", "Riccati", among=WEIGHTS))
def test_a_start_at_the_truth_stays_there(name):
    whole = body(2)
    run = track(whole, luenberger(whole.view, WEIGHTS[name]), whole.truth[0], hold="exact")
    assert run.deviation.max() < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("name", WEIGHTS)
@pytest.mark.parametrize("hold", ["zero", "first", "exact"])
def test_python_and_numba_agree(name, hold):
    whole = body(2, 4.0, 0.1).without(1.0, 2.0, 1)
    runs = [
        track(whole, luenberger(whole.view, WEIGHTS[name]), FirstSight(1.0, 0.5), hold=hold, language=language)
        for language in ("python", "numba")
    ]
    np.testing.assert_allclose(runs[0].state, runs[1].state, atol=1e-9)
    np.testing.assert_allclose(runs[0].P, runs[1].P, atol=1e-9)


@pytest.mark.slow
def test_independent_points_are_followed_as_if_alone():
    """One state of three points, and each of them by itself: the same estimates, whether P is diagonal or computed."""
    whole = turning(3).without(1, 2, 1)
    alone = turning(1).view
    for weight in (constant(0.5), riccati(0.01, 0.3)):
        run = track(whole, luenberger(whole.view, weight), FirstSight(2.0))
        for k in range(3):
            single = Recording(whole.time, whole.outputs[:, k : k + 1], ("y1", "y2"), alone, alone.motion)
            mine = track(single, luenberger(alone, weight), FirstSight(2.0))
            np.testing.assert_allclose(run.state[:, 3 * k : 3 * k + 3], mine.state, atol=1e-12)


def test_a_coupled_p_is_not_taken_apart():
    """With a full P the points disturb each other: another run, with the same end."""
    whole = turning(2)
    runs = [track(whole, luenberger(whole.view, P)) for P in (0.5, 0.5 * np.eye(6) + 0.05)]
    assert np.abs(runs[0].state - runs[1].state).max() > 1e-2


def test_a_hidden_point_is_carried_on_and_comes_back():
    """Out of sight a point's offset turns with the body, right or wrong; in sight again its error shrinks."""
    whole = body(2, 12.0)
    run = track(whole.without(1, 3, 1), luenberger(whole.view, 1.0), whole.truth[0] - ERROR, hold="exact")
    offset = np.linalg.norm(run.error[:, 3:], axis=1)
    away = (whole.time >= 1) & (whole.time <= 3)
    np.testing.assert_allclose(offset[away], offset[away][0], atol=1e-7)
    assert offset[~away].std() > 0.01
    assert (np.diff(run.deviation) <= 1e-9).all()
    assert run.deviation[-1] < 0.5 * run.deviation[away][-1]


def test_without_any_image_the_error_moves_with_the_state():
    whole = body(1)
    nothing = whole.without(0, 9)
    run = track(nothing, luenberger(whole.view, riccati()), whole.truth[0] - ERROR[:3])
    np.testing.assert_allclose(run.deviation, np.linalg.norm(ERROR[:3]), rtol=1e-6)


@pytest.mark.slow
def test_lost_samples_hardly_matter():
    for seed in range(3):
        whole = turning(2, 10.0, camera=Camera(0.02, Gaussian(1e-3), dropout=0.3), seed=seed)
        assert 0.5 < whole.seen.mean() < 0.9
        run = track(whole, luenberger(whole.view, riccati(0.01, 0.3)), FirstSight(1.0), hold="first")
        miss = np.linalg.norm(run.points[-1] - whole.points[-1], axis=-1)
        assert (miss < 0.05 * np.linalg.norm(whole.points[-1], axis=-1)).all()


def test_points_behind_the_camera_and_outside_of_its_view_are_not_seen():
    form = independent_points(rigid(camera_velocity=[0, 0, 1.0]), 2)
    scenario = PointsScenario("passing", form, [0.5, 0, 2, 0.5, 0, 9], 4.0)
    whole = record(scenario)
    assert whole.seen[:, 1].all()
    assert not whole.seen[whole.time > 2.001, 0].any()
    narrow = record(scenario, camera=Camera(reach=1.0))
    assert not narrow.seen[narrow.time > 1.51, 0].any()
    assert narrow.seen[narrow.time < 1.49, 0].all()
    run = track(whole, luenberger(form, 0.3), [0, 0, -1, 0, 0, -1])
    assert np.isfinite(run.state).all()
    assert run.diverged_at is None


def test_an_estimate_behind_the_camera_comes_forward():
    """No division by the estimated depth: the innovation does not mind its sign."""
    whole = turning(1, 8.0)
    run = track(whole, luenberger(whole.view, riccati(0.01, 0.0)), [0, 0, -5.0], hold="exact")
    assert np.isinf(run.distance[0, 0])
    assert run.deviation[-1] < 0.05
    assert np.isnan(run.innovation[0]).all()


def test_a_first_sight_starts_on_the_ray():
    whole = turning(2).without(0.0, 1.0, 1)
    run = track(whole, luenberger(whole.view, riccati(0.01)), FirstSight(5.0))
    first = int(np.flatnonzero(whole.seen[:, 1])[0])
    assert run.began.sum() == 2
    assert run.began[0, 0]
    assert run.began[first, 1]
    np.testing.assert_allclose(run.points[first, 1], 5.0 * np.array([*whole.outputs[first, 1], 1.0]))
    again = track(whole.without(2, 3, 1), luenberger(whole.view, riccati(0.01)), FirstSight(5.0, 0.5))
    assert again.began.sum() == 3
    assert again.distance[np.flatnonzero(again.began[:, 1])[1], 1] == pytest.approx(5.0)


def test_a_body_starts_on_its_rays_and_later_points_on_theirs():
    """All states of the points seen first are free; a later point brings its own offset and leaves the rest."""
    whole = body(2).without(0, 1, 1)
    run = track(whole, luenberger(whole.view, 1.0), FirstSight(2.0), hold="exact")
    first = int(np.flatnonzero(whole.seen[:, 1])[0])
    np.testing.assert_allclose(run.points[0, 0], 2 * np.array([*whole.outputs[0, 0], 1]))
    np.testing.assert_allclose(run.points[first, 1], 2 * np.array([*whole.outputs[first, 1], 1]))
    before = track(whole, luenberger(whole.view, 1.0), run.state[0], hold="exact")
    np.testing.assert_allclose(run.state[first, :3], before.state[first, :3], atol=1e-12)


@pytest.mark.slow
def test_a_sample_is_believed_for_so_long():
    """A camera that stops: held for ever its last image misleads, believed for a while it does not."""
    whole = turning(1, 8.0)
    keep = (whole.time <= 4.0) | (whole.time >= 7.99)
    gap = replace(whole, time=whole.time[keep], outputs=whole.outputs[keep], truth=whole.truth[keep])
    for weight in (1.0, riccati(0.01)):
        error = {
            longest: track(gap, luenberger(whole.view, weight), whole.truth[0], longest_hold=longest).deviation[-1]
            for longest in (0.1, np.inf)
        }
        assert error[0.1] < 0.2 * error[np.inf]


def test_a_wrong_belief_is_compared_point_by_point():
    """An observer with another state: no errors of the state, but the points' depths can be compared."""
    whole = body(1)
    other = luenberger(PointsForm(linear(np.zeros((6, 6)) + np.eye(6, k=3), np.zeros(6)), np.eye(6)[:3]), 1.0)
    run = track(whole, other)
    with pytest.raises(ValueError, match="believes in 6 states, the truth has 3"):
        run.error  # noqa: B018
    assert run.points.shape == (len(whole.time), 1, 3)


def test_a_run_that_diverges_says_when():
    """Steps far too long for the gain: the Runge-Kutta method is unstable."""
    whole = turning(1)
    run = track(whole, luenberger(whole.view, 1e-4))
    assert run.diverged_at is not None
    assert 0 < run.diverged_at < 1
    assert np.isnan(run.state[run.time >= run.diverged_at]).all()
    assert np.isfinite(run.state[run.time < run.diverged_at]).all()
    assert f"diverged at {run.diverged_at:.3g} s" in run.verdict()
    assert "diverged" in repr(run)
    assert (run.conditions().least > 0).all()


@pytest.mark.slow
def test_a_p_that_decreases_too_long_is_told():
    """P = (1 - 0.3 t) I ends at 3.3 s, and the run with it."""
    whole = body(1)
    for language in ("python", "numba"):
        run = track(whole, luenberger(whole.view, lyapunov(1.0, 0.3)), hold="exact", language=language)
        assert run.diverged_at == pytest.approx(10 / 3, abs=0.02)
        assert "P is no longer positive definite" in run.verdict()


def test_verdicts():
    whole = turning(1, 6.0)
    good = track(whole, luenberger(whole.view, riccati(0.003, 0.3)), hold="exact")
    assert "converged: the relative error of the points' positions stays within 10 % after" in good.verdict()
    slow = track(whole, luenberger(whole.view, 100.0), hold="exact")
    assert "not converged" in slow.verdict()
    bare = Recording(whole.time, whole.outputs, ("y1", "y2"), whole.view, whole.view.motion)
    blind = track(bare, luenberger(whole.view, 1.0))
    assert "no truth" in blind.verdict()
    for call, message in (
        (lambda: blind.error, "no truth"),
        (lambda: blind.deviation, "no truth"),
        (lambda: bare.distance, "no truth"),
        (lambda: good.decay_rate(50, 60), "needs two finite positive ones"),
        (lambda: relative_distance_errors([good], 1, "sonar", 0.3, [0]), "no distance with the name 'sonar'; it has"),
        (lambda: good.conditions(0.0), "above 0 and at most 2"),
    ):
        with pytest.raises(ValueError, match=message):
            call()


@pytest.mark.parametrize("seed", range(10))
def test_seeds_repeat(seed):
    camera = Camera(0.1, Gaussian(0.01), dropout=0.2)
    first, second = (turning(2, 1.0, camera=camera, seed=seed) for _ in range(2))
    np.testing.assert_array_equal(first.outputs, second.outputs)
    assert np.isfinite(first.outputs[first.seen]).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"start": [0.0]}, "start has 1 values; expected 6: X1_x"),
        ({"start": [np.nan] * 6}, "6 finite numbers"),
        ({"step": np.inf}, "positive and finite"),
    ],
)
def test_what_makes_no_sense_is_refused(arguments, message):
    whole = turning(2, 1.0)
    with pytest.raises(ValueError, match=message):
        track(whole, luenberger(whole.view), **arguments)


test_a_first_sight_that_makes_no_sense_is_refused = refuses(
    lambda arguments: FirstSight(*arguments),
    ((0.0,), "depth is 0.0; it must be positive"),
    ((np.inf,), "depth is inf; it must be positive and finite"),
    ((1.0, -1.0), "absence is -1.0; it must be positive"),
)


def test_what_does_not_fit_is_refused():
    whole = turning(2, 1.0)
    flat = PointsForm(whole.view.motion, whole.view.C, plane((0.1, 0, 1)))
    bare = Recording(whole.time, whole.outputs, ("y1", "y2"), whole.view, whole.view.motion)
    for form, hold, message in (
        (rigid_body(1, [0, 0, 0.1]), "zero", "made for 1 points on the pinhole, but the recording shows 2 points"),
        (flat, "zero", "on the plane"),
        (whole.view, "exact", "known in simulations only"),
    ):
        with pytest.raises(DoesNotFit, match=message):
            track(bare, luenberger(form), hold=hold)
    with pytest.raises(ValueError, match="positive definite"):
        track(whole, luenberger(whole.view, lambda t: 0.0))


OF_ONE = rigid_body(1, [0, 0, 0.1])
IMAGES = {"time": np.arange(3.0), "outputs": np.zeros((3, 1, 2)), "names": ("y1", "y2"), "view": OF_ONE}
IMAGES |= {"motion": OF_ONE.motion}

test_wrong_recordings_are_refused = refuses(
    lambda arguments: Recording(**IMAGES | arguments).without(0, 1, 1),
    ({"time": [0.0, 0.0, 1.0]}, "increase strictly"),
    ({"time": [0.0, np.nan, 1.0]}, "finite"),
    ({"outputs": np.zeros((3, 2, 2))}, r"shape \(3, 2, 2\); expected \(3, 1, 2\)"),
    ({"outputs": np.full((3, 1, 2), np.inf)}, "finite, or NaN"),
    ({"truth": np.zeros((3, 2))}, r"truth has shape \(3, 2\)"),
    ({"distances": {"stereo": np.zeros((3, 1))}}, "must be positive numbers or NaN"),
    ({}, "no point 1; there are 0 to 0"),
)


def test_half_an_image_is_none():
    half = IMAGES["outputs"].copy()
    half[1, 0, 0] = np.nan
    assert not Recording(**IMAGES | {"outputs": half}).seen[1, 0]


test_wrong_scenarios_are_refused = refuses(
    lambda state, duration, asked: record(PointsScenario("wrong", OF_ONE, state, duration), asked),
    ([0.0, 1.0], 1.0, None, "3 finite numbers: r_x, r_y, r_z"),
    ([0.0, 0, 1], 0, None, "duration is 0"),
    ([0.0, 0, 1], 1.0, 0.001, "record longer"),
    ([0.0, 0, 1], 1.0, -1.0, "record longer"),
)


def test_a_state_that_leaves_every_bound_is_refused():
    explosive = PointsScenario("explosive", PointsForm(linear(50 * np.eye(3), np.ones(3)), np.eye(3)), [1, 1, 1], 20.0)
    with pytest.raises(LeavesEveryBound, match="leaves every bound at"):
        record(explosive)
