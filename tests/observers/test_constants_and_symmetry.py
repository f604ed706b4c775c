"""One output is slow for Ma's observer and not for the data; the equivariant filter keeps its range positive."""

import numpy as np
import pytest
from basin_study import study as basin
from examples import BOTH, FORMS, ON_SPHERE, ONE
from one_output_study import study as one_output

from percept_obs import Camera, PerspectiveSystem, Uniform, ekf, pinhole, record, rigid, scenarios, sized, sphere, track
from percept_obs.observers import NeedsMotion, equivariant_filter, gpebo


@pytest.mark.slow
def test_of_one_output_constants_are_found_as_fast_as_by_the_filter():
    rows = [row for row, _ in one_output(2, 6, (ONE,), {"uniform 0.01": Uniform(0.01)})]
    median = {(row[2], row[3]): row[4] for row in rows}
    for start in (0.0, 1.0):
        assert median["identifier_based", start] > 2.5 * median["gpebo", start]
        assert median["gpebo", start] < 1.5 * median["extended_kalman", start]


@pytest.mark.slow
def test_the_equivariant_filter_claims_too_much_where_it_began_too_near():
    rows = {(factor, key): (share, nees) for factor, key, share, _, nees, _ in basin(5, (0.1, 10.0))}
    assert all(share == 1 for share, _ in rows.values())
    assert rows[0.1, "equivariant_filter"][1] > 3 * rows[0.1, "extended_kalman"][1]
    assert rows[10.0, "equivariant_filter"][1] < 2


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_a_start_at_infinity_needs_no_guard_and_no_other_time(form):
    recording = record(scenarios.ma2005_eq35(), 5, Camera(0.01))
    near, far = (track(recording, gpebo(form), {"y3": y3}).settling_time(0.1) for y3 in (1.0, 0.0))
    assert far == pytest.approx(near, abs=0.2)
    assert far < 5


@pytest.mark.slow
def test_a_range_stays_positive_whatever_is_seen():
    filtered = track(
        record(scenarios.ma2005_eq35(), 2, Camera(0.05, Uniform(0.3))), equivariant_filter(BOTH), {"y3": 5}
    )
    assert filtered.estimate[:, 2].min() > 0
    assert np.isfinite(filtered.estimate).all()
    assert filtered.nis.shape == filtered.nees("y3").shape


def test_without_motion_or_with_what_gives_no_equation_they_say_so():
    with_size = PerspectiveSystem(rigid(), sized(pinhole())).measure("y1", "y2", "s")
    for make in (gpebo, equivariant_filter):
        assert isinstance(make.objection(with_size), NeedsMotion)
        assert "hidden" in make.refusal(ONE) or make is gpebo
    on_sphere = PerspectiveSystem(rigid(), sphere(3)).partition("y1", "y2", "y3")
    assert "has 3 outputs" in gpebo.refusal(on_sphere)
    assert "too long to compile" in equivariant_filter.refusal(on_sphere)
    assert not gpebo.refusal(ON_SPHERE.measure("y1", "y2"))
    assert ekf(BOTH).form.motion.A == BOTH.motion.A
