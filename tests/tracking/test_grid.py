"""A sample is held for as long as was asked, and a line between two samples that are farther apart is none."""

import math
from dataclasses import replace

import numpy as np
import pytest

from percept_obs import Camera, record, scenarios
from percept_obs.tracking.grid import time_grid


@pytest.mark.parametrize(
    ("hold", "longest", "known"), [("zero", 0.25, 3), ("first", 0.25, 0), ("first", 0.7, 6), ("zero", math.inf, 6)]
)
def test_over_a_gap_of_six_steps_outputs_are_known_for_the_first_few(hold, longest, known):
    whole = record(scenarios.ma2005_eq35(), 2, Camera(0.1))
    lost = slice(6, 11)
    time, outputs = (np.delete(each, lost, axis=0) for each in (whole.time, whole.outputs))
    gap = replace(whole, time=time, outputs=outputs, truth=None, signal=None)
    held = np.isfinite(time_grid(gap, 0.1, hold, longest).held(filled=False)).all(axis=(1, 2))
    assert held.tolist() == [True] * (5 + known) + [False] * (6 - known) + [True] * 9
