"""The derived rate is the motion of the image, for every motion on every surface."""

import re

import numpy as np
import pytest
import sympy as sp
from examples import AFFINE, MOTIONS, SURFACES

from percept_obs import ImagingSurface, PerspectiveSystem, affine, chained, pinhole, plane
from percept_obs.checking.deciding import same
from percept_obs.compile import function_source, vectorised
from percept_obs.system.surfaces.base import X, Y, Z

y1, y2 = sp.symbols("y1 y2", real=True)
AXIS, RANGE, TURN = sp.sqrt(X**2 + Z**2), sp.sqrt(X**2 + Y**2 + Z**2), sp.sqrt(y1**2 + y2**2)
ON_SPHERE = (sp.sin(y1) * sp.cos(y2), sp.sin(y2), sp.cos(y1) * sp.cos(y2))
POLAR = sp.atan2(sp.sqrt(X**2 + Y**2), Z) / sp.sqrt(X**2 + Y**2)
FISHEYE = (sp.sin(TURN) * y1 / TURN, sp.sin(TURN) * y2 / TURN, sp.cos(TURN))
ANGULAR = [
    ImagingSurface("cylinder", (sp.atan2(X, Z), Y / AXIS), AXIS, (sp.sin(y1), y2, sp.cos(y1))),
    ImagingSurface("azimuth and elevation", (sp.atan2(X, Z), sp.atan(Y / AXIS)), RANGE, ON_SPHERE),
    ImagingSurface("by sines", (sp.atan(X / Z), sp.asin(Y / RANGE)), RANGE, ON_SPHERE),
    ImagingSurface("equidistant", (POLAR * X, POLAR * Y), RANGE, FISHEYE),
]
"""Surfaces whose image is an angle."""


@pytest.mark.parametrize("surface", ANGULAR, ids=lambda surface: surface.name)
def test_angles_are_plain_on_the_ray_and_are_printed_in_both_languages(surface):
    test_rate_against_a_finite_difference(affine(), surface)
    system = PerspectiveSystem(affine(), surface)
    assert not system.rate.atoms(sp.Abs, sp.atan, sp.atan2, sp.asin)
    assert "Math.atan" in function_source((X, Y, Z), surface.image)
    assert "Math.sin" in function_source((*system.coordinates, *system.parameters), tuple(system.rate))


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
def test_rate_against_a_finite_difference(motion, surface):
    system, draw = PerspectiveSystem(motion, surface), np.random.default_rng(0)
    points = draw.uniform((-1, 0.5, 2), (1, 1.5, 4), (20, 3))
    numbers = draw.uniform(-1, 1, (len(motion.parameters), 20))
    moved = list(motion.A * sp.Matrix([X, Y, Z]) + motion.b)
    velocity = np.stack(vectorised((X, Y, Z, *motion.parameters), moved)(*points.T, *numbers), axis=-1)
    step = 1e-5
    ahead, behind = (surface.project(points + sign * step * velocity) for sign in (1, -1))
    at = surface.project(points)
    rate = vectorised((*system.coordinates, *motion.parameters), list(system.rate), surface.values)(*at.T, *numbers)
    np.testing.assert_allclose(np.stack(rate, axis=-1), (ahead - behind) / (2 * step), rtol=1e-6, atol=1e-8)


def test_the_jacobian_against_a_finite_difference():
    at = sp.Matrix([sp.Rational(1, 3), sp.Rational(-1, 5), sp.Rational(2, 5)])
    point = dict(zip(AFFINE.coordinates, at, strict=True))
    step = sp.Rational(1, 10**6)
    for k, symbol in enumerate(AFFINE.coordinates):
        ahead, behind = (AFFINE.rate.subs({**point, symbol: point[symbol] + s * step}) for s in (1, -1))
        difference = ((ahead - behind) / (2 * step)).expand()
        # the rate is quadratic, so that the central difference is exact
        assert difference == AFFINE.jacobian().col(k).subs(point).expand()


def test_on_the_focus_of_expansion_translation_alone_does_not_move_the_image():
    for surface in (pinhole(), chained(), plane()):
        system = PerspectiveSystem(affine(sp.zeros(3), sp.symbols("b1:4", real=True)), surface)
        at_focus = dict(zip(surface.image_coordinates, system.foe, strict=True))
        image_rate = system.rate[: len(surface.image)]
        assert all(sp.cancel(sp.together(entry.subs(at_focus))) == 0 for entry in image_rate)


def test_the_derivation_ends_at_the_rate_and_shows_every_part():
    derivation = AFFINE.derivation()
    assert sp.latex(AFFINE.rate) in derivation.steps[-2].formula
    assert sp.latex(AFFINE.foe) in derivation.steps[-1].formula
    assert derivation._repr_markdown_().count("$$") == 2 * len(derivation.steps)
    assert str(derivation).startswith("1. The point moves")
    formulas = [line for line in derivation._repr_markdown_().split("\n\n") if "$$" in line]
    assert all(re.fullmatch(r"\$\$ .* \$\$", formula) for formula in formulas), "each alone, at the edge"
    assert r"\frac{d}{dt}" in AFFINE._repr_latex_()


@pytest.mark.slow
@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
def test_every_step_that_leads_on_leads_to_the_rate(motion, surface):
    system = PerspectiveSystem(motion, surface)
    steps = [step for step in system.derivation() if step.leads_on]
    assert len(steps) == 6
    for step in steps:
        assert all(same(*pair) for pair in zip(step.onward(list(step.values.values())), system.rate, strict=True))


def test_what_follows_from_a_slip_in_a_step():
    b3, y = sp.Symbol("b3", real=True), AFFINE.coordinates
    gradients, velocity = AFFINE.derivation()[3], AFFINE.derivation()[4]
    turned = [entry.xreplace({b3: -b3}) for entry in velocity.values.values()]
    assert velocity.onward(turned).expand() == AFFINE.rate.xreplace({b3: -b3})
    forgotten = [0 if "y1 = X/Z with respect to Z" in name else value for name, value in gradients.values.items()]
    assert (gradients.onward(forgotten)[0] - AFFINE.rate[0]).expand().has(y[0] * y[2] * b3)
    with pytest.raises(ValueError, match="it is not known what follows"):
        AFFINE.derivation()[-1].onward([])


def test_a_part_of_a_derivation_is_one_too():
    derivation = AFFINE.derivation()
    part = derivation[1:3]
    assert list(part) == [derivation[1], derivation[2]]
    assert len(part) == 2
    assert part._repr_markdown_().startswith(f"**1.** {derivation[1].reason}")
    assert derivation[-1] is derivation.steps[-1]
    with pytest.raises(IndexError):
        derivation[len(derivation)]


@pytest.mark.parametrize("names", [(), ("y3",), ("z",), ("y1", "y1"), ("y1", "y4")])
def test_outputs_that_are_none_are_refused(names):
    with pytest.raises(ValueError, match="the outputs of the pinhole are y1, y2"):
        AFFINE.measure(*names)
    with pytest.raises(ValueError, match="the outputs of the pinhole are y1, y2"):
        AFFINE.partition(*names)
