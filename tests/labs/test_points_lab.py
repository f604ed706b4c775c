"""The page of the lab of many points computes what Python does, and says the same of it."""

import warnings
from functools import cache

import numpy as np
import pytest
from lab_settings import as_array, run_in_node, whole_model
from points_settings import CASES, random_settings, run_of
from sample_sizes import sampled

from percept_obs.labs.points.lab import points_lab
from percept_obs.labs.points.texts import MOST_POINTS, STATES, form_of, state_of
from percept_obs.points.gramian import gramian
from percept_obs.points.manoeuvre import Manoeuvre


@pytest.fixture(scope="module")
def lab(always_compiled):
    return points_lab(state="body")


@pytest.fixture(scope="module")
def answers(lab, node):
    """What the page's engine says of each case, with the settings as Python completed them."""
    settings = {name: lab.check(case) for name, case in CASES.items()}
    found = run_in_node(node, lab, list(settings.values()))
    return {name: (settings[name], answer) for name, answer in zip(settings, found, strict=True)}


@pytest.fixture(scope="module")
def runs(answers):
    """Python's run of each case."""
    return cache(lambda case: run_of(answers[case][0]))


@pytest.mark.slow
@pytest.mark.node
@pytest.mark.parametrize("case", CASES)
def test_page_python_and_the_copied_code_agree_to_1e_9(answers, runs, case):
    settings, answer = answers[case]
    run, names = runs(case), {}
    assert_same_run(answer, run)
    assert_same_gramian(answer, settings, run.recording)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of directions that are never seen, as the user is to see it
        exec(answer["code"], names)
    copied = names["run"]
    assert copied.diverged_at == run.diverged_at
    if run.diverged_at is None:
        np.testing.assert_allclose(copied.state, run.state, rtol=0, atol=1e-9)


@pytest.mark.slow
@pytest.mark.node
def test_random_settings_agree(lab, node):
    tasks = [lab.check({**lab.settings, **random_settings(seed)}) for seed in range(sampled(4, 60))]
    for settings, answer in zip(tasks, run_in_node(node, lab, tasks), strict=True):
        run = run_of(settings)
        assert_same_run(answer, run)
        assert_same_gramian(answer, settings, run.recording)


def assert_same_run(answer, run, tolerance=1e-9):
    recording = run.recording
    np.testing.assert_allclose(as_array(answer["time"]), recording.time, rtol=0, atol=1e-12)
    truth, form = as_array(answer["truth"], recording.truth.shape[1]), run.observer.form
    np.testing.assert_allclose(truth, recording.truth, rtol=0, atol=tolerance)
    told, known = (points[..., :2] / points[..., 2:] for points in map(form.locate, (truth, recording.truth)))
    moved = (told - known).ravel()  # near the camera an image moves by more than its point
    np.testing.assert_allclose(as_array(answer["outputs"]) - moved, recording.outputs.ravel(), rtol=0, atol=1e-12)
    assert answer["divergedAt"] == run.diverged_at
    assert answer["summary"]["verdict"] == run.verdict()
    told, state = as_array(answer["estimate"]), run.state.ravel()
    there = np.isfinite(state)
    assert (np.isfinite(told) == there).all()
    size = np.fmax(1, np.abs(state[there]))
    growing = 1 if run.diverged_at is None else 1e6  # what grows without end multiplies the last digit as well
    np.testing.assert_allclose(told[there] / size, state[there] / size, rtol=0, atol=growing * tolerance)
    if run.diverged_at is None and run.deviation[run.time >= run.time[-1] / 3].min() > 1e-9:
        assert answer["rate"] == pytest.approx(run.decay_rate(run.time[-1] / 3), abs=1e-7)


