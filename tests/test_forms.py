"""The canonical form is the system again, and exists only where the measured rate is affine in the rest."""

import pytest
import sympy as sp
from examples import AFFINE, BOTH, MOTIONS, ONE, OTHER, SURFACES

from percept_obs import NotAffine, PerspectiveSystem, affine
from percept_obs.forms import split

OUTPUTS = [("y1",), ("y2",), ("y1", "y2"), ("y2", "y1")]
FLAT = {name: surface for name, surface in SURFACES.items() if name != "sphere"}


@pytest.mark.parametrize("names", OUTPUTS, ids="+".join)
@pytest.mark.parametrize("surface", FLAT.values(), ids=FLAT)
@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_the_form_is_the_system_again(motion, surface, names):
    system = PerspectiveSystem(motion, surface)
    form = system.measure(*names)
    rates = dict(zip(system.coordinates, system.rate, strict=True))
    again = [rates[symbol] for symbol in (*form.x1, *form.x2)]
    assert (form.rate - sp.ImmutableMatrix(again)).expand() == sp.zeros(len(again), 1)
    assert not (form.w.free_symbols | form.phi.free_symbols) & set(form.x2)
    assert form.measured == names


def test_one_output_of_the_pinhole():
    a12, a32, b1, b3, y1 = sp.symbols("a12 a32 b1 b3 y1", real=True)
    assert ONE.w == sp.Matrix([a12 - a32 * y1, b1 - b3 * y1])
    assert ONE.hidden == ("y2", "y3")
    assert OTHER.hidden == ("y1", "y3")
    assert BOTH.w.shape == (1, 2)


def test_a_sphere_needs_both_outputs():
    system = PerspectiveSystem(affine(), SURFACES["sphere"])
    assert system.measure("y1", "y2").hidden == ("y3",)
    with pytest.raises(NotAffine, match="not affine in y2, y3; measure y2 as well") as refusal:
        system.measure("y1")
    assert refusal.value.measured == ("y1",)
    assert refusal.value.culprits == ("y2", "y3")


def test_only_the_guilty_coordinate_is_named():
    x, y, z = sp.symbols("x y z", real=True)
    with pytest.raises(NotAffine) as refusal:
        split((x, y, z), sp.ImmutableMatrix([x * z + y**2, y, z]), ["x"], ())
    assert refusal.value.culprits == ("y",)


def test_an_affine_rate_in_disguise_is_accepted():
    x, y = sp.symbols("x y", real=True)
    form = split((x, y), sp.ImmutableMatrix([(y**2 - x**2) / (y - x), y]), ["x"], ())
    assert form.w == sp.Matrix([1])
    assert form.phi.subs(x, 3) == sp.Matrix([3])


def test_the_form_shows_its_parts():
    assert sp.latex(ONE.w.T) in str(ONE.derivation())
    assert sp.latex(ONE.g) in ONE._repr_latex_()
    assert AFFINE.values == {}
