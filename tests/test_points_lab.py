"""The page of the lab of many points computes what Python does, and says the same of it."""

import numpy as np
import pytest
from points_settings import CASES, as_array, run_in_node

from percept_obs.labs.points_lab import points_lab, run_of
from percept_obs.points.gramian import gramian


@pytest.fixture(scope="module")
def lab():
    return points_lab()


@pytest.fixture(scope="module")
def answers(lab, node):
    """What the page's engine says of each case, with the settings as Python completed them."""
    settings = {name: lab.check(case) for name, case in CASES.items()}
    found = run_in_node(node, lab, list(settings.values()))
    return {name: (settings[name], answer) for name, answer in zip(settings, found, strict=True)}


@pytest.mark.node
@pytest.mark.parametrize("case", CASES)
def test_page_and_python_agree_to_1e_9(answers, case):
    settings, answer = answers[case]
    assert_same_run(answer, run_of(settings))
    assert_same_gramian(answer, settings, run_of(settings).recording)


def assert_same_run(answer, run, tolerance=1e-9):
    recording = run.recording
    np.testing.assert_allclose(as_array(answer["time"]), recording.time, rtol=0, atol=1e-12)
    np.testing.assert_allclose(as_array(answer["truth"]), recording.truth.ravel(), rtol=0, atol=1e-10)
    np.testing.assert_allclose(as_array(answer["outputs"]), recording.outputs.ravel(), rtol=0, atol=1e-10)
    assert answer["divergedAt"] == run.diverged_at
    assert answer["summary"]["verdict"] == run.verdict()
    told, state = as_array(answer["estimate"]), run.state.ravel()
    there = np.isfinite(state)
    assert (np.isfinite(told) == there).all()
    size = np.fmax(1, np.abs(state[there]))
    growing = 1 if run.diverged_at is None else 1e6  # what grows without end multiplies the last digit as well
    np.testing.assert_allclose(told[there] / size, state[there] / size, rtol=0, atol=growing * tolerance)


def assert_same_gramian(answer, settings, recording):
    found = gramian(recording, min(settings["window"], recording.time[-1]))
    told = answer["gramian"]
    at = np.searchsorted(found.time, np.array(told["time"]) - 1e-9)
    scale = found.eigenvalues[:, -1].max()
    assert set(np.flatnonzero(np.diff(found.time) < -1)) == set()
    np.testing.assert_allclose(as_array(told["smallest"]), found.smallest[at], rtol=0, atol=1e-9 * max(scale, 1e-9))
    np.testing.assert_allclose(as_array(told["largest"]), found.eigenvalues[at, -1], rtol=1e-9, atol=1e-12)