def assert_same_gramian(answer, settings, recording):
    found = gramian(recording, min(settings["window"], recording.time[-1]))
    told = answer["gramian"]
    at = np.searchsorted(found.time, np.array(told["time"]) - 1e-9)
    np.testing.assert_allclose(told["time"], found.time[at], rtol=0, atol=1e-12)
    largest = found.eigenvalues[at, -1]
    scale = max(found.eigenvalues[:, -1].max(), 1e-300)
    np.testing.assert_allclose(as_array(told["largest"]), largest, rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(as_array(told["smallest"]), found.smallest[at], rtol=0, atol=1e-9 * scale)
    assert found.weakest in at
    assert np.argmin(found.smallest) in at or found.smallest.min() < 1e-9 * scale
    said = answer["summary"]["gramian"]
    # of a whole subspace the last digits decide how it is spanned
    assert said.split(":")[0] == found.verdict().split(":")[0]
    if found.unseen().shape[1] <= 1:
        assert said == found.verdict()


@pytest.mark.slow
@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("points", [1, 3, MOST_POINTS])
def test_the_layouts_are_those_of_the_form(lab, state, points):
    """And each vector of three states is moved by itself, as the page takes it to be."""
    layout = whole_model(lab)["states"][state]["layouts"][points - 1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        form = form_of(state, points, Manoeuvre(0.3, 0.4, 0.5, (0.1, 0.2, 0.3)))
    assert tuple(layout["names"]) == form.names
    C = np.zeros((points, 3, form.states))
    owners = np.repeat(np.arange(points), np.diff(layout["begins"]))
    C[owners, layout["axes"], layout["states"]] = layout["entries"]
    np.testing.assert_array_equal(C, form.blocks)
    A, v = form.coefficients(0.7)
    there = np.zeros((form.states, form.states + 1), dtype=bool)
    there[layout["rows"], layout["columns"]] = True
    assert there[:, :-1][A[0] != 0].all()
    assert there[:, -1][v[0] != 0].all()
    columns = np.array(layout["columns"])
    inside = columns < form.states
    assert (columns[inside] // 3 == np.array(layout["rows"])[inside] // 3).all()


@pytest.mark.parametrize("state", STATES)
def test_the_state_has_the_points_at_their_places(state):
    places = [[0.1, 0.2, 3.0], [-0.5, 0.3, 2.5]]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        form = form_of(state, 2, Manoeuvre())
    np.testing.assert_allclose(form.locate(state_of(form, places)), places, atol=1e-12)


def test_points_without_a_word_on_hiding_are_not_hidden(lab):
    assert lab.check({"points": [[0.0, 0.0, 2.0]]})["hidden"] == [None]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({}, ["Inequality (15) holds throughout", "Theorem 3.4 guarantees that errors decay", "turns the rays"]),
        ({"weight": "riccati", "size": 0.01}, ["Inequality (15) fails", "it needs a given P that meets (15)"]),
        ({"input": 0.0, "turning": 0.2, "spin": 1.0}, ["the pair (C, A) is uniformly observable", "it needs (14)"]),
        ({"weight": "lyapunov", "decrease": 0.1}, ["P is not positive definite from|the smallest eigenvalue of P"]),
        ({"size": 0.001}, ["turns the rays"]),
        ({"period": 0.27, "window": 12.0}, ["guarantees that errors decay"]),
        ({"input": 0.0}, ["turns no ray of point 1"]),
    ],
)
def test_the_analysis_says_what_python_found(settings, words):
    lab = points_lab(**settings, duration=12.0)
    lab.summary = {"serial": 7}
    assert lab.analysis["serial"] == 7
    text = " ".join(lab.analysis["sentences"])
    assert all(any(part in text for part in choice.split("|")) for choice in words)
    assert (lab.analysis["bound"] is not None) == ("guarantees that errors decay" in text)


@pytest.mark.slow
def test_what_is_guaranteed_lies_below_what_is_measured(lab):
    lab.summary = {"serial": 1}
    assert 0 < lab.analysis["bound"] < lab.run().decay_rate(10, 30)


def test_the_lab_opens_with_what_a_camera_does_so_that_noise_is_felt():
    quiet = points_lab(duration=1.0, period=0.1, points=[[0.0, 1.2, 2.5]], window=0.5)
    noisy = points_lab(**{**quiet.settings, "noise": {"kind": "uniform", "size": 0.05}})
    assert quiet.settings["hold"] == "zero"
    assert not np.allclose(quiet.run().state, noisy.run().state, atol=1e-3)
