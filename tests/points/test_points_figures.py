"""Figures of many points draw what was measured, leave gaps where nothing was seen, and say all of it in words."""

import numpy as np
import pytest

from percept_obs import Camera, Recording, figures, luenberger, record, track
from percept_obs.points.gramian import decay_bound, gramian
from percept_obs.points.scenarios import along_the_line_of_sight, moving_body

ERROR = np.array([0.3, -0.2, 0.5, 0.2, -0.1, 0.3])


@pytest.fixture(scope="module")
def recording():
    return record(moving_body(2), 8, Camera(0.05)).without(2, 3, 1)


@pytest.fixture(scope="module")
def run(recording):
    return track(recording, luenberger(recording.view), recording.truth[0] - ERROR)


def test_paths_have_gaps_where_a_point_is_hidden(recording, run):
    figure = figures.image_plane(run)
    (ax,) = figure.axes
    second = np.transpose(ax.lines[3].get_data())
    np.testing.assert_array_equal(np.isnan(second[:, 0]), ~recording.seen[:, 1])
    assert np.isfinite(np.transpose(ax.lines[4].get_data())).all(), "the estimate goes on"
    assert "Out of sight: point 2 for 12% of the time." in figure.text
    assert run.verdict() in figure.text
    alone = figures.image_plane(recording.without(0, 9, 1)).text
    assert "point 2 for 100% of the time" in alone
    assert "Estimates" not in alone


def test_the_error_is_drawn_with_its_fit_and_its_bound(run):
    whole = record(moving_body(1), 12, Camera(0.05))
    one = track(whole, luenberger(whole.view), whole.truth[0] - ERROR[:3], hold="exact")
    bound = decay_bound(whole, one.observer, 4)
    figure = figures.error_norm([one, run], ["one", "two"], bound, (2, 8))
    (ax,) = figure.axes
    np.testing.assert_array_equal(ax.lines[0].get_data(), [one.time, one.deviation])
    fit = np.log(ax.lines[1].get_ydata())
    assert (fit[0] - fit[-1]) / 6 == pytest.approx(one.decay_rate(2, 8))
    time, guaranteed = ax.lines[4].get_data()
    assert (np.interp(time, one.time, one.deviation) <= guaranteed * (1 + 1e-9)).all()
    assert f"decaying at {one.decay_rate(2, 8):.3g} per second" in figure.text
    assert f"guarantees {bound.rate:.2g} per second" in figure.text


def test_the_gramian_has_its_verdict(recording):
    both = [gramian(recording, 2), gramian(record(along_the_line_of_sight(), 8), 2)]
    figure = figures.gramian(both, ["body", "ray"])
    (ax,) = figure.axes
    np.testing.assert_allclose(ax.lines[0].get_ydata(), both[0].smallest)
    assert (ax.lines[2].get_ydata() > 0).all(), "round-off has no logarithm"
    for name, one in zip(("body", "ray"), both, strict=True):
        assert f"{name}: {one.verdict()}." in figure.text
    assert "2 s window" in figures.gramian(both[0]).text


def test_depth_errors_have_medians_and_count_what_is_behind_the_camera():
    figure = figures.depth_errors({"good": [0.01, 0.03, 0.02], "lost": [0.5, np.inf, np.inf]}, 2)
    (ax,) = figure.axes
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), [0.01, 0.03, 0.02])
    assert ax.lines[1].get_xdata()[0] == 0.02
    assert ax.get_xlim()[0] < 0.01
    assert np.max(ax.lines[2].get_xdata()) < ax.get_xlim()[1]
    assert "good: 3 sightings, median 2.0%, at most 3.0%." in figure.text
    assert "lost: 3 sightings, median inf%, 2 of them behind the camera." in figure.text


def test_bad_input_is_refused_in_words(recording, run):
    for call, message in (
        (lambda: figures.image_plane(3), "expected a Run or a Recording"),
        (lambda: figures.image_plane(recording.without(0, 9).without(0, 9, 1)), "no point is seen"),
        (lambda: figures.signals(run), "of one point; the recording shows"),
        (lambda: figures.error_norm([]), "a PointsRun or several are needed"),
        (lambda: figures.error_norm(3), "expected a PointsRun or a sequence"),
        (lambda: figures.error_norm(run, ["a", "b"]), "one for each curve"),
        (lambda: figures.error_norm(run, fitted=(9, 10)), "needs two finite positive ones"),
        (lambda: figures.scene(recording), "a scene is of one point"),
        (lambda: figures.settings_map(5), "expected an xarray.DataArray"),
        (lambda: figures.cases(5), "expected a mapping from text to a Run"),
        (lambda: figures.gramian([]), "a Gramian or several are needed"),
        (lambda: figures.gramian(3), "expected a Gramian or a sequence"),
        (lambda: figures.depth_errors({}, 2), "relative errors"),
        (lambda: figures.depth_errors({"a": []}, 2), "relative errors"),
        (lambda: figures.depth_errors({"a": [np.nan]}, 2), "without NaN"),
    ):
        with pytest.raises(ValueError, match=message):
            call()
    bare = Recording(recording.time, recording.outputs, ("y1", "y2"), recording.view, recording.view.motion)
    blind = track(bare, luenberger(recording.view))
    assert "True" not in figures.image_plane(blind).text
    with pytest.raises(ValueError, match="no truth"):
        figures.error_norm(blind)
