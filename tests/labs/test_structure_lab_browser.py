"""The lab of structure and motion does what it promises: ticking, dragging, telling, and surviving."""

import pytest
from lab_browser import assert_has, assert_structure_is_python, control, rested, state

from percept_obs.labs.structure.lab import structure_lab, unknowns_of
from percept_obs.structure import ImpossibleChoice

pytestmark = [pytest.mark.browser, pytest.mark.slow]

TOLD = ".unknowns .told"


@pytest.fixture(scope="module")
def python():
    """The lab in Python."""
    return structure_lab(duration=3.0, period=0.01, step=0.001)


def test_a_box_is_ticked_off_and_the_reason_is_python_s(fresh, python):
    before = state(fresh)
    fresh.uncheck(control("known v_c1"))
    rested(fresh)
    refused = state(fresh)
    with pytest.raises(ImpossibleChoice) as reason:
        unknowns_of(refused["settings"])
    assert fresh.inner_text(f"{TOLD} .refused").lower() == f"{reason.value}.".lower()
    assert refused["runs"] == {}
    assert set(refused["drawn"]) == {"first"}
    assert_has(python, refused["settings"])
    fresh.check(control("known v_c1"))
    rested(fresh)
    assert state(fresh) == before


def test_fewer_unknowns_are_solved_by_least_squares(fresh):
    fresh.check(control("known v_c3"))
    fresh.check(control("known d_s"))
    rested(fresh)
    shown = state(fresh)
    assert shown["settings"]["unknown"] == ["v_c2"]
    assert "least squares" in fresh.inner_text(TOLD)
    assert_structure_is_python(shown)


@pytest.mark.parametrize("number", [3, 5])
def test_a_corollary_is_one_click(fresh, number):
    fresh.click(control(f"corollary {number}"))
    rested(fresh)
    shown = state(fresh)
    assert f"Corollary {number}," in fresh.inner_text(TOLD)
    assert fresh.get_attribute(control(f"corollary {number}"), "aria-pressed") == "true"
    assert shown["verdicts"][0].startswith("ISMO, ideal switch: converged")
    assert_structure_is_python(shown)
    if number == 5:
        fresh.check(control("earlier"))
        rested(fresh)
        assert "Corollary 2," in fresh.inner_text(TOLD)
        assert_structure_is_python(state(fresh))


def test_the_determinant_has_its_formula_and_its_number(fresh):
    text = fresh.inner_text(TOLD)
    assert "at the start" in text
    assert "Not observable where ybar3 = 0" in text
    value = float(fresh.inner_text(f"{TOLD} .value").replace("−", "-").split()[1])
    assert value == pytest.approx(-0.22 * 0.05**4, rel=0.01)
    fresh.fill(control("v_c1 number"), "-0.44")
    rested(fresh)
    twice = float(fresh.inner_text(f"{TOLD} .value").replace("−", "-").split()[1])
    assert twice == pytest.approx(2 * value, rel=0.01)


def test_the_limit_of_the_layer_is_told_with_its_remedy(fresh):
    fresh.click(control("choose layer"))
    fresh.fill(control("duration number"), "60")
    rested(fresh)
    assert "from 34.4 s on" in state(fresh)["words"]
    assert "take the ideal switch" in state(fresh)["words"]
    fresh.fill(control("layer sharpening number"), "0")
    rested(fresh)
    assert "from 34.4 s on" not in state(fresh)["words"]


def test_too_many_steps_are_refused_where_they_were_typed(fresh):
    field = fresh.locator(control("step number"))
    fresh.fill(control("duration number"), "21")
    field.fill("0.0001")
    assert field.get_attribute("aria-invalid") == "true"
    assert state(fresh)["settings"]["step"] == 1e-3
