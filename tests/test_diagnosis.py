"""A mistake of a camera's owner is named first, with its size, and nothing is named where nothing is wrong."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_study import drawn, figures, spoiled
from sample_sizes import sampled

from percept_obs import Scenario, diagnose, pinhole, record, rigid, scenarios
from percept_obs.figures import scan
from percept_obs.recording import Unlikely
from percept_obs.studies.diagnosis import explain
from percept_obs.studies.diagnosis.experiments import LARGEST_OFFSET, later, unbent

SESSION, DRAW = drawn(3, points=2)


def test_the_point_that_explains_a_recording_leaves_its_noise():
    fit = explain(SESSION[0])
    assert fit.squares / fit.count == pytest.approx(SESSION[0].noise_variance, rel=0.2)
    assert abs(fit.correlation) < 0.2
    exact = record(scenarios.ma2005_eq35(), 4)
    assert np.sqrt(explain(exact).squares / explain(exact).count) < 1e-5


def test_lost_samples_and_one_output_are_explained_as_well():
    exact = record(scenarios.ma2005_eq35(), 4)
    outputs = exact.outputs.copy()
    outputs[50:120, 1] = np.nan
    assert explain(replace(exact, outputs=outputs)).residuals.shape == outputs.shape
    alone = replace(exact, outputs=outputs[:, :1], names=("y1",), signal=None, truth=None)
    assert np.sqrt(explain(alone).squares / explain(alone).count) < 1e-5


@pytest.mark.slow
def test_seven_mistakes_are_named_and_nothing_where_nothing_is():
    """20 recordings with each mistake and 100 clean ones with ALL_SAMPLES=1."""
    found = figures(sampled(1, 20), sampled(2, 100))
    for fault, names in found.items():
        assert names[fault] >= (0.9 if fault == "nothing" else 0.85) * names.total(), (fault, names)


def test_the_offset_is_found_with_its_size_and_drawn():
    late = [replace(recording, motion=later(recording.motion, 0.11)) for recording in SESSION]
    found = diagnose(late)
    assert found.named == "time offset"
    assert found.findings[0].value == pytest.approx(0.11, abs=0.005)
    assert f"the images are {found.findings[0].value:.3f} s late" in found.sentence
    assert found.left > 2 * np.sqrt(SESSION[0].noise_variance)
    drawn_scan = scan(found)
    assert drawn_scan.text.endswith(found.sentence)
    assert min(found.findings[0].left) < found.left


@pytest.mark.slow
def test_the_mismatched_recording_is_named_and_one_alone_cannot_be():
    found = diagnose(spoiled(SESSION, "mismatch", np.random.default_rng(0)))
    assert found.named == "mismatch"
    assert "shows another landmark from" in found.sentence
    alone = diagnose(SESSION[0])
    assert "Not tried: mismatch, for other points are needed" in alone.sentence


def test_what_none_of_the_mistakes_explains_is_said():
    """Noise ten times as large as it is said to be is none of them."""
    found = diagnose(replace(SESSION[0], noise_variance=SESSION[0].noise_variance / 100))
    assert found.named == "nothing"
    assert "something is not as it is known" in found.sentence


def test_pixels_are_told_by_their_size():
    with pytest.warns(Unlikely):
        pixels = [replace(recording, outputs=600 * recording.outputs + 300) for recording in SESSION]
    found = diagnose(pixels)
    assert found.named == "pixels"
    assert "pixels" in repr(found)
    with pytest.raises(ValueError, match="no values that could be drawn"):
        scan(found)


def test_a_constant_motion_shows_no_offset_and_without_noise_nothing_is_wrong():
    steady = Scenario("steady", rigid([0, 0.1, 0], [0.3, 0.1, 0], [0, 0, 0]), (0.2, 0.1, 3), 5, pinhole())
    found = diagnose(record(steady))
    assert "time offset" in found.not_tried
    assert found.named == "nothing"


def test_a_distortion_is_taken_out_and_a_shift_undone():
    y = np.random.default_rng(0).uniform(-0.6, 0.6, (40, 2))
    for bend in (-0.3, 0.3):
        np.testing.assert_allclose(unbent(y * (1 + bend * (y**2).sum(axis=1, keepdims=True)), bend), y, atol=1e-6)
    motion = SESSION[0].motion
    np.testing.assert_allclose(later(later(motion, 0.1), -0.1).known([1.0]), motion.known([1.0]))


def test_what_makes_no_sense_is_refused():
    with pytest.raises(ValueError, match="there is no recording"):
        diagnose([])
    with pytest.raises(ValueError, match="20 are needed"):
        diagnose(SESSION[0].between(0, 2 * LARGEST_OFFSET))
