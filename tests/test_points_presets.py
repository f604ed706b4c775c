"""What the presets of the lab of many points promise in words is what their settings do."""

import numpy as np
import pytest
from javascript import run_script
from lab_settings import FRONT
from points_settings import recording_of, run_of

from percept_obs.labs.points.lab import points_lab
from percept_obs.points.gramian import gramian, linear_gramian

pytestmark = [pytest.mark.node, pytest.mark.slow]


@pytest.fixture(scope="module")
def acts(node, always_compiled):
    """The settings of every act, as Python accepts them."""
    lab = points_lab()
    found = run_script(node, FRONT / "tests/presets.js", {"lab": "points", "standard": lab.model["standard"]})
    return {name: [lab.check(settings) for settings in several] for name, several in found.items()}


def told(settings):
    """The Gramian of what is shown."""
    return gramian(recording_of(settings), settings["window"])


def unseen(settings):
    """How many directions the weakest window misses."""
    return told(settings).unseen().shape[1]


def test_the_best_gain_is_not_the_largest(acts):
    third, three = acts["gain"]
    rates = [run_of(s).decay_rate(20, 60) for s in (third["kept"], third, three, {**three, "size": 10.0})]
    np.testing.assert_allclose(rates, [0.179, 0.086, 0.215, 0.067], rtol=0.02)
    assert three["kept"] == third["kept"]


def test_a_hidden_point_is_corrected_by_its_neighbours(acts):
    body, alone = (run_of(settings) for settings in acts["hide"])
    errors = []
    for run in (body, alone):
        off = np.linalg.norm(run.points - run.recording.view.locate(run.truth), axis=2)[:, 1]
        at = np.searchsorted(run.time, [3 - 1e-9, 15 - 1e-9])
        errors.append(off[at])
    assert errors[0][1] < 0.5 * errors[0][0]
    assert errors[1][1] == pytest.approx(errors[1][0], rel=1e-6)


def test_an_offset_that_no_image_shows_is_lost(acts):
    (settings,) = acts["offset"]
    assert "3 directions are not seen: d2_x; d2_y; d2_z" in told(settings).verdict()
    run = run_of(settings)
    offset = np.linalg.norm(run.error[:, 3:], axis=1)
    assert offset[-1] == pytest.approx(offset[0], rel=1e-6)


def test_along_the_ray_no_depth_is_seen_and_across_it_is(acts):
    along, across = acts["sight"]
    assert "this is the state itself" in told(along).verdict()
    assert np.ptp(recording_of(along).outputs, axis=0).max() < 1e-12
    run = run_of(along)
    assert run.deviation[-1] == pytest.approx(run.deviation[0], rel=1e-6)
    assert told(across).holds
    found = run_of(across)
    assert found.deviation[-1] < 0.1 * found.deviation[0]
    assert np.linalg.norm(across["velocity"]) == pytest.approx(np.linalg.norm(along["velocity"]), rel=0.02)


def test_without_input_the_scale_is_lost_for_any_number_of_points(acts):
    three, eight = acts["input"]
    assert [len(s["points"]) for s in (three, eight)] == [3, 8]
    for settings in (three, eight):
        assert unseen(settings) == 1
        assert "the images do not tell its scale" in told(settings).verdict()
        assert linear_gramian(recording_of(settings), settings["window"]).holds
        assert recording_of(settings).seen.all()
        # twice all depths and offsets
        twice = {**settings, "points": (2 * np.array(settings["points"])).tolist()}
        np.testing.assert_allclose(recording_of(twice).outputs, recording_of(settings).outputs, atol=1e-9)
    assert told({**three, "velocity": [0.2, 0.0, 0.0]}).holds


def test_an_origin_is_seen_only_where_the_body_turns_in_the_world(acts):
    still, turning = acts["origin"]
    assert unseen(still) == 3
    assert told(turning).holds


def test_riccati_finds_in_seconds_what_a_constant_does_not(acts):
    (settings,) = acts["riccati"]
    kept = run_of(settings["kept"])
    assert kept.deviation[-1] == pytest.approx(0.17, abs=0.005)
    assert "stays within 10 % after 1 s" in run_of(settings).verdict()
    constants = [run_of({**settings["kept"], "size": size}).deviation[-1] for size in (0.1, 0.3, 1.0, 3.0, 10.0)]
    assert min(constants) > 0.05
