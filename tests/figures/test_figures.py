"""Figures draw a run's own numbers, leave gaps where there are none, and say in their text what a reader sees."""

import ast
import doctest
import html
import inspect
import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure as MatplotlibFigure
from sample_sizes import slow_but

from percept_obs import (
    Camera,
    PerspectiveSystem,
    Scenario,
    Uniform,
    affine,
    chained,
    check_consistency,
    ekf,
    figures,
    ibo,
    pinhole,
    plane,
    record,
    rigid,
    scenarios,
    smo,
    track,
    windowed,
)
from percept_obs.figures import curves, look
from percept_obs.studies.consistency import claimed_distance
from percept_obs.tracking.verdict import TOLERANCE

NOISY = Camera(noise=Uniform(0.01))
COARSE = Camera(period=0.05, noise=Uniform(0.01))
ZERO = (0, 0, 0)


def form(*measured, surface=None, motion=None):
    return PerspectiveSystem(motion or affine(), surface or pinhole()).measure(*measured)


def varying():
    """A rigid motion that changes with time."""
    motion = rigid(
        camera_angular_velocity=lambda t: (-0.1 * np.sin(t), -0.1 * np.cos(1.3 * t), -0.1),
        camera_velocity=lambda t: (np.cos(0.8 * t), np.sin(0.7 * t), 0.6 + 0.2 * np.sin(0.5 * t)),
        point_velocity=lambda t: (0, 0, 0.9),
    )
    recording = record(Scenario("varying", motion, (0.3, 0.2, 6), 12, pinhole()), camera=COARSE, seed=2)
    return track(recording, ibo(form("y1", "y2", motion=rigid())), ZERO)


def eq35(*measured, observer=ibo, surface=None, camera=COARSE, duration=20, **gains):
    recording = record(scenarios.ma2005_eq35(surface), duration, camera, seed=1)
    return track(recording, observer(form(*measured, surface=surface), **gains))


def without_truth():
    both = eq35("y1", "y2")
    return track(replace(both.recording, truth=None), both.observer, ZERO)


def of_y1(recording):
    return replace(recording, outputs=recording.outputs[:, :1], names=("y1",))


MAKERS = {
    "(35), both outputs": lambda: track(
        record(scenarios.ma2005_eq35(), camera=NOISY, seed=1), ibo(form("y1", "y2")), ZERO
    ),
    "(35), y1 alone": lambda: track(record(scenarios.ma2005_eq35(), camera=NOISY, seed=1), ibo(form("y1")), ZERO),
    "(36), y1 alone": lambda: track(record(scenarios.ma2005_eq36(), camera=COARSE, seed=1), ibo(form("y1")), ZERO),
    "varying": varying,
    "dropouts": lambda: eq35("y1", "y2", camera=replace(COARSE, dropout=0.3)),
    "without truth": without_truth,
    "diverged": lambda: eq35("y1", "y2", gain=1e6, bound=1e300),
    "diverged, without truth": lambda: track(
        replace(eq35("y1").recording, truth=None), ibo(form("y1"), gain=1e6, bound=1e300)
    ),
    "chained": lambda: eq35("y1", "y2", surface=chained()),
    "plane": lambda: eq35("y1", "y2", surface=plane((0.1, 0.2, 1))),
    "filter": lambda: eq35("y1", observer=ekf),
    "filter, without truth": lambda: track(
        replace(eq35("y1", "y2").recording, truth=None), ekf(form("y1", "y2"), noise_variance=1e-3)
    ),
    "three outputs": lambda: eq35("y1", "y2", "y3", surface=plane((0.1, 0.2, 1), outputs=3)),
}
FEW = ("(36), y1 alone", "dropouts", "diverged, without truth")
each_run = pytest.mark.parametrize("name", slow_but(*FEW, among=MAKERS))
each_flat_run = pytest.mark.parametrize("name", slow_but(*FEW, among=[n for n in MAKERS if n != "three outputs"]))


