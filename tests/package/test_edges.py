"""Laws at the edges: one sample more, one name beside, another unit, where a slip of one would hardly show."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from percept_obs import (
    Camera,
    FirstSight,
    Gaussian,
    PerspectiveSystem,
    affine,
    luenberger,
    pinhole,
    record,
    rigid,
    track,
)
from percept_obs.compile.equations import Equations
from percept_obs.compile.functions import executed, function_source
from percept_obs.compile.integrator import EACH
from percept_obs.compile.kernels import Table, solve
from percept_obs.labs.observer.analysis import run_in_words
from percept_obs.labs.observer.texts import BY_NAME, observer_on
from percept_obs.observability.directions import mainly
from percept_obs.observability.windows import UNSEEN
from percept_obs.observers import extended_kalman, linear_approximation
from percept_obs.points import PointsForm, PointsScenario, kernel, riccati, rigid_body
from percept_obs.points.gramian import Gramian, decay_bound, gramian
from percept_obs.points.scenarios import moving_body
from percept_obs.recording import scenarios
from percept_obs.recording.path import lowest_between, varying_path
from percept_obs.structure import LinearView, StructureAndMotion, competitors, linear_view
from percept_obs.structure.pixels import homography
from percept_obs.structure.scenarios import (
    chwa2019_crossing,
    chwa2019_experiment,
    chwa2019_semigeneral,
    chwa2019_simulation,
)
from percept_obs.system.motion import linear
from percept_obs.system.surfaces import plane
from percept_obs.tracking.verdict import percent


@pytest.fixture(scope="module")
def system():
    return PerspectiveSystem(affine(), pinhole())


# What is written.


@pytest.mark.parametrize("power", [sp.Rational(1, 2), -sp.Rational(1, 2), -1, -2, 3])
def test_a_power_alone_is_printed_as_it_is(power):
    x = sp.Symbol("x", positive=True)
    evaluate = executed(function_source((x,), (x**power,), "python"))
    assert evaluate([2.5], [0.0]) == pytest.approx([2.5 ** float(power)], rel=1e-15)


def test_entries_are_numbered_from_one(system):
    names = {str(s) for s in linear_approximation(system.measure("y1", "y2")).equations.state}
    assert {"P11_1", "P12_1", "P13_1", "P22_1", "P23_1", "P33_1"} <= names
    steps = system.derivation()
    assert ["m1", "m2", "m3"] in [list(step.values) for step in steps]
    assert steps == PerspectiveSystem(affine(), pinhole()).derivation()


def test_a_form_of_no_view_has_no_numbers_of_one(system):
    assert replace(system.measure("y1"), view=None).values == {}


def test_what_is_far_off_is_told_without_a_number():
    assert percent(10.0) == "1000 %"
    assert percent(10.5) == "more than 1000 %"


def test_sizes_that_differ_by_less_than_a_millionth_are_equal():
    assert mainly(np.array([1.0, 1 + 2e-7]), ["a", "b"]) == "a, b"


def test_two_deviations_are_claimed_where_two_are_said():
    observer = observer_on(BY_NAME["extended_kalman"], pinhole(), ("y1", "y2"))
    recording = record(scenarios.ma2005_eq35(), 1.0, Camera(0.05, Gaussian(0.01)))
    run = track(recording, observer, language="python")
    claim, _ = run_in_words((observer, ""), run, 1.0)
    assert f"{2 * math.sqrt(run.covariance[-1, -1, -1]):.2g} (2σ)" in claim


# Where a point moves.


def test_a_first_sample_that_destroys_the_state_is_where_it_diverged():
    x, y = sp.symbols("x y", real=True)
    equations = Equations((x,), (-x,), (y,), update=((y / x,),))
    table = Table(np.array([0.1]), np.ones((1, EACH + 1, 1)), np.zeros((1, 0)), np.ones((2, 1)))
    assert solve(equations, np.array([0.0]), table, language="python").diverged == 0


def test_a_motion_with_kinks_is_taken_apart_at_them():
    """Velocities in straight lines between their samples, whose integral is the trapezoidal rule's."""
    times = np.array([0.0, 0.31, 0.5, 1.3, 2.0])
    velocity = np.random.default_rng(0).normal(size=(5, 3))
    moving = rigid(
        camera_angular_velocity=np.zeros((5, 3)), camera_velocity=np.zeros((5, 3)), point_velocity=velocity, times=times
    )
    scene = replace(scenarios.ma2005_eq35(), motion=moving, position=(0.0, 0.0, 50.0), duration=2.0)
    steps = np.diff(times)[:, None] / 2 * (velocity[1:] + velocity[:-1])
    moved = scene.points(times)[1:] - scene.position
    np.testing.assert_allclose(moved, np.cumsum(steps, axis=0), rtol=0, atol=3e-14)


