"""A recording is what the camera saw of the true motion, whichever way it was made; a wrong one is refused."""

import numpy as np
import pytest
from examples import NOISE, NOISY
from refusals import refuses
from scipy.linalg import expm

from percept_obs import (
    BehindCamera,
    Camera,
    Gaussian,
    Recording,
    Scenario,
    Uniform,
    affine,
    chained,
    pinhole,
    record,
    rigid,
    scenarios,
)
from percept_obs.compile.integrator import instants, step_grid
from percept_obs.recording import seeded

STILL = affine(np.zeros((3, 3)), np.zeros(3))
TIME = np.array([0.0, 0.1, 0.3])
OUTPUTS = np.array([[0.1, 0.2], [0.2, 0.3], [0.3, 0.1]])


def make(**changes):
    settings = {"time": TIME, "outputs": OUTPUTS, "names": ("y1", "y2"), "view": pinhole(), "motion": STILL}
    return Recording(**(settings | changes))


def test_the_truth_is_the_matrix_exponential():
    scenario = scenarios.ma2005_eq35()
    values = list(scenario.motion.values.values())
    together = np.zeros((4, 4))
    together[:3, :3], together[:3, 3] = np.reshape(values[:9], (3, 3)), values[9:]
    recording = record(scenario, 80, Camera(period=0.5))
    exact = [(expm(together * t) @ [*scenario.position, 1])[:3] for t in recording.time]
    np.testing.assert_allclose(recording.points, exact, rtol=1e-9)


def test_the_exact_signal_continues_the_samples():
    recording = record(scenarios.ma2005_eq35(), 2, Camera(period=0.1, noise=NOISE), seed=1)
    np.testing.assert_allclose(recording.signal(recording.time), recording.truth[:, :2], atol=1e-12)


def test_noise_has_the_variance_it_states():
    scenario = scenarios.ma2005_eq35()
    for noise in (Uniform(0.01), Gaussian(0.02)):
        recording = record(scenario, 80, Camera(noise=noise), seed=7)
        deviation = recording.outputs - recording.truth[:, :2]
        assert np.var(deviation) == pytest.approx(noise.variance, rel=0.03)
        assert abs(np.mean(deviation)) < 5e-4
        assert recording.noise_variance == noise.variance
        assert repr(noise) in recording.source
    assert np.abs(record(scenario, 9, NOISY, seed=1).outputs - record(scenario, 9).outputs).max() <= 0.01


def test_a_seed_is_a_recording():
    one, same, other = (record(scenarios.ma2005_eq35(), 1, NOISY, seed=s).outputs for s in (5, 5, 6))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)
    drawn = record(scenarios.ma2005_eq35(), 1, NOISY, seed=np.random.default_rng(5))
    assert "given generator" in drawn.source


def test_the_numbers_are_those_of_the_reference_mersenne_twister():
    """Matsumoto and Nishimura 1998: init_genrand(5489) begins with these 32-bit integers."""
    first, second = 3499211612, 581869302
    assert seeded(5489).random() == ((first >> 5) * 2**26 + (second >> 6)) / 2**53


def test_lost_samples_are_missing_and_the_first_is_not():
    recording = record(scenarios.ma2005_eq35(), 40, Camera(dropout=0.4), seed=2)
    lost = np.isnan(recording.outputs)
    assert not lost[0].any()
    assert (lost[:, 0] == lost[:, 1]).all()
    assert lost.mean() == pytest.approx(0.4, abs=0.03)


def test_a_part_of_a_recording():
    part = record(scenarios.ma2005_eq35(), 2).between(0.5, 1.0)
    assert part.time[[0, -1]].tolist() == [0.5, 1.0]
    assert len(part.truth) == len(part.outputs) == 51


def test_recordings_cannot_be_changed():
    recording = record(scenarios.ma2005_eq35(), 1)
    with pytest.raises(ValueError, match="read-only"):
        recording.outputs[0] = 1


def test_from_csv(tmp_path):
    path = tmp_path / "mine.csv"
    path.write_text("time,y1,y2,y3\n0,0.1,0.2,0.5\n0.1,0.2,0.3,0.5\n0.3,0.3,0.1,0.4\n")
    recording = Recording.from_csv(path, STILL)
    assert np.array_equal(recording.outputs, OUTPUTS)
    assert recording.truth[:, 2].tolist() == [0.5, 0.5, 0.4]
    path.write_text("t,y1\n0,0.1\n0.1,\n0.3,0.3\n")
    recording = Recording.from_csv(path, STILL, time="t")
    assert recording.names == ("y1",)
    assert np.isnan(recording.outputs[1, 0])
    assert recording.truth is None
    assert recording.points is None


