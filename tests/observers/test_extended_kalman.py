"""The extended Kalman filter is a Kalman filter where the system is linear, converges on any surface, is consistent."""

import numpy as np
import pytest
import sympy as sp
from examples import AFFINE, BOTH, NOISY, ON_SPHERE, ONE, ZERO

from percept_obs import Camera, Gaussian, ekf, record, scenarios, track

EQ35 = scenarios.ma2005_eq35()


@pytest.mark.slow
def test_one_output_converges_from_zero_in_every_seed():
    for seed in range(50):
        run = track(record(EQ35, 20, NOISY, seed=seed), ekf(ONE), ZERO, language="numba")
        assert abs(run.error[-1, 2]) < 0.01


@pytest.mark.slow
def test_both_outputs_stay_close_from_two_seconds_on():
    for seed in range(20):
        run = track(record(EQ35, camera=NOISY, seed=seed), ekf(BOTH), ZERO, language="numba")
        assert np.abs(run.error[200:, 2]).max() < 0.05


@pytest.mark.slow
@pytest.mark.parametrize("form", [ONE, BOTH], ids=["y1", "y1+y2"])
def test_the_claimed_covariance_is_consistent(form):
    """Normalised innovations have the mean that their number of outputs asks; errors keep within three sigma."""
    camera = Camera(noise=Gaussian(0.01))
    observer = ekf(form, noise_variance=1e-4, measured_variance=1e-4, hidden_variance=0.01)
    outputs = len(form.x1)
    squared, outside = [], []
    for seed in range(30):
        recording = record(EQ35, 20, camera, seed=seed)
        draw = np.random.default_rng(seed).normal(0, 0.1, 3)
        start = {s.name: float(recording.truth[0, int(s.name[1]) - 1] + draw[int(s.name[1]) - 1]) for s in form.x2}
        run = track(recording, observer, start, language="numba")
        squared.append(np.mean(run.nis[100:]))
        sigma = np.sqrt(run.covariance[100:, 2, 2])
        outside.append(np.mean(np.abs(run.error[100:, 2]) > 3 * sigma))
    assert np.mean(squared) == pytest.approx(outputs, rel=0.03)
    assert np.mean(outside) < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("names", [("y1",), ("y2",), ("y1", "y2")], ids="+".join)
def test_it_converges_on_a_sphere_with_any_outputs(names):
    """Also with one output, which has no canonical form there."""
    recording = record(scenarios.ma2005_eq35(ON_SPHERE.surface), 6)
    run = track(recording, ekf(ON_SPHERE.partition(*names)), ZERO, language="python")
    assert run.settling_time(0.05) < 5
    assert np.abs(run.error[-1]).max() < 1e-3


def test_a_canonical_form_makes_no_difference():
    divided, canonical = ekf(AFFINE.partition("y1")), ekf(ONE)
    flows = (sp.Matrix(observer.equations.flow).expand() for observer in (divided, canonical))
    assert next(flows) == next(flows)
    assert divided.equations.update == canonical.equations.update
    recording = record(EQ35, 20, NOISY, seed=2)
    runs = [track(recording, observer, ZERO, language="python") for observer in (divided, canonical)]
    np.testing.assert_allclose(runs[0].estimate, runs[1].estimate, rtol=1e-10, atol=1e-12)


def test_outputs_may_take_turns_in_any_order():
    recording = record(EQ35, 5, NOISY, seed=1)
    other = ekf(AFFINE.measure("y2", "y1"))
    np.testing.assert_allclose(
        track(recording, other, ZERO).estimate, track(recording, ekf(BOTH), ZERO).estimate, atol=1e-9
    )


def test_noise_of_the_velocities_moves_the_covariance_by_the_interaction_matrix():
    """The derivative of an image with respect to velocity and angular velocity, as Chaumette prints it."""
    y1, y2, y3, n_w, n_v = 0.3, -0.2, 0.4, 0.7, 1.3
    L = np.array([[-y3, 0, y1 * y3, y1 * y2, -1 - y1**2, y2], [0, -y3, y2 * y3, 1 + y2**2, -y1 * y2, -y1]])
    equations = ekf(BOTH).equations
    values = {symbol: 0.0 for symbol in (*equations.parameters, *equations.gains, *equations.state)}
    values |= dict(zip(equations.state[:3], (y1, y2, y3), strict=True))
    noise = {symbol: n for symbol in equations.gains for n, name in ((n_w, "Q_w"), (n_v, "Q_v")) if symbol.name == name}
    found = {str(s): float(rate.subs(values | noise)) for s, rate in zip(equations.state, equations.flow, strict=True)}
    expected = L @ np.diag([n_v] * 3 + [n_w] * 3) @ L.T
    np.testing.assert_allclose([found["P11"], found["P12"], found["P22"]], expected[[0, 0, 1], [0, 1, 1]], rtol=1e-12)