def test_the_first_of_several_equal_times_is_the_start():
    path = varying_path(lambda t, x: -x, np.array([2.0]), np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(path[:, 0], [2.0, 2.0, 2 * math.exp(-1)], rtol=1e-9)


def test_the_lowest_value_between_is_that_of_the_cubic():
    draw = np.random.default_rng(1)
    s = np.linspace(0, 1, 2001)[:, None]
    for _ in range(100):
        times, values, rates = np.cumsum(draw.uniform(0.1, 2, 4)), draw.normal(size=4), draw.normal(size=4)
        h = np.diff(times)
        cubics = (1 + 2 * s) * (1 - s) ** 2 * values[:-1] + s**2 * (3 - 2 * s) * values[1:]
        cubics += h * s * (1 - s) * ((1 - s) * rates[:-1] - s * rates[1:])
        dips = (rates[:-1] < 0) & (rates[1:] > 0)
        lowest, when = lowest_between(values, rates, times)
        assert lowest == pytest.approx(cubics[:, dips].min(initial=np.inf), abs=1e-5)
        k = np.searchsorted(times, when) - 1
        assert not dips.any() or dips[k]


def test_a_hole_in_the_motion_counts_only_during_the_recording():
    times = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 5.0])
    motion = rigid(
        camera_angular_velocity=np.zeros((6, 3)),
        camera_velocity=np.zeros((6, 3)),
        point_velocity=np.zeros((6, 3)),
        times=times,
    )
    seen = record(replace(scenarios.ma2005_eq35(), motion=rigid(point_velocity=(0, 0, 0)), duration=0.4))
    replace(seen, motion=motion)  # a warning would be an error here


def test_samples_without_noise_tell_where_the_point_is():
    recording = record(scenarios.ma2005_eq35(), 3.0, Camera(0.1))
    run = track(recording, observer_on(BY_NAME["extended_kalman"], pinhole(), ("y1", "y2")), language="python")
    np.testing.assert_allclose(run.trust().information.estimate, recording.truth[-1], rtol=1e-5)


# What many points tell.


def test_units_of_the_state_do_not_matter():
    """Of z = x / 2 the estimate is half of that of x, when P is four times as large."""
    motion = linear(np.zeros((3, 3)), [0.3, -0.1, 0.05])
    half = linear(np.zeros((3, 3)), [0.15, -0.05, 0.025])
    runs = []
    for moving, C, size in ((motion, np.eye(3), 1.0), (half, 2 * np.eye(3), 4.0)):
        form = PointsForm(moving, C, names=("a", "b", "c"))
        start = np.array([0.2, -0.1, 2.0]) * C[0, 0] ** -1
        recording = record(PointsScenario("one", form, start.tolist(), 1.0), camera=Camera(0.1))
        runs.append(track(recording, luenberger(form, riccati(size)), 1.1 * start, language="python"))
    np.testing.assert_allclose(2 * runs[1].state, runs[0].state, rtol=1e-12)
    np.testing.assert_allclose(runs[1].P, 4 * runs[0].P, rtol=1e-12)


def test_a_point_that_comes_anew_owes_nothing_to_the_others():
    """Its place is forgotten while it is away for too long, and with it what P has learnt of both together."""
    recording = record(moving_body(2), 1.0, Camera(0.05)).without(0.4, 0.8, 1)
    run = track(recording, luenberger(recording.view, riccati(0.02)), FirstSight(2.0, 0.2), language="python")
    gone = np.flatnonzero(~recording.seen[:, 1])
    before, back = (run.P[np.flatnonzero(run.kept == k)[0]] for k in (gone[0], gone[-1] + 1))
    assert np.abs(before[3:, :3]).max() > 1e-6
    np.testing.assert_array_equal(back[3:, :3], 0)
    np.testing.assert_array_equal(back[:3, 3:], 0)
    np.testing.assert_array_equal(back[3:, 3:], 0.02 * np.eye(3))


