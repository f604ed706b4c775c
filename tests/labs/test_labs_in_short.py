"""The page's engine and Python agree over a second or less of a point; longer runs are compared where labs are."""

import pytest
from lab_settings import NOISY, run_in_node, runs
from test_lab_engine import assert_same_recording, assert_same_run

from percept_obs.labs import observer_lab, structure_lab
from percept_obs.observability import windowed

pytestmark = pytest.mark.node

SHORT = {"duration": 0.5, "period": 0.04, "window": 0.2}
BEHIND = {"duration": 3.0, "b": [0.5, 0.25, -2.9]}
OF_A_POINT = [
    {"noise": NOISY, "dropout": 0.2, "seed": 4, "hold": "first"},
    {"observers": ["extended_kalman"], "hold": "exact"},
    {"observers": ["extended_kalman"], "noise": {"kind": "gaussian", "size": 0.005}, "dropout": 0.1, "seed": 9},
    {"start": {"mode": "chosen", "values": [0.2, 0.7, 1.0]}, "believed": {"A": [[0.1] * 3] * 3, "b": [0.1, 0.2, 0.3]}},
    {"start": {"mode": "zero", "values": [0.0] * 3}, "gains": {"identifier_based": {"bound": 2.0}}},
    {"gains": {"identifier_based": {"lyapunov": 5, "bound": 1e200}}, "duration": 2.0},
    BEHIND,
]


def test_of_a_point(node):
    lab = observer_lab("ma2005_eq35")
    tasks = [lab.check({**SHORT, **task}) for task in OF_A_POINT]
    for settings, answer in zip(tasks, run_in_node(node, lab, tasks), strict=True):
        for name, run in runs(settings).items():
            assert_same_recording(answer, run.recording)
            assert_same_run(answer["runs"][name], run, 1e-9)
            assert answer["runs"][name]["divergedAt"] == run.diverged_at
            assert answer["summary"]["verdicts"][name] == run.verdict()
            excitation = windowed(run.observer.form, run.recording, settings["window"]).smallest
            assert answer["excitation"] == pytest.approx(list(excitation), rel=1e-6, abs=1e-12)


def test_a_single_sample_is_told(node):
    for lab in (observer_lab("ma2005_eq35"), structure_lab(duration=3.0)):
        (answer,) = run_in_node(node, lab, [lab.check({"duration": 0.5, "period": 1.0})])
        assert "a duration of 0.5 s holds no two samples 1 s apart" in answer["problem"]
