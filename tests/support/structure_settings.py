"""Settings of the structure lab that its tests try, and the page's engine run on them in Node.js."""

import json
import warnings
from functools import lru_cache

import numpy as np

from percept_obs.labs import structure_lab
from percept_obs.labs.structure.settings import DRIVE
from percept_obs.labs.structure.texts import OBSERVERS, case_of
from percept_obs.tracking.following import StepTooLong

EVERY = list(OBSERVERS)
NOISY = {"kind": "uniform", "size": 1e-4, "depth": 1e-5}
GAUSSIAN = {"kind": "gaussian", "size": 1.3e-5, "depth": 1e-6}
TURNED = [0.1, -0.2, 0.3]
SWINGING = {"v_c_swing": [0.1, 0.1, -0.1], "v_p_swing": [0.05, 0.0, 0.0], "rate": 0.7}

COROLLARIES = {f"corollary {number}": {**case_of(number), "duration": 2.0} for number in range(1, 8)}
OTHERS = {
    "every observer": {"observers": EVERY, "duration": 1.5},
    "uniform noise, bias and drift": {"noise": NOISY, "bias": 1e-4, "drift": 1e-5, "seed": 3, "start": "own"},
    "Gaussian noise, held": {"noise": GAUSSIAN, "seed": 4294967295, "hold": "zero"},
    "a coarse camera": {"period": 0.02, "step": 0.004, **SWINGING},
    "the exact signal": {"duration": 1.5, "hold": "exact", "period": 0.01, "step": 0.002, **SWINGING},
    "two unknowns": {"unknown": ["d_s", "v_c2"], "observers": ["ideal", "extended_kalman"], "w_c": TURNED},
    # without noise the sign of what is exactly 0 hangs on the last bit
    "one unknown": {"unknown": ["v_p3"], "observers": EVERY, "duration": 1.0, "noise": NOISY, "start": "own"},
    "d_s alone": {"duration": 1.5, "unknown": ["d_s"], "v_c": [-0.22, -0.23, 0.1], **SWINGING},
    "d_s from an earlier stage": {"unknown": ["v_c1", "v_p2"], "earlier": True, "w_c": TURNED},
    "another axis": {"unknown": ["d_s", "v_c1", "v_c3"], "ybar": [-0.2, 0.4, 0.3], "scale": 2.0},
    "the point comes too near": {"v_c": [-0.22, -0.23, 1.5], "unknown": ["d_s", "v_p1"]},
    "a drive with a speedometer": {**DRIVE, "unknown": ["d_s", "v_c1", "v_c2"]},
    "nothing found yet": {"observers": ["layer"], "duration": 0.1},
    "crossing": {**case_of(3), "v_c": [0.0, 0.0, -0.15], "v_c_swing": [0.3, 0.3, -0.3], "duration": 4.5},
}
CASES = {**COROLLARIES, **OTHERS}


@lru_cache(maxsize=1)
def _lab():
    return structure_lab()


def structure_runs_of(settings):
    """Python's runs of settings, whether or not their steps are too long."""
    return _runs_of(json.dumps(settings))


@lru_cache(maxsize=len(CASES))
def _runs_of(text):
    settings = json.loads(text)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", StepTooLong)
        return _lab().runs(settings)


def assert_same_structure_runs(settings, told):
    """The page's estimates are those of Python: to 1e-9 of 1 or their size, chattering ones over the first second."""
    for name, run in structure_runs_of(settings).items():
        found = np.array([np.nan if v is None else v for v in told[name]["estimate"]], dtype=float)
        found = found.reshape(run.estimate.shape)
        switches = name in ("sign", "layer")
        part = run.time <= 1 if switches else np.full(len(run.time), True)
        tolerance = 1e-6 if switches else 1e-9
        np.testing.assert_allclose(found[part], run.estimate[part], rtol=tolerance, atol=tolerance, err_msg=name)
        assert (told[name]["divergedAt"] is None) == (run.diverged_at is None)