@pytest.fixture(scope="module", autouse=True)
def in_python():
    """Short runs are over before numba has compiled anything beside them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("percept_obs.compile.kernels.find_spec", lambda name: None)
        yield


@pytest.fixture(scope="module")
def runs():
    """A run by its name, tracked once."""
    known = {}

    def run(name):
        if name not in known:
            known[name] = MAKERS[name]()
        return known[name]

    return run


def lines(ax, label):
    """Coordinates of the lines that the legend calls by a name, one array of columns each."""
    return [np.array(line.get_data()) for line in ax.lines if line.get_label() == label]


def line(ax, label):
    (found,) = lines(ax, label)
    return found


def faint(ax):
    """Values of the lines without a name: every error, under the bold curves."""
    return [line.get_ydata() for line in ax.lines if line.get_alpha() and line.get_label().startswith("_")]


def paint(figure, layout=False):
    """Draw, so that what matplotlib warns of comes to light; finding a layout takes most of the time."""
    if not layout:
        figure.figure.set_layout_engine("none")
    figure.figure.draw_without_rendering()


# ---- signals


@pytest.mark.slow
@pytest.mark.parametrize("name", MAKERS)
def test_signals_draws_samples_truth_and_estimate_of_every_coordinate(runs, name):
    run = runs(name)
    figure = figures.signals(run)
    coordinates = [symbol.name for symbol in run.recording.view.coordinates]
    assert len(figure.axes) == len(coordinates) + 1
    letter = {"chained": "Y", "plane": "l", "three outputs": "l"}.get(name, "Z")
    assert figure.axes[-2].get_ylabel() == f"$y_{{{len(coordinates)}}} = 1/{letter}$ (1/m)"
    for column, (coordinate, ax) in enumerate(zip(coordinates, figure.axes, strict=False)):
        np.testing.assert_array_equal(line(ax, "estimate"), [run.time, run.estimate[:, column]])
        if coordinate in run.observer.form.measured:
            samples = run.recording.outputs[:, run.recording.names.index(coordinate)]
            np.testing.assert_array_equal(line(ax, "samples")[1], samples)
        else:
            assert not lines(ax, "samples")
        if run.recording.truth is None:
            assert not lines(ax, "truth")
        else:
            np.testing.assert_array_equal(line(ax, "truth")[1], run.truth[:, column])
    paint(figure)


@pytest.mark.parametrize("name", ["(35), both outputs", "(36), y1 alone", "dropouts", "without truth"])
def test_signals_draws_the_errors_or_innovations_on_a_logarithmic_axis(runs, name):
    run = runs(name)
    last = figures.signals(run).axes[-1]
    assert last.get_yscale() == "log"
    if run.recording.truth is None:
        np.testing.assert_array_equal(faint(last), np.abs(run.innovation).T)
        assert last.get_ylabel() == "|innovation|"
        return
    judged = np.where(np.isinf(run.relative_error), np.nan, run.relative_error)
    np.testing.assert_array_equal(faint(last), [*np.abs(run.error).T, judged])
    (level,) = (line.get_ydata()[0] for line in last.lines if list(line.get_xdata()) == [0, 1])
    assert level == TOLERANCE  # the dotted line is the tolerance of the judged error, the black one


def test_bold_errors_are_root_mean_squares():
    values = np.array([3.0, 4.0, np.nan, 0.0, 1e200])
    root = curves._root_mean_square(values, 3)
    np.testing.assert_allclose(root, [np.sqrt(12.5), np.sqrt(12.5), np.nan, 1e200 / np.sqrt(2), 1e200 / np.sqrt(2)])


def test_signals_marks_every_reset_and_counts_them(runs):
    run = runs("(35), y1 alone")
    figure = figures.signals(run)
    for ax in figure.axes[::3]:
        (ticks,) = (collection for collection in ax.collections if collection.get_label() == "reset")
        np.testing.assert_array_equal([segment[0, 0] for segment in ticks.get_segments()], run.resets)
    assert f"reset {len(run.resets)} times" in figure.text
    assert "Outside the axis" in figure.text


def test_signals_ends_the_estimate_where_it_diverged_and_says_when(runs):
    run = runs("diverged")
    figure = figures.signals(run)
    assert [text.get_text() for text in figure.axes[-1].texts] == [f"diverged at {run.diverged_at:.3g} s"]
    assert f"Diverged at {run.diverged_at:.3g} s" in figure.text
    missing = np.isnan(line(figure.axes[-2], "estimate")[1]).sum()
    assert missing == np.isnan(run.estimate[:, -1]).sum() > 0
    assert f"{missing} estimates are missing" in figure.text
    assert figure.axes[2].get_ylim()[1] < 2  # what goes before the divergence does not squeeze the truth


def test_the_text_has_ranges_settling_time_error_levels_and_lost_samples(runs):
    run = runs("(35), both outputs")
    text = figures.signals(run).text
    assert run.verdict()[1:] in text
    assert f"within 0.05 after {run.settling_time(0.05, 'y3'):.3g} s" in run.verdict(0.05, "y3")
    assert f"true y1 is from {run.truth[:, 0].min():.3g} to {run.truth[:, 0].max():.3g}" in text
    assert f"{run.rms(40.01, 80, 'y3'):.2g} (y3)" in text
    lost = runs("dropouts")
    gaps = int(np.isnan(lost.recording.outputs).any(axis=1).sum())
    assert f"{gaps} of {len(lost.time)} samples were lost" in figures.signals(lost).text


# ---- what an observer claims


def bands(ax):
    """Times, lower and upper ends of the bands of two claimed standard deviations, clipped at the top of the axes."""
    for collection in ax.collections:
        if collection.get_label() in (curves.CLAIM, "_claim"):
            ends = np.vstack([path.vertices for path in collection.get_paths()])
            time = np.unique(ends[:, 0])
            yield time, *(np.array([pick(ends[ends[:, 0] == t, 1]) for t in time]) for pick in (np.min, np.max))


@pytest.mark.parametrize("name", ["filter", "filter, without truth"])
def test_the_band_is_two_standard_deviations_of_the_covariance(runs, name):
    run = runs(name)
    figure = figures.signals(run)
    for column, ax in enumerate(figure.axes[:3]):
        ((time, low, high),) = bands(ax)
        sigma = np.sqrt(run.covariance[:, column, column])
        np.testing.assert_array_equal(time, run.time)
        np.testing.assert_allclose(low, run.estimate[:, column] - 2 * sigma)
        np.testing.assert_allclose(high, run.estimate[:, column] + 2 * sigma)
        words = f"is from {low[-1]:.3g} to {high[-1]:.3g} at the end"
        if run.recording.truth is not None:
            held = np.abs(run.error[:, column]) <= 2 * sigma
            words += f" and holds the truth in {100 * held.mean():.0f} % of the samples"
        assert f"The band of two claimed standard deviations {words}." in figure.text
    paint(figure)


def test_compare_draws_the_band_of_those_that_claim_one(runs):
    run = runs("filter")
    figure = figures.runs_over_time([eq35("y1"), run, run])
    (_, low, high), again = bands(figure.axes[0])
    np.testing.assert_allclose((high - low) / 4, np.sqrt(run.covariance[:, 2, 2]))
    np.testing.assert_array_equal(again[2], high)
    assert sum(name == curves.CLAIM for name in figure.axes[0].get_legend_handles_labels()[1]) == 1
    assert figure.text.count("The band of two claimed standard deviations") == 2
    assert figure.text.index("extended Kalman") < figure.text.index("The band of")


def test_the_band_of_the_distance_is_open_where_the_inverse_reaches_zero(runs):
    run = runs("filter")
    figure = figures.distance(run)
    ((time, low, high),) = bands(figure.axes[0])
    nearest, farthest = claimed_distance(run)
    is_open = np.isposinf(farthest)
    assert 0 < is_open.sum() < len(is_open)
    np.testing.assert_allclose(low[~is_open], nearest[~is_open])
    np.testing.assert_allclose(high[~is_open], farthest[~is_open])
    np.testing.assert_allclose(high[is_open], np.maximum(figure.axes[0].get_ylim()[1], nearest[is_open]))
    assert f"In {is_open.sum()} of {len(time)} samples it has no upper end" in figure.text
    held = (nearest <= 1 / run.truth[:, 2]) & (1 / run.truth[:, 2] <= farthest)
    assert f"holds the truth in {100 * held.mean():.0f} % of the samples" in figure.text
    paint(figure)


def test_without_a_claim_there_is_no_band(runs):
    for draw in (figures.signals, figures.distance, figures.runs_over_time):
        figure = draw(runs("(35), both outputs"))
        assert not list(bands(figure.axes[0]))
        assert "claimed" not in figure.text


def test_consistency_is_drawn_with_its_interval_and_verdict(runs):
    found = check_consistency(runs("filter"), samples=40)
    figure = figures.consistency(found)
    (ax,) = figure.axes
    np.testing.assert_array_equal(line(ax, "mean of 40 samples"), [found.average_time, found.averages])
    np.testing.assert_array_equal(line(ax, "samples"), [found.time, found.nis])
    assert set(line(ax, "expected mean")[1]) == {1}
    (interval,) = (patch for patch in ax.patches if patch.get_label() == "95 % interval")
    low, high = found.interval(40)
    np.testing.assert_allclose([interval.get_y(), interval.get_y() + interval.get_height()], [low, high])
    assert found.verdict()[1:] in figure.text
    outside = (found.nis > ax.get_ylim()[1]).sum()
    assert f"Outside the axis: {outside} of the normalised innovations" in figure.text
    paint(figure)


# ---- image plane


@each_flat_run
def test_the_image_has_the_path_its_ends_and_the_estimate(runs, name):
    run = runs(name)
    figure = figures.image_plane(run)
    (ax,) = figure.axes
    known = run.recording.truth is not None
    path = run.truth[:, :2] if known else run.recording.outputs[:, :2]
    if known or path.shape[1] == 2:
        np.testing.assert_array_equal(line(ax, "truth" if known else "samples"), path.T)
        np.testing.assert_array_equal(line(ax, "start").ravel(), path[0])
        np.testing.assert_array_equal(line(ax, "end").ravel(), path[-1])
    np.testing.assert_array_equal(line(ax, "estimate"), run.estimate[:, :2].T)
    assert ax.get_aspect() == 1
    paint(figure)


@pytest.mark.parametrize(
    ("name", "place", "radius"),
    [
        ("(35), both outputs", (5 / 3, 5 / 6), 0.1 / 0.3),
        ("without truth", (5 / 3, 5 / 6), 0.1 / 0.3),
        ("chained", (2, 1.2), 0.1 / 0.25),
        ("plane", (1.25, 0.625), 0.1 / 0.4),
    ],
)
def test_the_disk_of_small_w_lies_around_the_focus_of_expansion(runs, name, place, radius):
    figure = figures.image_plane(runs(name))
    (ax,) = figure.axes
    (disk,) = ax.patches
    np.testing.assert_allclose(line(ax, "focus of expansion").ravel(), place)
    np.testing.assert_allclose([*disk.center, disk.radius], [*place, radius])
    assert disk.get_label() == "$|w| < 0.1$"
    assert f"at ({place[0]:.3g}, {place[1]:.3g})" in figure.text
    assert f"radius {radius:.3g}; the path does not enter it" in figure.text


def test_the_text_has_the_closest_approach_and_how_many_samples_are_in_the_disk(runs):
    recording = runs("(35), both outputs").recording
    figure = figures.image_plane(recording, threshold=0.5)
    distances = np.hypot(*(recording.truth[:, :2] - [5 / 3, 5 / 6]).T)
    assert figure.axes[0].patches[0].radius == pytest.approx(0.5 / 0.3)
    assert "closest approach 0.832 at 16.4 s" in figure.text
    assert f"{(distances < 0.5 / 0.3).sum()} of 8001 samples lie in it" in figure.text


def test_a_far_focus_of_expansion_is_pointed_at_from_the_edge(runs):
    run = runs("(36), y1 alone")
    figure = figures.image_plane(run)
    (ax,) = figure.axes
    pointer = line(ax, "focus of expansion (outside)").ravel()
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    assert left < pointer[0] < right < 5 / 3
    assert low < pointer[1] < high
    towards, expected = pointer - [(left + right) / 2, (low + high) / 2], [5 / 3, 5 / 6] - pointer
    assert np.cross([*towards, 0], [*expected, 0])[2] == pytest.approx(0, abs=1e-3)
    assert "at (1.67, 0.833)" in figure.text
    assert "outside the picture" in figure.text


def test_a_moving_focus_of_expansion_is_drawn_as_its_path_and_without_a_disk(runs):
    run = runs("varying")
    figure = figures.image_plane(run)
    (ax,) = figure.axes
    known = run.recording.motion.known(run.time)
    velocity = known[:, 6:9] - known[:, 3:6]
    (path,) = (points for points in lines(ax, "focus of expansion (outside)") if points.shape[1] == len(run.time))
    np.testing.assert_allclose(path, (velocity[:, :2] / velocity[:, 2:]).T)
    assert not ax.patches
    assert "focus of expansion moves" in figure.text


def test_a_wide_picture_makes_a_low_figure(runs):
    wide = record(
        Scenario("wide", affine(np.zeros((3, 3)), (1, 0, 0)), (-2, 0.5, 5), 4, pinhole()), camera=Camera(period=0.05)
    )
    assert figures.image_plane(wide).figure.get_figheight() < 4.2
    assert figures.image_plane(runs("(35), both outputs")).figure.get_figheight() == 5.2
    given = MatplotlibFigure(figsize=(6, 6))
    figures.image_plane(wide, ax=given.subplots())
    assert given.get_figheight() == 6


@pytest.mark.parametrize("translation", [(1, 0.2, 0), (0, 0, 0)])
def test_without_a_focus_of_expansion_the_figure_says_so(translation):
    motion = affine(np.diag([0.1, 0, 0]), translation)
    figure = figures.image_plane(record(Scenario("aside", motion, (0.5, 0, 5), 5, pinhole()), camera=COARSE))
    assert "no focus of expansion" in figure.text
    assert not figure.axes[0].patches
    paint(figure)


def test_with_one_output_the_line_without_w_is_drawn():
    motion = affine([[0, 0.4, 0], [0, 0, 0.1], [0, 0.2, 0]], (0.6, 0.1, 0.3))
    recording = record(Scenario("blind", motion, (5, 0.5, 3), 2, pinhole()), camera=COARSE)
    run = track(of_y1(recording), ibo(form("y1")))
    figure = figures.image_plane(run)
    np.testing.assert_allclose(line(figure.axes[0], "$w = 0$")[0], [2, 2])
    assert "w vanishes at y1 = 2" in figure.text


def test_with_one_output_w_may_vanish_nowhere(runs):
    figure = figures.image_plane(runs("(35), y1 alone"))
    assert not figure.axes[0].patches
    assert "w vanishes nowhere" in figure.text


# ---- scene


def places(ax, label):
    (found,) = (line for line in ax.lines if line.get_label() == label)
    return np.array(found.get_data_3d())


@each_run
def test_the_scene_has_the_true_places_and_the_credible_estimates(runs, name):
    run = runs(name)
    figure = figures.scene(run, far=2)
    (ax,) = figure.axes
    drawn = places(ax, "estimate")
    if run.recording.truth is not None:
        np.testing.assert_array_equal(places(ax, "truth"), run.recording.points.T[[2, 0, 1]])
        credible = run.distance < 2 / run.truth[:, -1]
        np.testing.assert_array_equal(drawn, np.where(credible, run.points.T[[2, 0, 1]], np.nan))
    left_out = int(np.isnan(drawn[0]).sum())
    assert (f"Left out: {left_out} of {len(run.time)} estimates" in figure.text) == (left_out > 0)
    paint(figure)


def test_the_scene_has_the_viewing_ray_to_the_end_and_the_closest_approach(runs):
    run = runs("varying")
    figure = figures.scene(run)
    (ax,) = figure.axes
    end = run.recording.points[-1]
    np.testing.assert_allclose(places(ax, "viewing ray"), np.array([(0, 0, 0), end]).T[[2, 0, 1]])
    np.testing.assert_array_equal(places(ax, "end").ravel(), end[[2, 0, 1]])
    np.testing.assert_array_equal(places(ax, "camera")[:, 0], ZERO)
    assert places(ax, "camera")[0].max() > 0  # it opens along Z
    assert f"within {np.linalg.norm(run.recording.points, axis=1).min():.3g} m" in figure.text


def test_the_scene_has_one_scale(runs):
    (ax,) = figures.scene(runs("plane")).axes
    sides = np.ptp([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()], axis=1)
    np.testing.assert_allclose(ax.get_box_aspect() / sides, (ax.get_box_aspect() / sides)[0])


# ---- several runs


def test_compare_draws_the_truth_once_and_every_estimate(runs):
    both = runs("(35), both outputs")
    some = [both, runs("(35), y1 alone"), track(both.recording, smo(form("y1", "y2")), ZERO)]
    figure = figures.runs_over_time(some)
    upper, lower = figure.axes
    np.testing.assert_array_equal(line(upper, "truth"), [both.time, both.truth[:, 2]])
    names = ["identifier-based (y1, y2)", "identifier-based (y1)", "sliding mode (y1, y2)"]
    for name, run, error in zip(names, some, faint(lower), strict=True):
        np.testing.assert_array_equal(line(upper, name)[1], run.estimate[:, 2])
        np.testing.assert_array_equal(error, np.abs(run.error[:, 2]))
        assert f"{name}: {run.verdict().capitalize()[:9]}" in figure.text
    paint(figure)


def test_curves_differ_in_line_marker_and_colour():
    looks = [look.style(number) for number in range(4)]
    for key in ("linestyle", "marker", "color"):
        assert len({str(look[key]) for look in looks}) == 4
    every = [look.style(number) for number in range(28)]
    assert len({(str(look["linestyle"]), look["marker"]) for look in every}) == 28  # without any colour


def test_colours_are_those_of_okabe_and_ito():
    palette = {"#000000", "#e69f00", "#56b4e9", "#009e73", "#0072b2", "#d55e00", "#cc79a7"}
    assert {to_hex(c) for c in (look.BLACK, look.SKY, *look.COLOURS)} <= palette


def test_compare_names_what_differs_and_when_a_run_diverged(runs):
    some = [eq35("y1", "y2"), eq35("y1", "y2", gain=3), runs("diverged")]
    figure = figures.runs_over_time(some, coordinate="y1")
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert labels[1:] == [
        "identifier-based (y1, y2), gain 10, bound 10",
        "identifier-based (y1, y2), gain 3, bound 10",
        f"identifier-based (y1, y2), gain 1e+06, bound 1e+300, diverged at {some[2].diverged_at:.3g} s",
    ]
    assert figure.axes[0].get_ylabel() == "$y_{1}$"
    assert f"Diverged at {some[2].diverged_at:.3g} s" in figure.text
    paint(figure, layout=True)


def test_compare_takes_runs_with_and_without_noise(runs):
    clean = record(scenarios.ma2005_eq35(), camera=Camera(), seed=1)
    some = [runs("(35), both outputs"), track(clean, ibo(form("y1", "y2")), ZERO)]
    figure = figures.runs_over_time(some, ["noisy", "clean"])
    assert figure.axes[0].get_legend_handles_labels()[1] == ["truth", "noisy", "clean"]
    assert "clean: Converged" in figure.text
    numbered = figures.runs_over_time(some).axes[0].get_legend_handles_labels()[1]
    assert numbered[1:] == ["identifier-based (y1, y2) [1]", "identifier-based (y1, y2) [2]"]


# ---- distance


@each_run
def test_distance_is_in_metres_with_gaps_behind_the_camera(runs, name):
    run = runs(name)
    figure = figures.distance(run, labels=["estimate"])
    assert len(figure.axes) == 1 + (run.recording.truth is not None)
    (drawn,) = (curve for curve in figure.axes[0].lines if curve.get_label().startswith("estimate"))
    values = drawn.get_ydata()
    seen = run.estimate[:, -1] > 0
    np.testing.assert_allclose(values[seen], 1 / run.estimate[seen, -1])
    assert np.isnan(values[~seen]).all()
    assert (f"{(~seen).sum()} of {len(run.time)} estimates are not in front" in figure.text) == (not seen.all())
    if run.recording.truth is not None:
        np.testing.assert_allclose(line(figure.axes[0], "truth")[1], 1 / run.truth[:, -1])
    paint(figure)


def test_another_measurement_of_the_distance_is_drawn_and_may_be_the_reference(runs):
    run = runs("without truth")
    stereo = np.linspace(2, 5, len(run.time))
    measured = replace(run, recording=replace(run.recording, distances={"stereo": stereo}))
    figure = figures.distance(measured)
    np.testing.assert_array_equal(line(figure.axes[0], "stereo")[1], stereo)
    relative = 100 * np.abs(run.distance / stereo - 1)
    np.testing.assert_allclose(faint(figure.axes[1])[0], np.where(np.isfinite(relative), relative, np.nan))
    assert "By the stereo it is from 2 to 5 m" in figure.text
    assert f"median relative error is {np.median(relative[len(stereo) // 2 :]):.2g} %" in figure.text


# ---- excitation


def test_excitation_is_drawn_with_its_least_value(runs):
    recording = runs("(35), both outputs").recording
    some = [windowed(form(*names), recording) for names in (("y1", "y2"), ("y1",))]
    figure = figures.excitation(some, ["both", "y1"])
    (ax,) = figure.axes
    assert ax.get_yscale() == "log"
    for name, one in zip(("both", "y1"), some, strict=True):
        np.testing.assert_array_equal(line(ax, name), [one.time, one.smallest])
        assert f"{name}: the least is {one.least:.3g}" in figure.text
    assert [text.get_text() for text in ax.texts] == [f"least {one.least:.2g}" for one in some]
    assert ax.get_xlabel() == "end of the 10 s window (s)"
    paint(figure)


def replaced(one, smallest):
    """The excitation with other smallest eigenvalues."""
    return replace(one, matrices=smallest[:, None, None] * np.eye(one.matrices.shape[1]))


def test_round_off_is_clipped_and_unknown_windows_are_gaps_and_both_are_counted(runs):
    one = windowed(form("y1"), runs("(35), both outputs").recording)
    late = one.time > 70
    figure = figures.excitation(replaced(one, smallest=np.where(late, -1e-20, one.smallest)))
    assert figure.axes[0].lines[0].get_ydata().min() == 1e-16
    assert f"{late.sum()} values below 1e-16" in figure.text
    paint(figure)
    figure = figures.excitation(replaced(one, smallest=np.where(late, np.nan, one.smallest)))
    np.testing.assert_array_equal(np.isnan(figure.axes[0].lines[0].get_ydata()), late)
    assert f"Unknown: {late.sum()} of {len(late)} windows" in figure.text
    with pytest.raises(ValueError, match="no finite value"):
        figures.excitation(replaced(one, smallest=np.full(len(late), np.nan)))


# ---- laws of all figures

LABELS = {
    "bound_map": ["$y_{1}$", "$y_{2}$"],
    "camera_ways": ["to the right (m)", "$y_{1}$", "ahead (m)", "$y_{2}$"],
    "cases": ["time (s)", "$d_{s}$ (1/m)", "$v_{c2}$ (m/s)", "$v_{c3}$ (m/s)"],
    "chatter": ["step of integration (s)", "time (s)", "rms error of $y_{3}$ (1/m)", "step that the solver took (s)"],
    "comparison": ["settling time (s)", "rms error of 1/distance (1/m)"],
    "consistency": ["time (s)", "normalised innovation"],
    "depth_errors": ["relative error of the depth after 2 s; the dots are medians"],
    "distance": ["time (s)", "depth $Z$ (m)", "relative error (%)"],
    "efficiencies": ["settling time (s)", "error / bound"],
    "entries": ["time (s)", "depth moves by (%)"],
    "error_norm": ["time (s)", "norm of the error $|\\rho|$"],
    "excitation": ["end of the 5 s window (s)", r"smallest eigenvalue of $\int w\,w^{\mathsf{T}}dt$"],
    "fields": ["to the right (°)", "up (°)"],
    "gramian": ["beginning of the window (s)", "smallest eigenvalue"],
    "image_plane": ["$y_{1}$", "$y_{2}$"],
    "observability": ["time (s)", "instant", "1 s windows", "derivatives", "std. deviation"],
    "quantities": ["time (s)", "$d_{s}$ (1/m)", "$v_{c2}$ (m/s)", "$v_{c3}$ (m/s)"],
    "runs_over_time": ["time (s)", "$y_{3} = 1/Z$ (1/m)", "|error of $y_{3}$|"],
    "causes": ["wrong by so many times the usual size of the mistake"],
    "scene": ["$Z$ (m)", "$X$ (m)"],
    "servoing": ["time (s)", "$|y - y^{*}|$", "|error of the depth|", "$|w|^2$ (m$^2$/s$^2$)"],
    "settings_map": ["noise", "gain"],
    "signals": ["time (s)", "$y_{1}$", "$y_{2}$", "$y_{3} = 1/Z$ (1/m)", "|error|"],
    "velocities": ["time (s)", "velocity along x (m/s)"],
}
"""Labels of the axes in each figure's example: first along x, then along y."""


