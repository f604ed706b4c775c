"""A simulated IMU's noise and walk are those of their densities, at any rate of its samples."""

import numpy as np
import pytest

from percept_obs.recording.imu import Imu
from percept_obs.system.inertial import imu

REST = imu([0, 0, 0], [0, 0, 9.8])
DENSITIES = [0.02, 0.02, 0.02, 0.03, 0.03, 0.03]
EXACT = {f"{of}_{error}": 0.0 for of in ("turning", "force") for error in ("noise", "bias", "walk")}


@pytest.mark.parametrize("rate", [25.0, 100.0])
def test_biases_walk_and_noise_averages_as_fast_at_any_rate(rate):
    seconds = np.arange(100.0)
    _, biases = Imu(**EXACT | {"turning_walk": 0.02, "force_walk": 0.03}, rate=rate).measured(REST, 100, seed=1)
    assert np.diff(biases(seconds), axis=0).std(axis=0) == pytest.approx(DENSITIES, rel=0.25)
    noisy, _ = Imu(**EXACT | {"turning_noise": 0.02, "force_noise": 0.03}, rate=rate).measured(REST, 100, seed=1)
    samples = noisy.known(np.arange(0, 100, 1 / rate)).reshape(100, -1, 6)
    assert samples.mean(axis=1).std(axis=0) == pytest.approx(DENSITIES, rel=0.25)


def test_what_is_known_of_an_imu_has_its_noise_and_its_walk():
    known, _ = Imu().measured(REST, 1, seed=1)
    each = [Imu().turning_noise, Imu().force_noise, Imu().turning_walk, Imu().force_walk]
    assert [*known.densities] == [f"{name}{k}" for name in ("w", "a", "b_w", "b_a") for k in (1, 2, 3)]
    assert [*known.densities.values()] == pytest.approx(np.repeat(each, 3) ** 2)
