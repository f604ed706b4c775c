"""The canonical form is the system again, and exists only where the measured rate is affine in the rest."""

from dataclasses import replace

import pytest
import sympy as sp
from examples import AFFINE, BOTH, MOTIONS, ON_SPHERE, ONE, OTHER, SURFACES

from percept_obs import NotAffine, PerspectiveSystem
from percept_obs.structure import StructureAndMotion
from percept_obs.system.forms import partition

OUTPUTS = [("y1",), ("y2",), ("y1", "y2"), ("y2", "y1")]


@pytest.mark.slow
@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_the_form_is_the_system_again(motion, surface):
    system = PerspectiveSystem(motion, surface)
    rates = dict(zip(system.coordinates, system.rate, strict=True))
    for names in {order for chosen in system.output_choices for order in (chosen, chosen[::-1])}:
        form = system.measure(*names)
        again = [rates[symbol] for symbol in (*form.x1, *form.x2)]
        assert (form.rate - sp.ImmutableMatrix(again)).expand() == sp.zeros(len(again), 1)
        assert not (form.w.free_symbols | form.phi.free_symbols) & set(form.x2)
        assert form.measured == names


def test_the_inverse_of_a_form_with_denominators_undoes_w():
    form = replace(BOTH, w=BOTH.w / (1 + BOTH.x1[0] ** 2) + sp.ImmutableMatrix([[1 / BOTH.x1[1], 0]]))
    numerator, determinant = form.cramer
    values = {symbol: sp.Rational(k, 7) for k, symbol in enumerate(sorted(form.w.free_symbols, key=str), 2)}
    assert (numerator * form.w.T / determinant).subs(values) == sp.eye(1)
    assert sp.denom(sp.together(determinant)) == 1


def test_what_may_be_measured_can_be_asked():
    for name in ("pinhole", "chained", "plane"):
        assert PerspectiveSystem(MOTIONS["affine"], SURFACES[name]).output_choices == (("y1", "y2"), ("y1",), ("y2",))
    assert ON_SPHERE.output_choices == (("y1", "y2"),)
    three = PerspectiveSystem(MOTIONS["affine"], SURFACES["plane with three outputs"]).output_choices
    assert len(three) == 7
    assert three[0] == ("y1", "y2", "y3")
    assert BOTH.culprits == ()
    assert ON_SPHERE.partition("y1").culprits == ("y2", "y3")


def test_a_sphere_needs_both_outputs():
    assert ON_SPHERE.measure("y1", "y2").hidden == ("y3",)
    advice = r"not affine in y2, y3; measure y2 as well, or .* extended_kalman\(system.partition\('y1'\)\)"
    with pytest.raises(NotAffine, match=advice) as refusal:
        ON_SPHERE.measure("y1")
    assert refusal.value.measured == ("y1",)
    assert refusal.value.culprits == ("y2", "y3")


def test_only_the_guilty_coordinate_is_named():
    x, y, z = sp.symbols("x y z", real=True)
    with pytest.raises(NotAffine) as refusal:
        partition((x, y, z), sp.ImmutableMatrix([x * z + y**2, y, z]), ["x"], ()).canonical_form()
    assert refusal.value.culprits == ("y",)


def test_an_affine_rate_in_disguise_is_accepted():
    x, y = sp.symbols("x y", real=True)
    form = partition((x, y), sp.ImmutableMatrix([(y**2 - x**2) / (y - x), y]), ["x"], ()).canonical_form()
    assert form.w == sp.Matrix([1])
    assert form.phi.subs(x, 3) == sp.Matrix([3])


@pytest.mark.parametrize("names", OUTPUTS, ids="+".join)
@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
def test_a_partition_is_the_system_in_another_order(surface, names):
    system = PerspectiveSystem(MOTIONS["rigid"], surface)
    divided = system.partition(*names)
    assert divided.measured == names
    assert {*divided.measured, *divided.hidden} == {s.name for s in system.coordinates}
    rates = dict(zip((*divided.x1, *divided.x2), divided.rate, strict=True))
    assert [rates[s] for s in system.coordinates] == list(system.rate)
    assert (divided.parameters, divided.coordinates, divided.view) == (system.parameters, system.coordinates, surface)


def test_another_part_makes_another_rate():
    still = replace(BOTH, g=sp.ImmutableMatrix([0]))
    assert still.rate[-1] == 0
    assert still.rate[:2] == BOTH.rate[:2]
    assert still.canonical_form() is still
    assert still != BOTH
    with pytest.raises((TypeError, ValueError), match="rate"):  # the latter before Python 3.13
        replace(BOTH, rate=still.rate)


@pytest.mark.parametrize("view", [ONE, OTHER, BOTH, "square"], ids=["one", "other", "both", "square"])
def test_every_step_that_leads_on_leads_to_the_rate(view):
    form = StructureAndMotion(("v_c1", "v_c2", "v_c3")).form if view == "square" else view
    steps = [step for step in form.derivation() if step.leads_on]
    assert len(steps) == 3
    assert all(step.onward(list(step.values.values())) == form.rate for step in steps)
    assert list(steps[0].values.values()) == list(form.w.T), "in the order in which it is shown"
    w, phi, g = ([2 * value for value in step.values.values()] for step in steps)
    assert steps[0].onward(w) == replace(form, w=2 * form.w).rate
    assert steps[1].onward(phi) == replace(form, phi=2 * form.phi).rate
    assert steps[2].onward(g) == replace(form, g=2 * form.g).rate


def test_the_form_shows_its_parts():
    assert sp.latex(ONE.w.T) in str(ONE.derivation())
    assert sp.latex(ONE.g) in ONE._repr_latex_()
    assert all(sp.latex(entry) in AFFINE.partition("y2")._repr_latex_() for entry in AFFINE.rate)
    assert AFFINE.values == {}