def example(name):
    """Return a function that draws a figure as the last line of its docstring's example does."""
    *before, last = doctest.DocTestParser().get_examples(getattr(figures, name).__doc__)
    values = {}
    for line in before:
        exec(line.source, values)
    (call,) = (
        node
        for node in ast.walk(ast.parse(last.source))
        if isinstance(node, ast.Call) and ast.unparse(node.func) == f"figures.{name}"
    )
    text = ast.unparse(call).removesuffix(")")
    return lambda **axes: eval(f"{text}, **axes)", values | {"axes": axes})


QUICK = ("consistency", "distance", "scene", "signals")
"""Figures that are quick to draw; the others are drawn among the slow tests."""


@pytest.mark.parametrize("name", slow_but(*QUICK, among=figures.__all__[1:]))
def test_each_figure_has_a_text_and_labels_with_units_and_draws_on_given_axes(name):
    import matplotlib.pyplot as plt

    draw, known = example(name), plt.get_fignums()
    figure = draw()
    figure.figure.set_layout_engine("none")  # finding a layout takes most of the time
    assert [t for ax in figure.axes if (t := ax.get_xlabel())] + [
        t for ax in figure.axes if (t := ax.get_ylabel())
    ] == LABELS[name]
    shown = figure._repr_html_()
    assert f'<img alt="{html.escape(figure.text)}"' in shown
    assert "data:image/png;base64,iVBOR" in shown
    assert "max-width: 100%" in shown
    assert figure.text in repr(figure)
    assert figure.text.endswith(".")
    parameters = inspect.signature(getattr(figures, name)).parameters
    if "axes" in parameters:
        given = MatplotlibFigure().subplots(len(figure.axes), squeeze=False).ravel()
        again = draw(axes=given)
        assert again.axes == tuple(given)
        with pytest.raises(ValueError, match=f"{len(given) + 1} axes; {len(given)} are needed"):
            draw(axes=MatplotlibFigure().subplots(len(given) + 1))
    elif "ax" in parameters:
        ax = MatplotlibFigure().add_subplot(projection=figure.axes[0].name)
        again = draw(ax=ax)
        assert again.axes == (ax,)
    else:
        again = draw()
    assert again.text == figure.text
    assert plt.get_fignums() == known


