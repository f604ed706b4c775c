"""The figure of structure and motion draws every unknown quantity, leaves gaps as gaps, and says all of it in words."""

from dataclasses import replace

import numpy as np
import pytest
from examples import BOTH

from percept_obs import figures, record, scenarios, track
from percept_obs.observers import ekf, ismo
from percept_obs.structure import linear_view, seen_as
from percept_obs.structure.scenarios import chwa2019_experiment

ZERO = {"y1": 0.0, "y2": 0.0, "ybar3": 0.0}
fine = {"hold": "first", "step": 1e-3, "language": "python"}


@pytest.fixture(scope="module")
def recording():
    return record(chwa2019_experiment("IV.A"), 1.5)


@pytest.fixture(scope="module")
def run(recording):
    return track(recording, ismo(recording.view.form), ZERO, **fine)


@pytest.fixture(scope="module")
def unguarded(recording):
    """The same run with what the observer's start makes of the unknowns."""
    return track(recording, replace(ismo(recording.view.form), unobservable=()), ZERO, **fine)


def test_each_unknown_has_a_row_with_its_unit_and_its_truth(run):
    figure = figures.quantities(run)
    assert [ax.get_ylabel() for ax in figure.axes] == ["$d_{s}$ (1/m)", "$v_{c2}$ (m/s)", "$v_{c3}$ (m/s)"]
    for ax, true in zip(figure.axes, (10.4, -0.23, 0.0), strict=True):
        truth, estimate = (line.get_ydata() for line in ax.lines)
        np.testing.assert_allclose(truth, true, atol=1e-12)
        assert estimate[-1] == pytest.approx(true, abs=1e-3)
        low, high = ax.get_ylim()
        assert low < true < high
    assert "d_s in 1/m: the truth, 10.4; at the end integral sliding mode 10.4 (" in figure.text
    assert "(462 of 1501 estimates are missing)" in figure.text


def test_what_is_outside_the_axis_is_told(unguarded):
    assert "Outside the axis:" in figures.quantities(unguarded).text


def test_a_scale_that_is_not_positive_is_a_gap(unguarded):
    assert unguarded.estimate[:, 3].min() < 0
    figure = figures.quantities(unguarded)
    shown = figure.axes[0].lines[1].get_ydata()
    np.testing.assert_array_equal(np.isnan(shown), ~(unguarded.estimate[:, 3] > 0))
    assert f"({np.isnan(shown).sum()} of 1501 estimates are missing)" in figure.text


def test_an_observer_of_the_linear_view_stands_beside_the_others(recording, run):
    straight = linear_view(recording)
    kalman = track(straight, ekf(straight.view.form, noise_variance=1e-6, hidden_variance=100.0), **fine)
    figure = figures.quantities([run, kalman], ["sliding", "filter"])
    assert all(len(ax.lines) == 3 for ax in figure.axes)
    assert "filter 10.4" in figure.text


def test_what_does_not_belong_together_is_refused(recording, run):
    other = record(chwa2019_experiment("V.B"), 1.5)
    elsewhere = track(other, ismo(other.view.form), ZERO, **fine)
    blind = seen_as(recording, recording.view, chwa2019_experiment("IV.A").motion)
    point = track(record(scenarios.ma2005_eq35(), 1), ismo(BOTH))
    for runs, labels, message in (
        ([], None, "there are no runs"),
        ([run], ["a", "b"], "2 labels for 1 runs"),
        ([run, elsewhere], None, "different unknowns or times"),
        (track(blind, ismo(blind.view.form), ZERO, **fine), None, "no truth to compare with"),
        (point, None, "not of structure and motion"),
    ):
        with pytest.raises(ValueError, match=message):
            figures.quantities(runs, labels)
    with pytest.raises(ValueError, match="3 are needed"):
        figures.quantities(run, axes=figures.compare(run).axes)


@pytest.mark.parametrize("observer", [ismo, ekf])
def test_the_distance_is_that_of_the_point_and_not_of_the_last_unknown(recording, observer):
    run = track(recording, observer(recording.view.form), ZERO, **fine)
    upper = figures.distance(run).axes[0]
    truth = next(line.get_ydata() for line in upper.lines if line.get_label() == "truth")
    np.testing.assert_allclose(truth, 1 / recording.view.inverse(recording.truth))
    assert (truth > 0).all()
