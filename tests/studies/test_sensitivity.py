"""The variational equations give the derivative of an estimate with respect to the motion, and predict its errors."""

from dataclasses import replace

import numpy as np
import pytest
from examples import BOTH, NOISY, ONE, ZERO
from sample_sizes import sampled

from percept_obs import PerspectiveSystem, Uniform, affine, ekf, ibo, pinhole, record, rigid, scenarios, track
from percept_obs.compile.variation import variation
from percept_obs.figures import entries
from percept_obs.observers import OBSERVERS
from percept_obs.studies.sensitivity import misbelieved, sensitivity

RECORDING = record(scenarios.ma2005_eq35(), 0.5, replace(NOISY, noise=Uniform(0.002)), seed=1)
START = {"y1+y2": {"y3": 0.3}, "y1": {"y2": 1.0, "y3": 0.3}}
RIGID = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")


EVERY = [make for make in OBSERVERS if make.key != "equivariant_filter" or sampled(False, True)]
"""The equivariant filter, whose variation takes half a minute to derive, with ALL_SAMPLES=1 only."""


def slope(recording, observer, start, entry, change=2e-4):
    """The derivative by central differences, extrapolated to no change."""

    def difference(change):
        ends = [misbelieved(recording.motion, **{entry: sign * change}) for sign in (1, -1)]
        more, less = (track(recording, observer, start, believed=end).estimate for end in ends)
        return (more - less) / (2 * change)

    return (4 * difference(change / 2) - difference(change)) / 3


@pytest.mark.slow
@pytest.mark.parametrize("make", EVERY, ids=lambda make: make.key)
def test_it_is_the_derivative_of_every_smooth_observer(make):
    """The integral sliding mode and the range identification observer are smooth by the layer that they have."""
    form = BOTH if make.refusal(ONE) or OBSERVERS.index(make) % 2 else ONE
    start = START["+".join(form.measured)]
    observer = make(form, iterates=2) if make.key == "linear_approximation" else make(form)
    found = sensitivity(RECORDING, observer, start, sampled(("a13", "b2"), None))
    assert not len(found.run.resets)
    for k, entry in enumerate(found.entries):
        expected = slope(RECORDING, observer, start, entry)
        there = np.isfinite(expected)
        assert there.any()
        np.testing.assert_array_equal(there, np.isfinite(found.derivatives[:, :, k]))
        off = np.abs(found.derivatives[:, :, k] - expected)[there].max()
        assert off <= 1e-5 * np.abs(expected[there]).max()


def test_it_goes_through_a_reset():
    observer = ibo(BOTH, bound=0.75)
    found = sensitivity(RECORDING, observer, {"y3": 0.3}, ("b3",))
    assert len(found.run.resets) > 1
    expected = slope(RECORDING, observer, {"y3": 0.3}, "b3", 1e-6)
    np.testing.assert_allclose(found.derivatives[:, :, 0], expected, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("make", [ibo, ekf])
def test_two_per_cent_of_b3_are_predicted_before_they_are_run(make):
    """On (35), with both outputs, to 5 % of the effect; later than the transient, to the end."""
    recording, error = record(scenarios.ma2005_eq35(), 20), 0.02 * 0.3
    found = sensitivity(recording, make(BOTH), entries=("b3",))
    wrong = track(recording, make(BOTH), believed=misbelieved(recording.motion, b3=error))
    effect = wrong.estimate - found.run.estimate
    left = effect - found.change(b3=error)
    assert np.linalg.norm(left) <= 0.05 * np.linalg.norm(effect)
    assert np.linalg.norm(effect) > 0.1
    late = found.run.time > 5
    shares = wrong.distance[late] / found.run.distance[late] - 1
    predicted = found.distance_change(error / found.sizes[0])[late, 0]
    assert np.linalg.norm(shares - predicted) <= 0.05 * np.linalg.norm(shares)


def test_a_motion_that_varies_is_differentiated_as_well():
    path = rigid(
        camera_angular_velocity=lambda t: [0.0, -0.1 * np.sin(t), 0.0], camera_velocity=lambda t: [np.cos(t), 0.0, 0.2]
    )
    moved = replace(scenarios.ma2005_eq35(), motion=path)
    recording = record(moved, 3)
    observer = ekf(RIGID)
    found = sensitivity(recording, observer, {"y3": 0.4}, ("w_c2", "v_c3"))
    for k, entry in enumerate(found.entries):
        expected = slope(recording, observer, {"y3": 0.4}, entry)
        np.testing.assert_allclose(found.derivatives[:, :, k], expected, atol=1e-5 * np.abs(expected).max())


def test_the_picture_says_which_entries_matter():
    found = sensitivity(RECORDING, ibo(BOTH), START["y1+y2"])
    ranking = found.ranking()
    assert list(ranking.values()) == sorted(ranking.values(), reverse=True)
    assert found.sizes == pytest.approx([np.linalg.norm(RECORDING.motion.known(0)[0, :9])] * 9 + [found.sizes[-1]] * 3)
    drawn = entries(found, most=3)
    assert len(drawn.axes[0].lines) == 3
    assert ", ".join(list(ranking)[3:]) in drawn.text
    assert next(iter(ranking)) in repr(found)


def test_what_makes_no_sense_is_refused():
    observer = ibo(BOTH)
    for ask, message in (
        (lambda: sensitivity(RECORDING, observer, entries=("b4",)), "no entry b4; it has a11"),
        (lambda: sensitivity(RECORDING, observer, entries=()), "has no entry"),
        (lambda: misbelieved(affine(), b3=1.0), "no entries with numbers"),
        (lambda: misbelieved(RECORDING.motion, w_c1=1.0), "no entry w_c1"),
        (lambda: sensitivity(RECORDING, observer, ZERO, ("b3",)).change(b1=1.0), "no entry b1; it has b3"),
        (lambda: variation(observer.equations, observer.equations.state[:1]), "no parameter"),
        (lambda: entries(sensitivity(RECORDING, observer, entries=("b3",)), most=0), "draw one at least"),
        (lambda: entries(RECORDING), "expected a Sensitivity"),
    ):
        with pytest.raises(ValueError, match=message):
            ask()
