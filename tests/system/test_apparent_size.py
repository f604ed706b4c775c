"""With the apparent size of a sphere the distance is found at the focus of expansion, whatever the radius is."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from examples import AFFINE, SURFACES
from refusals import refuses

import percept_obs as po
from percept_obs import Camera, PerspectiveSystem, affine, ekf, pinhole, record, scenarios, seen_on, sized, track
from percept_obs.compile import vectorised
from percept_obs.observers import OBSERVERS

SIZED = sized(pinhole(), radius=0.3)
SYSTEM = PerspectiveSystem(affine(), SIZED)
FORM = SYSTEM.measure("y1", "y2", "s")
STRAIGHT = replace(scenarios.drive(), position=(1.76, -0.44, 11.0), surface=SIZED)
NOISY = Camera(0.05, po.Gaussian(1e-3))
START = [0.16, -0.04, 0.3 / 11, 1 / 6]
s, y1, y2, b1, b2, b3 = sp.symbols("s y1 y2 b1 b2 b3", real=True)


@pytest.mark.slow
@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
def test_the_size_grows_as_the_inverse_distance_and_the_rest_is_as_without(surface):
    plain, system = (PerspectiveSystem(affine(), each) for each in (surface, sized(surface)))
    *image, size, inverse = system.rate
    assert (system.foe, system.parameters) == (plain.foe, plain.parameters)
    point = surface.project([0.3, 0.2, 2.0])
    numbers = [*point[:-1], 0.1, point[-1], *np.random.default_rng(1).uniform(-1, 1, 12)]
    growth = size / s - inverse / surface.inverse_distance
    zeros = (growth, *(one - other for one, other in zip(image, plain.rate[:-1], strict=True)))
    names = (*system.coordinates, *affine().parameters)
    np.testing.assert_allclose(vectorised(names, zeros, surface.values)(*numbers), 0, atol=1e-12)


def test_the_rate_is_that_of_the_moving_sphere():
    motion = affine([[0.1, -0.2, 0.3], [0.2, 0.1, -0.1], [-0.3, 0.1, 0.2]], [0.5, 0.25, -0.3])
    before, now, after = replace(STRAIGHT, motion=motion).coordinates([1 - 1e-5, 1, 1 + 1e-5])
    found = vectorised((*SYSTEM.coordinates, *affine().parameters), SYSTEM.rate)(*now, *motion.known(0.0)[0])
    np.testing.assert_allclose((after - before) / 2e-5, found, rtol=1e-6, atol=1e-6)


def test_its_row_of_w_stays_at_the_focus_of_expansion():
    assert sp.Matrix([b1 - b3 * y1, b2 - b3 * y2, -b3 * s]) == FORM.w.T
    assert list(po.instantaneous(FORM).zero_set) == [{y1: b1 / b3, y2: b2 / b3, s: 0}]
    assert {("y1", "s"), ("s",)} <= set(SYSTEM.output_choices)
    assert not FORM.rate.has(*SIZED.radii)


def test_the_centre_over_the_radius_is_seen_and_moves_linearly_in_one_over_the_radius():
    """Spica, Robuffo Giordano and Chaumette 2014: p' = A p + b/r, so that any translation shows r."""
    centre, motion = sp.Matrix([y1, y2, 1]) / s, affine()
    moved = centre.jacobian(SYSTEM.coordinates) * SYSTEM.rate
    missed = moved - motion.A * centre - motion.b * SIZED.inverse_distance / s
    assert missed.applyfunc(sp.cancel).is_zero_matrix


@pytest.mark.slow
@pytest.mark.parametrize("make", [make for make in OBSERVERS if not make.refusal(FORM)], ids=lambda make: make.key)
def test_every_observer_of_a_canonical_form_runs_on_it_and_stays_at_the_truth(make):
    recording = record(replace(scenarios.drive(), surface=SIZED), camera=Camera(0.01))
    run = track(recording, make(FORM), start=recording.truth[0], hold="exact")
    assert np.nanmax(run.relative_error[run.time > 1]) < 0.02


@pytest.mark.slow
def test_the_radius_is_in_no_formula_and_a_form_without_one_fits_every_recording():
    small, large = (record(replace(STRAIGHT, surface=sized(pinhole(), radius=r)), 1, NOISY) for r in (0.1, 3.0))
    observer = ekf(PerspectiveSystem(affine(), sized(pinhole())).measure("s"))
    assert all(np.isfinite(track(each, observer).estimate).all() for each in (small, large))
    np.testing.assert_allclose(large.truth[:, 2], 30 * small.truth[:, 2])
    assert small.view.fits(large.view)
    assert not small.view.fits(pinhole())
    assert SIZED.lengths == (0, 0, 0, 1)


@pytest.mark.slow
def test_straight_at_the_point_only_the_size_tells_the_distance():
    errors, ratio = {}, {}
    for form in (SYSTEM.measure("y1", "y2"), FORM):
        films = [record(STRAIGHT, 4, NOISY, seed) for seed in range(12)]
        runs = [track(film, ekf(form, noise_variance=1e-6, hidden_variance=0.01), START) for film in films]
        errors[form.measured] = np.median([run.relative_error[-1] for run in runs])
        ratio[form.measured] = po.efficiency(runs, po.cramer_rao(films[0], form)).mean(2, 4)
    assert errors[FORM.measured] < 0.03
    assert ratio[FORM.measured] == pytest.approx(1, abs=0.35)
    assert errors["y1", "y2"] > 0.3
    blind = record(replace(STRAIGHT, surface=pinhole()), 2, NOISY)
    assert "the state is observable" in str(po.how_observable(record(STRAIGHT, 2, NOISY), FORM))
    assert "it is not observable" in str(po.how_observable(blind, AFFINE.measure("y1", "y2")))


@pytest.mark.slow
def test_without_a_truth_samples_bear_out_the_distance_and_runs_move_the_sphere():
    film = record(STRAIGHT, 4, NOISY, seed=1)
    run = track(replace(film, truth=None), ekf(FORM, noise_variance=1e-6))
    assert "the estimate agrees" in run.trust().sentence
    observer = ekf(FORM, noise_variance=1e-6)
    found = po.ensemble(STRAIGHT, observer, over={"X": [1.0, 1.76]}, seeds=2, camera=NOISY, duration=2.0)
    assert (found["final"] < 0.1).all()


test_what_has_no_size_is_refused = refuses(
    lambda call: call(),
    (lambda: sized(pinhole()).project([1, 2, 3]), "no radius"),
    (lambda: sized(pinhole(), radius=-1.0), "radius is -1.0"),
    (lambda: sized(SIZED), "sees the size already"),
    (lambda: po.diagnose(record(STRAIGHT, 1)), "no usual mistake is of one"),
    (lambda: seen_on(record(scenarios.drive()), SIZED), "rays say nothing of the size"),
)
