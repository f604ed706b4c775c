"""With the apparent size of a sphere the distance is found at the focus of expansion, whatever the radius is."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from examples import AFFINE, SURFACES
from refusals import refuses

from percept_obs import (
    Camera,
    Gaussian,
    PerspectiveSystem,
    PixelCamera,
    Recording,
    affine,
    cramer_rao,
    diagnose,
    efficiency,
    ekf,
    ensemble,
    how_observable,
    instantaneous,
    pinhole,
    record,
    scenarios,
    seen_on,
    sized,
    track,
)
from percept_obs.compile import vectorised
from percept_obs.observers import OBSERVERS

SIZED = sized(pinhole(), radius=0.3)
SYSTEM = PerspectiveSystem(affine(), SIZED)
FORM = SYSTEM.measure("y1", "y2", "s")
STRAIGHT = replace(scenarios.drive(), position=(1.76, -0.44, 11.0), surface=SIZED)
NOISY = Camera(0.05, Gaussian(1e-3))
START = [0.16, -0.04, 0.3 / 11, 1 / 6]
s, y1, y2, y3, b1, b2, b3 = sp.symbols("s y1 y2 y3 b1 b2 b3", real=True)
SPAN = {"rtol": 1e-6, "atol": 1e-6}


@pytest.mark.slow
@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
def test_the_size_grows_as_the_inverse_distance_on_every_surface_and_the_rest_is_as_without_it(surface):
    plain, system = (PerspectiveSystem(affine(), each) for each in (surface, sized(surface)))
    *image, size, inverse = system.rate
    assert system.foe == plain.foe
    assert system.parameters == plain.parameters
    eta = surface.inverse_distance
    point, draw = surface.project([0.3, 0.2, 2.0]), np.random.default_rng(1)
    names = (*system.coordinates, *affine().parameters)
    numbers = [*point[:-1], 0.1, point[-1], *draw.uniform(-1, 1, 12)]
    ratios = (size / s - inverse / eta, *(one - other for one, other in zip(image, plain.rate[:-1], strict=True)))
    np.testing.assert_allclose(vectorised(names, ratios, surface.values)(*numbers), 0, atol=1e-12)


def test_the_rate_is_that_of_the_moving_sphere():
    motion = affine([[0.1, -0.2, 0.3], [0.2, 0.1, -0.1], [-0.3, 0.1, 0.2]], [0.5, 0.25, -0.3])
    scene = replace(STRAIGHT, motion=motion)
    before, now, after = scene.coordinates([1 - 1e-5, 1, 1 + 1e-5])
    names = (*scene.surface.coordinates, *SYSTEM.motion.parameters)
    found = vectorised(names, SYSTEM.rate)(*now, *motion.known(0.0)[0])
    np.testing.assert_allclose((after - before) / 2e-5, found, **SPAN)


def test_its_row_of_w_stays_at_the_focus_of_expansion():
    assert sp.Matrix([b1 - b3 * y1, b2 - b3 * y2, -b3 * s]) == FORM.w.T
    assert FORM.w.T.subs({y1: b1 / b3, y2: b2 / b3}) == sp.Matrix([0, 0, -b3 * s])
    assert list(instantaneous(FORM).zero_set) == [{y1: b1 / b3, y2: b2 / b3, s: 0}]
    assert {("y1", "s"), ("s",)} <= set(SYSTEM.output_choices)
    assert not FORM.rate.has(*SIZED.radii)


@pytest.mark.slow
@pytest.mark.parametrize("make", OBSERVERS, ids=lambda make: make.key)
def test_every_observer_runs_on_it_and_stays_at_the_truth(make):
    recording = record(replace(scenarios.drive(), surface=SIZED), camera=Camera(0.01))
    run = track(recording, make(FORM), start=recording.truth[0], hold="exact")
    late = run.time > 1
    assert np.nanmax(run.relative_error[late]) < 0.02


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
def test_straight_at_the_point_the_distance_is_found_to_the_bound_with_the_size_and_not_without():
    errors, ratio = {}, {}
    for form in (SYSTEM.measure("y1", "y2"), FORM):
        films = [record(STRAIGHT, 4, NOISY, seed) for seed in range(12)]
        runs = [track(film, ekf(form, noise_variance=1e-6, hidden_variance=0.01), START) for film in films]
        bound = cramer_rao(films[0], form)
        errors[form.measured] = np.median([run.relative_error[-1] for run in runs])
        ratio[form.measured] = efficiency(runs, bound).mean(2, 4)
    assert errors[FORM.measured] < 0.03
    assert ratio[FORM.measured] == pytest.approx(1, abs=0.35)
    assert errors["y1", "y2"] > 0.3


@pytest.mark.slow
def test_every_measure_of_observability_says_so():
    film = record(STRAIGHT, 2, NOISY)
    assert "All measures agree: the state is observable" in str(how_observable(film, FORM))
    blind = how_observable(record(replace(STRAIGHT, surface=pinhole()), 2, NOISY), AFFINE.measure("y1", "y2"))
    assert "it is not observable" in str(blind)


@pytest.mark.slow
def test_without_a_truth_the_samples_bear_the_distance_out_and_many_runs_move_the_sphere():
    film = record(STRAIGHT, 4, NOISY, seed=1)
    run = track(replace(film, truth=None), ekf(FORM, noise_variance=1e-6))
    assert "the estimate agrees" in run.trust().sentence
    found = ensemble(STRAIGHT, ekf(FORM), over={"X": [1.0, 2.0]}, seeds=2, camera=NOISY, duration=1.0)
    assert (found["status"] == found["status"][0, 0]).all()


def test_the_image_without_the_size_is_that_of_the_surface():
    film = record(STRAIGHT, 1, NOISY)
    np.testing.assert_allclose(seen_on(film, pinhole()).outputs, film.outputs[:, :2], atol=1e-12)


test_what_has_no_size_is_refused = refuses(
    lambda call: call(),
    (lambda: sized(pinhole()).project([1, 2, 3]), "no radius"),
    (lambda: sized(pinhole(), radius=-1.0), "radius is -1.0"),
    (lambda: sized(SIZED), "sees the size already"),
    (lambda: diagnose(record(STRAIGHT, 1)), "no usual mistake is of one"),
    (lambda: seen_on(record(scenarios.drive()), SIZED), "rays say nothing of the size"),
    (
        lambda: Recording.from_csv("a.csv", affine(), SIZED, camera=PixelCamera((500, 500), (320, 240))),
        "pixels say nothing of the size",
    ),
)
