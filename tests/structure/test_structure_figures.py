"""The figure of structure and motion draws every unknown quantity, leaves gaps as gaps, and says all of it in words."""

from dataclasses import replace

import numpy as np
import pytest
from examples import BOTH

from percept_obs import figures, record, scenarios, track
from percept_obs.observers import ekf, ismo
from percept_obs.structure import StructureAndMotion, linear_view, seen_as
from percept_obs.structure.scenarios import chwa2019_experiment

ZERO = {"y1": 0.0, "y2": 0.0, "ybar3": 0.0}
fine = {"hold": "first", "step": 1e-3, "language": "python"}


def sliding(recording):
    return track(recording, ismo(recording.view.form), ZERO, **fine)


@pytest.fixture(scope="module")
def recording():
    return record(chwa2019_experiment("IV.A"), 1.5)


@pytest.fixture(scope="module")
def run(recording):
    return sliding(recording)


@pytest.fixture(scope="module")
def unguarded(recording):
    """Run whose estimates of the unknowns begin with the observer's start."""
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


def test_the_image_has_rows_of_its_own(recording, run):
    straight = linear_view(recording)
    kalman = track(straight, ekf(straight.view.form, noise_variance=1e-6, hidden_variance=100.0), **fine)
    figure = figures.quantities([run, kalman], ["sliding", "filter"], image=True)
    assert [ax.get_ylabel() for ax in figure.axes[:4]] == ["$y_{1}$", "$y_{2}$", "$y_{3}$ (1/m)", "$d_{s}$ (1/m)"]
    for ax, true in zip(figure.axes, (*recording.truth[-1, :2], 0.52), strict=False):
        for line in ax.lines:
            assert line.get_ydata()[-1] == pytest.approx(true, rel=2e-3)
    assert figure.text.startswith("Image coordinates, inverse depth and unknown quantities from 0 to 1.5 s")
    assert "y1: the truth, from 0.32 to" in figure.text
    assert "filter 10.4" in figure.text
    assert all(len(ax.lines) == 3 for ax in figure.axes)


def test_cases_stand_side_by_side_with_one_legend(run):
    other = record(chwa2019_experiment("V.B"), 1.5)
    figure = figures.cases({"IV.A": run, "V.B": [sliding(other)]}, ["sliding"])
    left, right = figure.axes[::2], figure.axes[1::2]
    assert [ax.get_title() for ax in (left[0], right[0])] == ["IV.A", "V.B"]
    assert [ax.get_ylabel() for ax in right] == ["$d_{s}$ (1/m)", "$v_{c3}$ (m/s)", "$v_{p1}$ (m/s)"]
    assert all(ax.get_legend() is None for ax in figure.axes)
    assert [text.get_text() for text in figure.figure.legends[0].get_texts()] == ["truth", "sliding"]
    for name, column in (("IV.A", left), ("V.B", right)):
        alone = figures.quantities(run if column is left else sliding(other), ["sliding"])
        assert f"{name}: {alone.text}" in figure.text


def test_cases_of_different_heights_are_refused(run):
    one = StructureAndMotion(("v_p3",), zero=("v_p1", "v_p2"), scale=10.4)
    recording = seen_as(run.recording, one, chwa2019_experiment("IV.A").motion, 10.4)
    for columns in ({}, {"no run": []}, {"three": run, "one": sliding(recording)}):
        with pytest.raises(ValueError, match="equally many unknown quantities are needed"):
            figures.cases(columns)


def test_what_does_not_belong_together_is_refused(recording, run):
    other = record(chwa2019_experiment("V.B"), 1.5)
    elsewhere = sliding(other)
    blind = seen_as(recording, recording.view, chwa2019_experiment("IV.A").motion)
    point = track(record(scenarios.ma2005_eq35(), 1), ismo(BOTH))
    for runs, labels, message in (
        ([], None, "a Run or several are needed"),
        ([run], ["a", "b"], "a list of 1 is needed"),
        ([run, elsewhere], None, "different unknowns or times"),
        (sliding(blind), None, "no truth to compare with"),
        (point, None, "not of structure and motion"),
    ):
        with pytest.raises(ValueError, match=message):
            figures.quantities(runs, labels)


@pytest.mark.parametrize("observer", [ismo, ekf])
def test_the_distance_is_that_of_the_point_and_not_of_the_last_unknown(recording, observer):
    run = track(recording, observer(recording.view.form), ZERO, **fine)
    upper = figures.distance(run).axes[0]
    truth = next(line.get_ydata() for line in upper.lines if line.get_label() == "truth")
    np.testing.assert_allclose(truth, 1 / recording.view.inverse(recording.truth))
    assert (truth > 0).all()
