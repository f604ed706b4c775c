"""A map of the image is the bound at each place, quickly, with the focus of expansion where the motion has it."""

import numpy as np
import pytest
from examples import AFFINE
from refusals import refuses
from sample_sizes import sampled

from percept_obs import (
    Camera,
    Gaussian,
    PerspectiveSystem,
    Scenario,
    affine,
    bound_map,
    cramer_rao,
    figures,
    pinhole,
    plane,
    record,
    rigid,
    scenarios,
    sphere,
)
from percept_obs.observability.maps import displacements

EQ35 = scenarios.ma2005_eq35().motion
SYSTEM = PerspectiveSystem(EQ35, pinhole())
FORWARDS = PerspectiveSystem(affine(np.zeros((3, 3)), [0.1, 0, -0.5]), pinhole())
TURNING = rigid(
    camera_angular_velocity=lambda t: (0, -0.3 * np.sin(t), -0.1), camera_velocity=lambda t: (0.3, 0, 0.1 + 0.1 * t)
)


@pytest.mark.parametrize("measured", [("y1", "y2"), ("y2",)], ids="+".join)
@pytest.mark.parametrize(
    ("motion", "symbols", "surface"),
    [
        pytest.param(EQ35, affine(), pinhole(), id="pinhole"),
        pytest.param(EQ35, affine(), sphere(), id="sphere", marks=pytest.mark.slow),
        pytest.param(TURNING, rigid(), pinhole(), id="a motion that varies", marks=pytest.mark.slow),
    ],
)
def test_each_place_has_the_bound_of_a_point_that_begins_there(motion, symbols, surface, measured):
    """The map adds information in space, the bound runs a filter in the image: neither uses the other's formulas."""
    system = PerspectiveSystem(motion, surface)
    found = bound_map(system, 1.0, 4.0, measured, (-0.5, 0.6), (-0.4, 0.3), 8)
    for i, j in ((0, 0), (5, 2), (7, 7)):
        start = surface.locate([found.y1[j], found.y2[i], 1 / 4])
        recording = record(Scenario("place", motion, start, 1.0, surface), camera=Camera(0.05, Gaussian(0.01)))
        form = PerspectiveSystem(symbols, surface).partition(*measured)
        expected = cramer_rao(recording, form, noise_variance=1e-4 / 3).relative[-1]
        assert found.relative[i, j] == pytest.approx(expected, rel=1e-8)


def test_least_is_known_at_the_focus_of_expansion():
    found = bound_map(FORWARDS, resolution=sampled(41, 201))
    worst = np.unravel_index(np.nanargmax(found.relative), found.relative.shape)
    np.testing.assert_allclose((found.y1[worst[1]], found.y2[worst[0]]), (-0.2, 0), atol=0.03)
    assert found.at(-0.2, 0) > 50 * found.at(0.8, 0.8)
    assert "at worst" in repr(found)


def test_a_point_that_comes_behind_the_camera_has_no_value():
    fast = PerspectiveSystem(affine([[0, 0, 0], [0, 0, 0], [-1, 0, 0]], [0.1, 0, -0.5]), pinhole())
    found = bound_map(fast, 2.0, resolution=9)
    assert np.isnan(found.relative[:, -1]).all()
    assert np.isfinite(found.relative[:, 0]).all()
    assert f"{np.isnan(found.relative).sum()} of 81 places are empty" in figures.bound_map(found).text


def test_displacements_are_where_points_get():
    times = np.linspace(0, 2, 5)
    for motion in (EQ35, TURNING):
        Phi, d = displacements(motion, times)
        points = Scenario("point", motion, (0.5, -0.3, 6), 2, pinhole()).points(times)
        np.testing.assert_allclose(Phi @ (0.5, -0.3, 6) + d, points, rtol=1e-8)


def test_the_figure_names_its_best_and_worst_places():
    found = bound_map(FORWARDS, resolution=11)
    figure = figures.bound_map(found, threshold=0.05)
    (ax, bar) = figure.figure.axes
    np.testing.assert_allclose(ax.images[0].get_array(), 100 * found.relative)
    assert ax.patches[0].get_radius() == pytest.approx(0.1)
    assert ax.patches[0].center == pytest.approx((-0.2, 0))
    assert "The focus of expansion is at (-0.2, 0)." in figure.text
    assert f"{100 * np.nanmax(found.relative):.3g} % at worst" in figure.text
    assert bar.get_ylabel() == "least error of the distance (%)"
    one = figures.bound_map(bound_map(SYSTEM, measured=("y1",), resolution=5))
    assert "Measuring y1 alone, w vanishes nowhere." in one.text
    sideways = PerspectiveSystem(affine(np.zeros((3, 3)), [0.5, 0, 0]), pinhole())
    assert "no focus of expansion" in figures.bound_map(bound_map(sideways, resolution=5)).text


test_what_makes_no_sense_is_refused = refuses(
    lambda arguments: bound_map(**{"system": SYSTEM} | arguments),
    ({"system": AFFINE}, "no values for a11"),
    ({"seconds": 0.0}, "seconds is 0"),
    ({"distance": -1.0}, "distance is -1"),
    ({"y1": (1.0, -1.0)}, "the smaller one first"),
    ({"measured": ("y3",)}, "name at least one of y1, y2"),
    ({"seconds": 1e300}, "lower the resolution or the seconds"),
    ({"distance": 1e308}, "tell less than rounding takes away"),
    ({"resolution": 1}, "two places or more"),
    ({"resolution": 5000}, "lower the resolution"),
    ({"system": PerspectiveSystem(EQ35, plane((0.0, 0.0, 1.0), outputs=3))}, "a map is of two"),
)


test_the_figure_refuses_what_is_no_map_or_no_threshold = refuses(
    lambda found: figures.bound_map(found or bound_map(SYSTEM, resolution=3), threshold=0),
    (1, "expected a BoundMap"),
    (None, "must be positive"),
)
