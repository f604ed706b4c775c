"""Noise makes every observer of structure and motion scatter as was measured."""

import numpy as np
import pytest

from percept_obs import record
from percept_obs.structure.competitors import competitors, scale_spread
from percept_obs.structure.scenarios import chwa2019_experiment

pytestmark = pytest.mark.slow


def spread_of(table, name, column="decibels"):
    rows = table[table.observer == name].set_index(column)
    return rows["std"]


def test_scatter_with_an_exact_inverse_depth():
    """Chatter-free observers pass on noise in proportion; filters trade it against how fast they follow."""
    exact = scale_spread((100.0, 40.0))
    layer = spread_of(exact, "ISMO, boundary layer")
    for decibels, expected in ((100, 0.065), (40, 62)):
        assert layer[decibels] == pytest.approx(expected, rel=0.1)
    kalman, extended = (spread_of(exact, name) for name in ("Kalman filter, linear view", "EKF"))
    for decibels, bound in ((100, 0.14), (40, 0.93)):
        assert kalman[decibels] < bound
        assert extended[decibels] < kalman[decibels]
    assert spread_of(exact, "IBO, linear view")[40] < 0.3
    assert (spread_of(exact, "ISMO, ideal switch, b = 0") < layer).all()
    right = exact[(exact.decibels == 100) & ~exact.observer.isin(["IBO", "De Luca, linear view"])]
    assert (abs(right["mean"] - 10.4) < 0.01).all()
    # one gain for columns of such different sizes: the scale hardly moves
    assert exact[(exact.observer == "IBO") & (exact.decibels == 100)]["mean"].item() < 5
    assert not exact.missing.any()


def test_scatter_grows_with_time_unless_the_slope_stays():
    names = ["ISMO, ideal switch", "ISMO, ideal switch, b = 0"]
    table = scale_spread((80.0,), windows=((1, 2), (9, 10), (19, 20)), observers=names)
    growing, staying = (spread_of(table, name, "begin") for name in names)
    assert growing[19] > 1.8 * growing[1]
    np.testing.assert_allclose(staying, staying.mean(), rtol=0.1)


def test_filters_need_to_know_the_noise():
    with pytest.raises(ValueError, match="the recording has none; record it with noise"):
        competitors(record(chwa2019_experiment("IV.A"), 1))
