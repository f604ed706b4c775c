"""The page follows a sphere whose apparent size is seen as Python does, to 1e-9, and copies code that makes the run."""

import numpy as np
import pytest
from lab_settings import NOISY, as_array, copied_runs, run_in_node

from percept_obs.labs.observer.lab import observer_lab
from percept_obs.labs.observer.texts import OF_SIZE, SIZE
from percept_obs.observability import windowed

pytestmark = [pytest.mark.node, pytest.mark.slow]

SEEN = [0, 1, 3]
"""Coordinates that the page shows: all but the size."""
CASES = {
    "exact samples": {"hold": "exact", "period": 0.05},
    "noise and losses": {"noise": NOISY, "dropout": 0.2, "seed": 4},
    "chosen start": {"start": {"mode": "chosen", "values": [0.2, 0.7, 1.0]}},
    "start at zero": {"start": {"mode": "zero", "values": [0.0, 0.0, 0.0]}, "period": 0.037},
    "straight on": {"A": np.zeros((3, 3)).tolist(), "b": [-0.2, 0.05, -1.25], "X0": [1.2, -0.3, 7.5], "duration": 4.0},
}


@pytest.mark.parametrize("case", CASES)
def test_the_page_is_python(node, case):
    lab = observer_lab(**{"outputs": list(SIZE), "observers": list(OF_SIZE), "duration": 10.0, **CASES[case]})
    (answer,) = run_in_node(node, lab, [lab.settings])
    copied = copied_runs(answer, lab.settings)
    for name, run in lab.run().items():
        told = answer["runs"][name]
        np.testing.assert_allclose(as_array(answer["outputs"], 3), run.recording.outputs, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(as_array(told["estimate"], 3), run.estimate[:, SEEN], rtol=1e-10, atol=1e-9)
        np.testing.assert_allclose(copied[name].estimate, run.estimate, rtol=0, atol=1e-12)
        assert answer["summary"]["verdicts"][name] == run.verdict()
        if run.observer.covariance is not None:
            variances = np.diagonal(run.covariance, axis1=1, axis2=2)[:, SEEN]
            np.testing.assert_allclose(as_array(told["deviation"], 3) ** 2, variances, rtol=1e-10, atol=1e-9)
    window = min(lab.settings["window"], float(np.ptp(run.time)))
    expected = windowed(run.observer.form, run.recording, window).smallest
    np.testing.assert_allclose(answer["excitation"], expected, rtol=1e-6, atol=1e-9)


def test_what_the_page_has_not_of_the_size_is_said(node):
    lab = observer_lab(outputs=list(SIZE), noise=NOISY)
    (answer,) = run_in_node(node, lab, [lab.settings])
    assert answer["bound"] is None
    with pytest.raises(ValueError, match="with the size"):
        observer_lab(outputs=list(SIZE), observers=["sliding_mode"])
