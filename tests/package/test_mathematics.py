"""Ma's two examples do what was verified of them, in every number: what the paper shows, and what happens."""

from functools import lru_cache

import numpy as np
import pytest
from examples import AFFINE, BOTH, NOISE, NOISY, ONE, ZERO
from sample_sizes import sampled

from percept_obs import Camera, ibo, record, scenarios, smo, track, windowed

EQ35, EQ36 = scenarios.ma2005_eq35(), scenarios.ma2005_eq36()
FROM_SAMPLE = None
SEEDS = range(100)


@lru_cache
def clean(scenario):
    return record(scenario)


def matrix(scenario):
    return np.reshape(list(scenario.motion.values.values())[:9], (3, 3))


def test_eigenvalues():
    eigenvalues = np.linalg.eigvals(matrix(EQ35))
    np.testing.assert_allclose(eigenvalues.real, 0, atol=1e-12)
    np.testing.assert_allclose(np.sort(eigenvalues.imag), [-0.374, 0, 0.374], atol=5e-4)
    np.testing.assert_allclose(np.sort(np.linalg.eigvals(matrix(EQ36)).real), [-1, 0, 0.2], atol=1e-12)


def test_depth_over_80_seconds():
    depth = 1 / clean(EQ35).truth[:, 2], 1 / clean(EQ36).truth[:, 2]
    np.testing.assert_allclose([depth[0].min(), depth[0].max()], [1.04, 14.3], rtol=2e-3)
    np.testing.assert_allclose([depth[1].min(), depth[1].max()], [2.28, 2.2e6], rtol=1e-2)


def test_closest_to_the_focus_of_expansion():
    for scenario, distance, when in ((EQ35, 0.832, 16.4), (EQ36, 1.288, 0.0)):
        focus = np.array([float(e.subs(scenario.motion.values)) for e in AFFINE.foe])
        np.testing.assert_allclose(focus, [1.667, 0.833], atol=5e-4)
        away = np.linalg.norm(clean(scenario).truth[:, :2] - focus, axis=1)
        assert away.min() == pytest.approx(distance, abs=5e-4)
        assert clean(scenario).time[away.argmin()] == pytest.approx(when, abs=0.05)


def test_excitation_of_one_output():
    assert windowed(ONE, clean(EQ35), 10).least == pytest.approx(0.035, abs=5e-4)
    assert windowed(ONE, clean(EQ36), 10).least < 1e-10
    assert windowed(BOTH, clean(EQ35), 10).least > 1


@pytest.mark.parametrize("observer", [ibo, smo], ids=["identifier-based", "sliding mode"])
@pytest.mark.parametrize("scenario", [EQ35, EQ36], ids=["(35)", "(36)"])
def test_both_outputs_converge(observer, scenario):
    for seed in range(sampled(2, 5)):
        run = track(record(scenario, camera=NOISY, seed=seed), observer(BOTH), ZERO)
        assert run.settling_time(0.05, "y3") < 6
        if scenario is EQ35:
            assert 3.3e-3 < run.rms(20, 80) < 4.1e-3


def test_a_smaller_gain_converges_with_one_output():
    run = track(clean(EQ35), ibo(ONE, gain=5), ZERO, hold="exact")
    assert run.rms(20, 80, "y3") == pytest.approx(1.5e-4, rel=0.1)


@pytest.mark.slow
def test_starting_from_the_first_sample_cures():
    assert track(clean(EQ35), smo(ONE), FROM_SAMPLE, hold="exact").settling_time(0.05, "y3") < 40
    for seed in SEEDS:
        run = track(record(EQ35, camera=NOISY, seed=seed), ibo(ONE), FROM_SAMPLE, language="numba")
        assert len(run.resets) == 0
        assert abs(run.error[-1, 2]) < 0.15


def ends(variance, seeds, period=0.01):
    """Resets and final errors of the inverse depth."""
    observer = ibo(ONE, noise_variance=variance)
    camera = Camera(period, NOISE)
    runs = [track(record(EQ35, camera=camera, seed=s), observer, ZERO, language="numba") for s in seeds]
    return [r.resets for r in runs], np.array([abs(r.error[-1, 2]) for r in runs])


@pytest.mark.slow
def test_noise_drives_every_seed_to_the_bound():
    resets, final = ends(0.0, SEEDS)
    first = [times[0] for times in resets]
    assert len(first) == 100
    assert min(first) > 36
    assert max(first) < 57
    assert np.median(final) == pytest.approx(5.5, abs=0.1)


@pytest.mark.slow
def test_the_correction_cures_the_noise():
    resets, final = ends(NOISE.variance, SEEDS)
    assert sum(len(times) > 0 for times in resets) <= 2
    assert (final < 0.15).sum() >= 95


@pytest.mark.slow
def test_the_correction_with_samples_of_one_millisecond():
    resets, final = ends(NOISE.variance, range(20), period=0.001)
    assert not any(len(times) for times in resets)
    assert (final < 0.05).all()


@pytest.mark.slow
def test_the_bias_does_not_depend_on_the_sample_rate():
    """Without the correction, ten times as many samples do not help."""
    resets, _ = ends(0.0, range(3), period=0.001)
    assert all(len(times) for times in resets)


def test_what_the_hold_alone_does():
    """No noise: 10 and 20 ms shift the estimate, 50 ms drive it to the bound, from the zero start."""
    exact = track(clean(EQ35), ibo(ONE), ZERO, hold="exact")
    shift = {}
    for period in (0.001, 0.01, 0.02, 0.05):
        run = track(record(EQ35, camera=Camera(period)), ibo(ONE), ZERO)
        every = np.searchsorted(run.time, exact.time[::10] - 1e-9)
        shift[period] = np.abs(run.estimate[every, 2] - exact.estimate[::10, 2]).max()
        assert bool(len(run.resets)) == (period == 0.05)
    assert 0.03 < shift[0.01] < 0.06
    assert 0.003 < shift[0.001] < 0.006
    assert shift[0.01] < shift[0.02] < 0.5
