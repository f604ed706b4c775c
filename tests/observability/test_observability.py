"""An instant suffices with both outputs off the focus of expansion, and never with one; a window may."""

import numpy as np
import pytest
import sympy as sp
from examples import BOTH, NOISY, ONE

from percept_obs import (
    Camera,
    ImagingSurface,
    PerspectiveSystem,
    Recording,
    StructureAndMotion,
    affine,
    instantaneous,
    plane,
    record,
    scenarios,
    sphere,
    windowed,
)
from percept_obs.observability.windows import instants
from percept_obs.system.surfaces import POINT

b1, b2, b3, y1, y2 = sp.symbols("b1 b2 b3 y1 y2", real=True)


def test_both_outputs_suffice_off_the_focus_of_expansion():
    found = instantaneous(BOTH)
    assert found.suffices
    assert sp.expand(found.determinant - (b1 - b3 * y1) ** 2 - (b2 - b3 * y2) ** 2) == 0
    assert found.condition == (b1 - b3 * y1) ** 2 + (b2 - b3 * y2) ** 2
    assert found.zero_set == [{y1: b1 / b3, y2: b2 / b3}]
    assert "can suffice" in found._repr_latex_()


def test_one_output_never_suffices():
    found = instantaneous(ONE)
    assert (found.rank, found.suffices, found.determinant) == (1, False, 0)
    assert sp.expand(found.information.det()) == 0
    assert "no instant suffices" in found._repr_latex_()
    with pytest.raises(ValueError, match="no circle"):
        found.circle(0.1)


def test_the_circle_around_the_focus_of_expansion():
    centre, radius = instantaneous(BOTH).circle(0.1)
    assert centre == (b1 / b3, b2 / b3)
    assert radius == sp.Float(0.1) / sp.Abs(b3)
    centre, radius = instantaneous(PerspectiveSystem(affine(), plane()).measure("y1", "y2")).circle(1)
    n1, n2, n3 = sp.symbols("n1:4", real=True)
    assert sp.cancel(centre[0] - b1 / (n1 * b1 + n2 * b2 + n3 * b3)) == 0
    assert sp.expand(1 / radius**2 - (n1 * b1 + n2 * b2 + n3 * b3) ** 2) == 0


def test_where_no_circle_can_be_the_places_where_w_vanishes_are_not_sought():
    """Sympy needs 12 s of computing for them on this surface, each time that its image is drawn."""
    X, Y, Z = POINT
    R = sp.sqrt(X**2 + Y**2 + Z**2)
    q = y1**2 + y2**2
    own = ImagingSurface("own", (X / (R + Z), Y / (R + Z)), R, (2 * y1 / (1 + q), 2 * y2 / (1 + q), (1 - q) / (1 + q)))
    found = instantaneous(PerspectiveSystem(affine(), own).measure("y1", "y2"))
    assert found.growth is None
    assert "zero_set" not in vars(found)


def test_lost_samples_are_interpolated_where_there_is_no_truth():
    whole = record(scenarios.ma2005_eq35(), 20, NOISY, seed=1)
    lossy = record(scenarios.ma2005_eq35(), 20, Camera(noise=NOISY.noise, dropout=0.3), seed=1)
    bare = [Recording(r.time, r.outputs, r.names, r.view, r.motion) for r in (whole, lossy)]
    least = [windowed(ONE, r, 5).smallest for r in bare]
    np.testing.assert_allclose(least[1], least[0], rtol=0.1, atol=1e-3)


@pytest.mark.parametrize("window", [0, -1, 21])
def test_windows_that_do_not_fit_are_refused(window):
    with pytest.raises(ValueError, match="must be positive and at most 20 s"):
        windowed(ONE, record(scenarios.ma2005_eq35(), 20), window)


def test_a_window_holds_the_integral_of_what_its_instants_show():
    recording = record(scenarios.ma2005_eq35(), 3, Camera(0.01))
    whole, at = windowed(ONE, recording, 3.0), instants(ONE, recording)
    assert len(whole.time) == 1
    for found, shown in ((whole.matrices, at.matrices), (whole.scale, at.scale)):
        np.testing.assert_allclose(found[0], np.trapezoid(shown, recording.time, axis=0), rtol=1e-9)


def test_one_output_has_the_eigenvalues_0_and_what_is_printed():
    """(18) asks for the smaller one, (20) prints the larger one; the characteristic polynomial says so."""
    found = instantaneous(ONE)
    value = sp.Symbol("lambda")
    expected = sp.Mul(*(value - each for each in found.eigenvalues)).expand()
    assert sp.expand((value * sp.eye(2) - found.information).det() - expected) == 0
    assert found.eigenvalues[0] == 0
    a12, a32 = sp.symbols("a12 a32", real=True)
    assert sp.expand(found.eigenvalues[1] - (a12 - a32 * y1) ** 2 - (b1 - b3 * y1) ** 2) == 0
    assert found.condition == 0
    with pytest.raises(ValueError, match="no short form"):
        _ = instantaneous(StructureAndMotion(("v_p1", "v_p2", "v_p3")).form).eigenvalues


def test_the_condition_is_shown_in_factors():
    """On the sphere w is not zero at the focus of expansion by chance: its factors have the same zeros."""
    system = PerspectiveSystem(affine([[0] * 3] * 3, [1, 2, 2]), sphere())
    found = instantaneous(system.measure("y1", "y2"))
    focus = dict(zip(found.form.x1, system.foe.subs(system.values), strict=True))
    values = found.form.values | system.values
    assert [sp.simplify(entry.subs(values).subs(focus)) for entry in found.factors] == pytest.approx([0, 0], abs=1e-12)