# ---- pictures


def test_pyplots_axes_are_shown_once(runs):
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots()
    drawn = figures.image_plane(runs("chained"), ax=ax)
    assert drawn.figure is figure
    assert drawn.axes == (ax,)
    drawn._repr_html_()
    assert not plt.fignum_exists(figure.number)


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_saved_pictures_keep_their_text(runs, tmp_path, ending):
    figure = figures.excitation(windowed(form("y1"), runs("(35), both outputs").recording, 5))
    path = tmp_path / f"figure.{ending}"
    figure.save(path)
    assert path.stat().st_size > 1000
    if ending != "pdf":  # which compresses it
        assert figure.text.encode() in path.read_bytes()


# ---- bad input


@pytest.mark.parametrize(
    ("draw", "complaint"),
    [
        (lambda run: figures.signals(run("plane").recording), "expected a Run"),
        (lambda run: figures.signals([run("plane"), run("plane")]), "expected a Run"),
        (lambda run: figures.image_plane(run("three outputs")), "has 3 image coordinates"),
        (lambda run: figures.image_plane(run("diverged, without truth").recording, -1), "threshold is -1"),
        (lambda run: figures.image_plane("run"), "expected a Run or a Recording"),
        (lambda run: figures.image_plane(of_y1(run("without truth").recording)), "only y1 was recorded"),
        (lambda run: figures.scene(run("without truth").recording), "no truth"),
        (lambda run: figures.scene(run("plane"), far=1), "more than 1"),
        (lambda run: figures.scene(run("plane"), ax=MatplotlibFigure().add_subplot()), "flat"),
        (lambda run: figures.runs_over_time([]), "a Run or several are needed"),
        (lambda run: figures.runs_over_time(run("plane").recording), "expected a Run or a sequence"),
        (lambda run: figures.runs_over_time(run("without truth")), "no truth to compare"),
        (lambda run: figures.runs_over_time(run("plane"), coordinate="y4"), "no coordinate 'y4'; there are y1, y2, y3"),
        (
            lambda run: figures.runs_over_time(run("plane"), labels="one"),
            "labels is the text 'one'; expected a sequence",
        ),
        (lambda run: figures.runs_over_time([run("plane"), run("chained")]), "their surfaces and truths differ"),
        (lambda run: figures.runs_over_time([run("dropouts"), run("varying")]), "their times and truths differ"),
        (lambda run: figures.distance([run("dropouts"), run("without truth")]), "their truths differ"),
        (lambda run: figures.distance(run("plane"), reference="stereo"), "no reference 'stereo'; there are truth"),
        (lambda run: figures.excitation([]), "an Excitation"),
        (lambda run: figures.excitation(run("plane")), "an Excitation"),
        (lambda run: figures.consistency(run("filter")), "expected a Consistency"),
    ],
)
def test_bad_input_is_refused_in_words(runs, draw, complaint):
    with pytest.raises(ValueError, match=re.escape(complaint)):
        draw(runs)


def test_an_axis_around_what_stays_shows_what_comes_near_it():
    low, high = curves.limits([0.375] * 3, [0.25, 0.7, 40])
    assert low < 0.25 < 0.7 < high < 1
