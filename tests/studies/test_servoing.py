"""A camera that is steered by what it sees: exact depth gives an exponential way, and observers close the loop."""

from functools import cache

import numpy as np
import pytest
import sympy as sp
from refusals import refuses
from scipy.spatial.transform import Rotation

from percept_obs import ekf, ibo, track
from percept_obs.labs import observer_lab
from percept_obs.observers import de_luca
from percept_obs.studies import servoing
from percept_obs.studies.servoing import FORM, servo, starts

FILTER = ekf(FORM, noise_variance=1e-6)
FAR = [[0.1, -0.1, 1.0, 0.1, 0.2, 0.4]]


@cache
def run(depth, **settings):
    return servo(FAR, depth, duration=4.0, **settings)


def test_the_derived_interaction_matrix_is_the_printed_one():
    """Chaumette and Hutchinson 2006, with the camera's own angular velocity."""
    y1, y2, y3 = FORM.coordinates
    printed = [[-y3, 0, y1 * y3, y1 * y2, -1 - y1**2, y2], [0, -y3, y2 * y3, 1 + y2**2, -y1 * y2, -y1]]
    assert (servoing.INTERACTION - sp.Matrix(printed)).expand().is_zero_matrix


def test_with_the_true_depth_the_image_error_decays_exponentially():
    found = servo([[0.01, 0, 0.02, 0, 0, 0.03]], "true", noise=0.0, duration=2.0)
    size = np.linalg.norm(found.image_error[0], axis=1)
    held = np.log1p(-found.time[1]) / found.time[1]  # e+ = (1 - lambda T) e
    np.testing.assert_allclose(size / size[0], np.exp(held * found.time), rtol=0.02)
    assert found.overshoot[0] == 0


def test_the_camera_begins_where_its_start_says_and_ends_at_the_goal():
    shift, turn = np.split(np.array(FAR[0]), 2)
    centre, way = servoing.GOAL.mean(axis=0), run("true").camera()
    np.testing.assert_allclose(way[0], centre - Rotation.from_rotvec(turn).inv().apply(centre + shift), atol=1e-12)
    assert np.linalg.norm(way[-1]) < 0.05 * np.linalg.norm(way[0])


@pytest.mark.slow
def test_a_wrong_depth_slows_or_overshoots():
    true, near, far = (
        servo(starts(8), *depth, noise=0.0) for depth in (["true"], ["constant", 0.5], ["constant", 4.0])
    )
    assert np.median(near.arrived_at()) > 1.5 * np.median(true.arrived_at())
    assert np.isfinite([near.arrived_at(), far.arrived_at()]).all()
    assert np.median(far.overshoot) > 0.005 > true.overshoot.max()


@pytest.mark.slow
def test_the_loop_excites_its_observer_and_then_no_more():
    found = run(FILTER)
    assert np.abs(found.depth_error[0, 30:]).max() < 0.05 < np.abs(found.depth_error[0, 0]).min()
    assert found.excitation[0, -1].max() < 0.01 * found.excitation[0, 0].max()
    moved = np.moveaxis(found.coordinates, -1, 0)[:, 0, 5, 1]
    velocity = dict(zip(servoing.VELOCITIES, found.velocity[0, 5], strict=True))
    numbers = velocity | dict(zip(FORM.coordinates, moved, strict=True)) | dict.fromkeys(FORM.parameters[6:], 0)
    assert found.excitation[0, 5, 1] == pytest.approx(float((FORM.w * FORM.w.T)[0].subs(numbers)))


@pytest.mark.slow
@pytest.mark.parametrize("observer", [FILTER, de_luca(FORM), ibo(FORM)], ids=lambda each: each.name)
def test_the_recording_of_a_point_makes_the_observer_in_the_loop_run_again(observer):
    found = run(observer)
    again = track(found.recording(point=2), observer, {"y3": 1.0})
    inside = (found.believed > 0.11) & (found.believed < 9)
    use = inside[0, :, 2] & (found.time < 3) & (found.time > 0.1)  # the first commands jump
    np.testing.assert_allclose(again.estimate[use, 2], found.believed[0, use, 2], rtol=0.02)


@pytest.mark.slow
def test_steering_that_vanishes_with_the_error_looks_better_on_the_way():
    plain, looking = run("true"), run("true", looking=0.3)
    assert looking.excitation.sum() > 1.1 * plain.excitation.sum()
    assert np.isfinite(looking.arrived_at()[0])


def test_a_point_that_leaves_the_image_is_lost():
    found = servo(FAR, "constant", ratio=160.0, duration=4.0)
    assert found.lost[0, -1]
    assert found.arrived_at()[0] == np.inf
    assert not found.velocity[0, -1].any()


@pytest.mark.night
@pytest.mark.slow
def test_of_many_starts():
    depths = {"true": "true", "constant": "constant", "observed": FILTER}
    arrived = {name: servo(starts(40), depth, duration=8.0).arrived_at() for name, depth in depths.items()}
    assert np.isfinite([*arrived.values()]).all()
    time = {name: np.median(each) for name, each in arrived.items()}
    assert abs(time["observed"] - time["true"]) < 0.1 < time["constant"] - 3.4
    assert observer_lab(run(FILTER).recording())
    assert np.isfinite(servo(starts(40), "constant", ratio=1 / 4).arrived_at()).mean() < 0.5


test_what_makes_no_sense_is_refused = refuses(
    lambda poses, depth, settings: servo(poses, depth, **settings),
    (FAR[0], "true", {}, r"starts have shape \(6,\); give finite rows"),
    (FAR, "guessed", {}, "the depth 'guessed' is none of 'true', 'constant' and an Observer"),
    (FAR, ekf(servoing.SYSTEM.measure("y1")), {}, "is of another form; make it of servoing.FORM"),
    (FAR, "true", {"ratio": -1.0}, "ratio is -1.0; it must be positive"),
    ([[3, 0, 0, 0, 0, 0]], "true", {}, "start 0 leaves a point out of sight"),
)
