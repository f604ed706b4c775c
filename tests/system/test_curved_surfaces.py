"""Roots keep their names on curved surfaces, and another surface shows the same point."""

from functools import partial

import numpy as np
import pytest
import sympy as sp
from examples import AFFINE, SURFACES

from percept_obs import (
    BehindCamera,
    Camera,
    Gaussian,
    PerspectiveSystem,
    Recording,
    affine,
    ellipsoid,
    identifier_based,
    pinhole,
    plane,
    record,
    scenarios,
    seen_on,
    sphere,
    unified,
)
from percept_obs.checking.deciding import same
from percept_obs.compile import Intermediate, definitions, executed, function_source, vectorised
from percept_obs.system import surfaces
from percept_obs.system.surfaces.ellipsoid import zeta
from percept_obs.system.surfaces.lift import mu

THREE = {f"{make.__name__} with three outputs": partial(make, outputs=3) for make in (plane, sphere, ellipsoid)}
SYMBOLIC = {make.__name__: make for make in surfaces.SURFACES} | THREE
XI = sp.Symbol("xi", real=True)
Y = sp.symbols("y1 y2", real=True)
SHAPE = sp.symbols("q11 q12 q13 q22 q23 q33", real=True)
ROUND = [[2.0, 0.3, 0.1], [0.3, 1.0, -0.2], [0.1, -0.2, 1.5]]


@pytest.mark.parametrize("make", SYMBOLIC.values(), ids=SYMBOLIC)
def test_every_surface_has_a_short_rate(make):
    assert sp.count_ops(PerspectiveSystem(affine(), make()).rate) <= 200


def test_the_unified_model_holds_the_pinhole_and_the_stereographic_sphere():
    rate = PerspectiveSystem(affine(), unified()).rate
    assert rate.subs(XI, 0).expand() == AFFINE.rate
    point = (0.3, -0.4, 0.2)
    np.testing.assert_allclose(unified(0.0).project((*point[:2], 2.0)), pinhole().project((*point[:2], 2.0)))
    np.testing.assert_allclose(unified(1.0).project(point)[:2], sphere().project(point)[:2], rtol=1e-14)


def test_a_round_ellipsoid_is_the_unit_sphere_seen_from_the_front():
    point = (0.3, -0.4, 1.2)
    np.testing.assert_allclose(ellipsoid(np.eye(3)).project(point)[[0, 1, 2]], sphere(3).project(point)[[0, 1, 3]])


@pytest.mark.parametrize("surface", [s for s in SURFACES.values() if s.constraint is not None], ids=lambda s: s.name)
def test_a_third_output_stays_on_the_surface(surface):
    system = PerspectiveSystem(affine(), surface)
    draw = np.random.default_rng(1)
    at = surface.project(draw.uniform(0.5, 2, (20, 3)))
    names = (*system.coordinates, *system.motion.parameters)
    leaves = (sp.Matrix([surface.constraint]).jacobian(system.coordinates) * system.rate)[0]
    numbers = draw.uniform(-1, 1, (len(system.motion.parameters), 20))
    held, leaving = vectorised(names, (surface.constraint, leaves), surface.values)(*at.T, *numbers)
    assert np.abs(held).max() < 1e-12
    assert np.abs(leaving).max() < 1e-10


@pytest.mark.parametrize("root", [mu(*Y, XI), zeta(*Y, *SHAPE)], ids=["mu", "zeta"])
def test_a_root_solves_its_equation_and_so_do_its_derivatives(root):
    assert same(root.equation(root, *root.args), sp.S.Zero)
    for letter in root.args:
        assert same(root.diff(letter), root.written_out.diff(letter))
        assert root.diff(letter).atoms(Intermediate) <= {root}


def test_a_root_has_a_letter_and_a_number():
    root = mu(*Y, XI)
    hats = sp.symbols("yhat1 yhat2", real=True)
    assert sp.latex(root**2) == r"\mu^{2}"
    assert sp.latex(root.subs(dict(zip(Y, hats, strict=True)))) == r"\hat{\mu}"
    assert sp.latex(root.subs(Y[0], 2 * Y[0])) == r"mu(2*y1, y2, xi)"
    assert root.subs({Y[0]: 0, Y[1]: 0}).subs(XI, 0.5) == pytest.approx(1.5)
    assert list(definitions([root + 1])) == [sp.Symbol("mu", real=True)]
    system = PerspectiveSystem(affine(), unified())
    form = system.measure("y1", "y2")
    for shown in (system, form, identifier_based(form).equations):
        assert r"\mu} &=" in shown._repr_latex_().replace(r"\mu &=", r"\mu} &=").replace(r"\mu =", r"\mu} &=")
    assert "mu" in system.derivation()[2].formula


