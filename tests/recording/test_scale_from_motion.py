"""Scale and range are seen where somebody accelerates, and nowhere else: camera with an IMU, bearings only."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from percept_obs import Camera, Gaussian, PointsScenario, cramer_rao, ekf, luenberger, record, scenarios, track
from percept_obs.points import camera_imu, riccati, trusting
from percept_obs.points.gramian import gramian
from percept_obs.recording.imu import read_imu
from percept_obs.recording.state_scenario import StateScenario
from percept_obs.system.bearings import ACCELERATION, bearings_only, own_ship
from percept_obs.system.inertial import camera_with_imu, imu

START = (0.4, 0.2, 4.0, -0.9, 0.0, -0.4, 0.0, 9.81, 0.0)
GUESS = (0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 9.0, 0.0)


def walk(shake):
    """A landmark before a camera whose IMU feels a shake of so many m/s^2."""
    times = np.arange(0, 12.01, 0.02)
    felt = shake * np.sin(np.outer(times, [2, 3, 2.5]) + np.array([0, 1, 2])) - np.array([0, 9.81, 0])
    form = camera_imu(1, np.zeros(3), felt, times)
    return form, record(PointsScenario("walk", form, START, 12), camera=Camera(0.02, Gaussian(1e-3)), seed=1)


@pytest.mark.slow
def test_the_start_of_p_follows_from_noise_and_spread_and_a_large_one_holds_on():
    form, recording = walk(2.0)
    chosen, stiff = (
        track(recording, luenberger(form, P), GUESS).relative_error[-1]
        for P in (trusting(1e-3, 0.02, 4, 2), riccati(0.1))
    )
    assert chosen < 0.01 < 0.05 < stiff


@pytest.mark.slow
def test_constant_speed_hides_the_scale_of_place_and_speed():
    seen, hidden = (gramian(walk(shake)[1], 8.0).least for shake in (2.0, 0.0))
    assert hidden < 1e-6 * seen


@pytest.mark.slow
@pytest.mark.parametrize("accelerates", [True, False])
def test_a_filter_claims_a_range_only_after_the_own_ship_accelerated(accelerates):
    ship, noise = scenarios.own_ship_turns(), np.radians(0.5)
    ship = ship if accelerates else replace(ship, motion=own_ship([0.0, 0.0]))
    recording = record(ship, 28, Camera(0.1, Gaussian(noise)))
    observer = ekf(bearings_only().partition("y3"), noise_variance=noise**2, hidden_variance=1e-4)
    run = track(recording, observer, {"y4": 1 / 300})
    claimed = np.sqrt(run.covariance[:, -1, -1]) / run.truth[:, -1]
    assert claimed[99] > 5
    assert (claimed[-1] < 0.05) == accelerates
    bound = cramer_rao(recording, observer.form, {"y3": noise**2, "y1": 1e-4, "y2": 1e-4, "y4": 1e-4})
    assert (bound.relative[-1] < 0.05) == accelerates


@pytest.mark.slow
def test_on_a_straight_course_the_range_is_in_no_rate_but_its_own():
    form = bearings_only().partition("y3")
    steady = form.rate[:-1, :].xreplace(dict.fromkeys(ACCELERATION, sp.S.Zero))
    assert form.x2[-1] not in steady.free_symbols


def in_millimetres(scene):
    """A scene with its lengths in millimetres, which are the same world."""
    view, known = scene.seen, scene.known_motion
    samples = known.signal.samples * 1000.0 ** np.array(known.lengths)
    state = np.array(scene.state) * 1000.0 ** np.array(view.powers)
    true = scene.motion.signal.samples * 1000.0 ** np.array(scene.motion.lengths)
    motions = (
        imu(each[:, :3], each[:, 3:], other.signal.times) for each, other in ((true, scene.motion), (samples, known))
    )

    def biases(times):
        return scene.constants(times) * [1, 1, 1, 1000, 1000, 1000]

    return StateScenario("mm", view, next(motions), state, scene.duration, next(motions), biases, unit=1000.0)


@pytest.mark.slow
def test_millimetres_change_nothing_relative():
    scene, errors = scenarios.held_phone(seed=1), []
    for each in (scene, in_millimetres(scene)):
        seen = record(each, 2, Camera(1 / 30, Gaussian(1e-3)), seed=1)
        observer = ekf(camera_with_imu().partition("y1", "y2"), noise_variance=1e-6, velocity_noise=1e-5)
        errors.append(track(seen, observer, {"y3": 0.5 / each.unit}).relative_error)
    assert np.allclose(*errors, rtol=1e-7, atol=1e-9)


@pytest.mark.slow
def test_one_landmark_and_a_telephone_s_imu_with_unknown_biases_find_the_scale():
    for seed in range(5):
        seen = record(phone := scenarios.held_phone(seed=100 + seed), 10.1, Camera(1 / 30, Gaussian(1e-3)), seed=seed)
        densities = {"turning_noise": 1.6e-4**2, "velocity_noise": 2.8e-3**2}
        observer = ekf(camera_with_imu().partition("y1", "y2"), noise_variance=1e-6, **densities)
        gravity = -phone.known_motion.known(0.0)[0, 3:]
        run = track(seen, observer, {"y3": 0.5, **{f"q{k + 1}": 0.5 * each for k, each in enumerate(gravity)}})
        assert run.relative_error[300] < 0.02


@pytest.mark.parametrize(
    ("rows", "said"), [("0,1,2\n", "column"), ("0,0,0,x,0,0,0\n", "x"), ("5,0,0,0,0,0,0\n" * 2, "increas")]
)
def test_bad_files_of_an_imu_are_refused_with_a_sentence(tmp_path, rows, said):
    (tmp_path / "data.csv").write_text(rows)
    with pytest.raises(ValueError, match=said):
        read_imu(tmp_path / "data.csv")
