"""Scale and range are seen where somebody accelerates, and nowhere else: camera with an IMU, bearings only."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from scale_study import judged

from percept_obs import Camera, Gaussian, PointsScenario, check, cramer_rao, ekf, luenberger, record, scenarios, track
from percept_obs.observability.lie import lie_derivatives
from percept_obs.points import camera_imu, riccati, trusting
from percept_obs.recording.imu import read_imu
from percept_obs.recording.state_scenario import StateScenario
from percept_obs.system.bearings import ACCELERATION, bearings_only, own_ship
from percept_obs.system.inertial import a, camera_with_imu, imu, w

START = (0.4, 0.2, 4.0, -0.9, 0.0, -0.4, 0.0, 9.81, 0.0)
GUESS = (0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 9.0, 0.0)


def walk(shake):
    """A landmark before a camera whose IMU feels a shake of so many m/s^2."""
    times = np.arange(0, 12.01, 0.02)
    felt = shake * np.sin(np.outer(times, [2, 3, 2.5]) + np.array([0, 1, 2])) - np.array([0, 9.81, 0])
    form = camera_imu(1, np.zeros(3), felt, times)
    return form, record(PointsScenario("walk", form, START, 12), camera=Camera(0.02, Gaussian(1e-3)), seed=1)


@pytest.mark.night
@pytest.mark.slow
def test_the_start_of_p_follows_from_noise_and_spread_and_a_large_one_holds_on():
    form, recording = walk(2.0)
    chosen, stiff = (
        track(recording, luenberger(form, P), GUESS).relative_error[-1]
        for P in (trusting(1e-3, 0.02, 4, 2), riccati(0.1))
    )
    assert chosen < 0.01 < 0.05 < stiff


@pytest.mark.night
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


def test_modified_polar_coordinates_keep_the_range_apart_on_a_straight_course():
    """Aidala and Hammel 1983: the range is in no rate but its own, and not observable, until the own ship turns."""
    form = bearings_only().partition("y3")
    assert check(
        """y1' = -2 y1 y2 - y4 (a_x cos(y3) - a_y sin(y3)); y2' = y1^2 - y2^2 - y4 (a_x sin(y3) + a_y cos(y3));
        y3' = y1; y4' = -y2 y4""".replace("\n", ""),
        form,
    ).right
    here = dict(zip(form.coordinates, (0.3, 0.02, -0.01, 0.002), strict=True))
    for own, entered, rank in (((0.0, 0.0), 0, 3), ((1.0, 0.5), 2, 4)):
        felt = dict(zip(ACCELERATION, own, strict=True))
        assert sum(rate.xreplace(felt).has(form.x2[-1]) for rate in form.rate[:-1]) == entered
        assert lie_derivatives(form).ranks_at(here | felt)[-1] == rank


def test_an_imu_moves_landmark_speed_and_gravity_linearly_and_only_acceleration_tells_the_scale():
    """Hamel and Samson 2017: p and v twice as large move twice as fast, but for v, which misses a + g."""
    motion = camera_imu(1).motion
    p, v, g = (sp.Matrix(sp.symbols(f"{name}1:4", real=True)) for name in "pvg")
    rate, twice = (motion.A * sp.Matrix([s * p, s * v, g]) + motion.b for s in (1, 2))
    printed = sp.Matrix([-w.cross(p) - v, -w.cross(v) + a + g, -w.cross(g)])
    assert (rate - printed).expand().is_zero_matrix
    assert (twice - 2 * rate)[:6, :].expand() == sp.Matrix([0, 0, 0, *-(a + g)])


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


@pytest.mark.night
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


@pytest.mark.parametrize("wrong", [{"shake": np.inf}, {"shake": -1.0}, {"begin": -1.0}, {"begin": 30.0}])
def test_a_shake_that_cannot_be_is_refused(wrong):
    with pytest.raises(ValueError, match="it must be finite"):
        scenarios.held_phone(**wrong)


def test_a_telephone_that_is_not_shaken_keeps_its_speed():
    truth = record(scenarios.held_phone(shake=0.0), 9, Camera(0.5)).truth
    assert np.ptp(np.linalg.norm(truth[:, 2:5] / truth[:, -1:], axis=1)) < 2e-4  # the left end of each step: 0.04


@pytest.mark.slow
def test_a_filter_with_an_imu_waits_until_its_camera_accelerates():
    begun, kept = (judged(kind, 1) for kind in ("stop and go", "constant speed"))
    run, off, trust = begun
    assert 5 < run.time[np.argmax(run.unobservable == 0)] < 7
    assert abs(off) < 3
    assert trust.trusted
    assert "no estimate from 0 to" in run.verdict()
    run, _, trust = kept
    assert run.verdict().startswith("not observable yet: 9 s of samples do not tell the distance")
    assert trust.kind == "not yet"
    assert str(trust) == "Not observable yet: 9 s of samples do not tell the distance."


@pytest.mark.slow
def test_a_filter_that_does_not_wait_is_not_trusted_at_constant_speed():
    run, _, trust = judged("constant speed", 1, given=True)
    assert run.relative_error[-1] > 0.1
    assert trust.kind in ("hidden", "nowhere")


@pytest.mark.parametrize(
    ("rows", "said"), [("0,1,2\n", "column"), ("0,0,0,x,0,0,0\n", "x"), ("5,0,0,0,0,0,0\n" * 2, "of the row before")]
)
def test_bad_files_of_an_imu_are_refused_with_a_sentence(tmp_path, rows, said):
    (tmp_path / "data.csv").write_text(rows)
    with pytest.raises(ValueError, match=said):
        read_imu(tmp_path / "data.csv")