test_what_is_no_recording_is_refused = refuses(
    lambda changes: make(**changes),
    ({"time": [], "outputs": np.zeros((0, 2))}, "at least two samples"),
    ({"time": [0.0, 0.1]}, "outputs of shape"),
    ({"outputs": OUTPUTS[:, :1]}, "one column for each of the names, y1, y2"),
    ({"time": [0.0, 0.3, 0.1]}, "row 2"),
    ({"time": [0.0, 0.1, 0.1]}, "sort the rows and remove repeated ones"),
    ({"time": [0.0, np.nan, 0.1]}, "finite"),
    ({"names": ("y1", "z")}, "are named y1, z; there are y1, y2, each once"),
    ({"names": ("y1", "y1")}, "each once"),
    ({"outputs": [[0, 1], [np.inf, 1], [1, 1]]}, "outputs are finite"),
    ({"truth": np.zeros((2, 3))}, "the truth has shape"),
    *(({"distances": {name: np.ones(3)}}, f"have the name '{name}'") for name in ("", "time", "truth", "y1")),
    ({"truth": [[0, 0, 1], [0, 0, np.inf], [0, 0, 1]]}, "finite"),
    ({"distances": {"stereo": [1, 2]}}, "must be positive numbers or NaN, of shape \\(3,\\)"),
    ({"distances": {"stereo": [1, 2, -1]}}, "must be positive numbers or NaN, of shape \\(3,\\)"),
    ({"motion": affine()}, "no values for a11"),
    ({"motion": rigid(camera_angular_velocity=np.zeros((2, 3)), times=[0, 0.2])}, r"known from 0 to 0\.2 s"),
)


AWAY, RUNAWAY = affine(np.zeros((3, 3)), [0, 0, -1]), affine(1000 * np.eye(3), [0, 0, 0])

test_what_no_camera_sees_is_refused_with_its_time = refuses(
    lambda call: call(),
    (lambda: make(truth=[[0, 0, 1], [0, 0, -0.5], [0, 0, 1]]), r"-0.5 at 0.1 s"),
    (
        lambda: record(Scenario("passing", AWAY, (0, 0, 1.9), 5, pinhole()), camera=Camera(period=0.5)),
        r"at 2 s, the point .* has the distance -0.1",
    ),
    (lambda: Scenario("behind", AWAY, (0, 0, -2), 5, pinhole()), "distance"),
    (lambda: record(Scenario("runaway", RUNAWAY, (0, 0, 2), 5, pinhole())), "leaves every bound"),
    error=BehindCamera,
)


test_settings_that_make_no_sense_are_refused = refuses(
    lambda build: build(),
    (lambda: Camera(period=0), "must be positive"),
    (lambda: Camera(dropout=1), "probability"),
    (lambda: Uniform(-1), "bound"),
    (lambda: Gaussian(np.inf), "sigma"),
    (lambda: Scenario("s", STILL, (1, 2), 1, pinhole()), "expected 3 finite numbers: X, Y, Z"),
    (lambda: Scenario("s", STILL, (1, 2, 3), 0, pinhole()), "duration"),
    (lambda: record(scenarios.ma2005_eq35(), 0), "holds no two samples"),
    (lambda: record(scenarios.ma2005_eq35(), 0.005), "holds no two samples"),
    (lambda: record(Scenario("s", affine(), (1, 2, 3), 1, chained())), "no values"),
)


def test_the_grid_of_steps():
    grid, index = step_grid(np.array([0.0, 0.0, 0.1, 0.35]), 0.1)
    np.testing.assert_allclose(grid, [0, 0.1, 0.1 + 0.25 / 3, 0.1 + 0.5 / 3, 0.35])
    assert index.tolist() == [0, 0, 1, 4]
    np.testing.assert_allclose(instants(np.array([0.0, 1.0, 3.0])), [0, 0.5, 1, 2, 3])


def test_a_true_distance_is_the_inverse_of_the_last_coordinate():
    recording = record(scenarios.ma2005_eq35(), 1)
    np.testing.assert_allclose(recording.distance, 1 / recording.truth[:, -1])
    np.testing.assert_allclose(recording.points[:, 2], recording.distance)
    bare = Recording(recording.time, recording.outputs, ("y1", "y2"), pinhole(), recording.motion)
    assert bare.points is None
    with pytest.raises(ValueError, match="no truth to compare with"):
        _ = bare.distance