def test_cholesky_by_loops_solves():
    root = np.random.default_rng(0).normal(size=(4, 4))
    P, right = root @ root.T + np.eye(4), np.arange(4.0)
    np.testing.assert_allclose(kernel.solve_by_loops(P, right), np.linalg.solve(P, right), rtol=1e-12)


@pytest.mark.parametrize("combine", [kernel.combine_by_loops, kernel.combine_by_numpy])
def test_the_kernel_combines_as_numpy(combine):
    (first, second), target = np.random.default_rng(0).normal(size=(2, 5)), np.zeros(5)
    combine(target, first, -0.3, second)
    np.testing.assert_allclose(target, first - 0.3 * second, rtol=1e-15)


def test_a_body_is_seen_on_the_surface_that_is_asked_for():
    tilted = plane([0.1, -0.2, 0.9])
    assert rigid_body(2, surface=tilted).surface == tilted


def test_what_is_unseen_is_so_beside_the_largest():
    form = PointsForm(linear(np.zeros((3, 3)), [0.0, 0.0, 1.0]), np.eye(3), names=("a", "b", "c"))
    for scale in (1e-3, 1.0, 1e3):
        weak = scale * np.diag([0.5 * UNSEEN * 1e3, 1.0, 1e3])
        assert Gramian(form.names, np.zeros(1), weak[None], 1.0).unseen().shape == (3, 1)


def test_the_bound_sees_all_of_its_window():
    recording = record(moving_body(1), 1.0, Camera(0.1))
    bound = decay_bound(recording, luenberger(recording.view, 1.0), 1.0)
    assert bound.seen[0] == pytest.approx(gramian(recording, 1.0).smallest[0], rel=1e-6)


# Structure and motion.


def test_no_pictures_give_no_homographies():
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert homography(corners, np.empty((0, 4, 2))).shape == (0, 3, 3)


def test_behind_the_camera_the_linear_view_shows_nothing():
    view = LinearView(StructureAndMotion(("v_c1",), scale=2.0))
    scaled = view.scaled([[0.3, 0.2, 0.5], [0.3, 0.2, -0.5], [0.3, 0.2, 0.0]])
    np.testing.assert_allclose(scaled[0], [0.6, 0.4, 2.0])
    assert np.isnan(scaled[1:]).all()
    coordinates = np.array([[0.6, 0.4, 2.0, 0.1], [0.6, 0.4, -2.0, 0.1]])
    assert view.inverse(coordinates)[0] == pytest.approx(1.0)
    assert not np.isfinite(view.locate(coordinates)[1]).any()
    assert np.isnan(view.inverse(coordinates)[1])
    recording = record(chwa2019_simulation("V.A"), 0.01)
    lost = recording.outputs.copy()
    lost[3, 2] *= -1
    assert np.isnan(linear_view(replace(recording, outputs=lost)).outputs[3]).all()


def test_a_moving_scene_begins_as_the_still_one_of_its_set_up():
    for name, case in (("simulation", chwa2019_simulation), ("experiment", chwa2019_experiment)):
        still, whole = case("IV.A"), chwa2019_semigeneral(name)
        assert (whole.position, whole.scale) == (still.position, still.scale)
    assert chwa2019_crossing().motion.known(1.0)[0, 6:][2] == 0


def test_the_spread_is_that_of_each_window(monkeypatch):
    def one(recording):
        gains = {
            "noise_variance": 1e-8,
            "measured_variance": 1e-8,
            "hidden_process_noise": 1.0,
            "hidden_variance": 100.0,
        }
        return {"EKF": (recording, extended_kalman(recording.view.form, **gains))}

    monkeypatch.setattr(competitors, "competitors", one)
    windows = ((0.02, 0.03), (0.05, 0.06))
    table = competitors.scale_spread([60.0], windows=windows, seed=3)
    camera = competitors.ScaledDepthCamera(pixels=competitors.CHWA_CAMERA, ratio=competitors.SignalToNoise(60.0))
    recording = record(chwa2019_experiment("IV.A"), 0.06, camera, 3)
    run = track(*one(recording)["EKF"], hold="first", step=1e-3)
    for row, (begin, end) in zip(table.itertuples(), windows, strict=True):
        inside = run.estimate[(run.time >= begin) & (run.time <= end), 3]
        assert (row.mean, row.std) == pytest.approx((np.nanmean(inside), np.nanstd(inside)))