def test_a_kernel_computes_a_root_once():
    rate = PerspectiveSystem(affine(), unified()).rate
    symbols = tuple(sorted(rate.free_symbols, key=str))
    text = function_source(symbols, tuple(rate), "python")
    assert text.count("sqrt") == 1
    numbers = np.linspace(0.1, 0.9, len(symbols))
    found = executed(text)(numbers.tolist(), [0.0] * 3)
    np.testing.assert_allclose(
        found, [float(e.subs(dict(zip(symbols, numbers, strict=True)))) for e in rate], rtol=1e-12
    )


FIELDS = {
    "pinhole": (pinhole(), 180),
    "a tilted plane": (plane([np.tan(np.radians(20)), 0, 1]), 140),
    "sphere": (sphere(), 360),
    "an ellipsoid": (ellipsoid(np.eye(3)), 180),
    "an ellipsoid with three outputs": (ellipsoid(ROUND, 3), 360),
    "a mirror": (unified(0.5), 240),
    "a fisheye lens": (unified(2.0), 240),
}


@pytest.mark.parametrize(("surface", "degrees"), FIELDS.values(), ids=FIELDS)
def test_every_surface_knows_its_field_of_view(surface, degrees):
    assert np.degrees(surface.field_of_view) == pytest.approx(degrees, abs=1e-3)


def test_beyond_its_field_a_surface_sees_nothing():
    inside, outside = ([np.sin(angle), 0.0, np.cos(angle)] for angle in np.radians([119, 121]))
    for surface in (unified(0.5), unified(2.0)):
        assert list(surface.sees([inside, outside])) == [True, False]
        np.testing.assert_allclose(surface.locate(surface.project(inside)), inside, atol=1e-12)
        with pytest.raises(BehindCamera, match="unified"):
            surface.project(outside)
    with pytest.raises(BehindCamera, match="in its field of view"):
        ellipsoid(np.eye(3)).project([0.0, 1.0, -0.1])
    assert not pinhole().sees([np.nan, 0.0, 1.0])  # nobody sees a point that is not known


@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
def test_a_converted_recording_is_the_one_of_the_other_surface(surface):
    recording = record(scenarios.ma2005_eq35(), 1)
    there = record(scenarios.ma2005_eq35(surface), 1)
    converted = seen_on(recording, surface)
    np.testing.assert_allclose(converted.outputs, there.outputs, atol=1e-12)
    np.testing.assert_allclose(converted.truth, there.truth, atol=1e-12)
    np.testing.assert_allclose(converted.signal(np.array([0.5])), there.signal(np.array([0.5])), atol=1e-12)
    back = seen_on(converted, pinhole())
    np.testing.assert_allclose(back.outputs, recording.outputs, atol=1e-12)


def test_what_another_surface_does_not_see_is_lost_and_its_noise_is_not_the_same():
    recording = record(scenarios.ma2005_eq35(sphere()), 20, Camera(0.1, Gaussian(0.001)), seed=1)
    assert seen_on(recording, sphere()).noise_variance == recording.noise_variance
    converted = seen_on(recording, plane([-1.0, 0.0, 1.0]))
    assert converted.noise_variance is None
    lost = recording.points @ [-1.0, 0.0, 1.0] <= 0
    assert 0 < lost.sum() < len(lost)
    assert list(np.isnan(converted.truth).all(axis=1)) == list(lost)
    with pytest.raises(ValueError, match="the recording has no y2"):
        seen_on(Recording(recording.time, recording.outputs[:, :1], ("y1",), sphere(), recording.motion), pinhole())


def test_a_camera_sees_nothing_beside_its_field_of_view():
    whole, part = (record(scenarios.ma2005_eq35(), 20, Camera(0.1, field_of_view=f)) for f in (2 * np.pi, 1.5))
    angle = np.arccos(whole.points[:, 2] / np.linalg.norm(whole.points, axis=1))
    assert list(part.seen) == list(angle <= 0.75)
    assert 0 < part.seen.sum() < len(part.seen)
    with pytest.raises(ValueError, match="is 90 rad; it must be above 0 and at most 2 pi"):
        Camera(field_of_view=90)
