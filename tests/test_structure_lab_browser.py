"""The lab of structure and motion does what it promises: ticking, dragging, telling, and surviving."""

import pytest
from lab_alone import DRAWN, opened
from lab_browser import (
    UNFOLD,
    assert_fits,
    assert_has,
    assert_own_colours,
    control,
    drag_by_keys,
    drag_by_mouse,
    drag_by_touch,
    moved_by_keyboard,
    rested,
    serious_violations,
    state,
    usable,
    used_at_random,
)
from structure_settings import assert_same_structure_runs, structure_runs_of

from percept_obs.labs.structure.lab import structure_lab, unknowns_of
from percept_obs.structure import ImpossibleChoice

pytestmark = [pytest.mark.browser, pytest.mark.slow]

START = control("ybar")
TOLD = ".unknowns .told"


@pytest.fixture(scope="module")
def python():
    """The lab in Python."""
    return structure_lab()


def assert_is_python(shown):
    """What is drawn and said are the numbers and words of a Python run of the same settings."""
    told = {name: {"estimate": e, "divergedAt": shown["divergedAt"][name]} for name, e in shown["runs"].items()}
    settings = structure_lab(**shown["settings"]).settings
    assert_same_structure_runs(settings, told)
    for run in structure_runs_of(settings).values():
        words = [text.partition(": ")[2] for text in shown["verdicts"]]
        assert run.verdict(settings["tolerance"]) in words


@pytest.mark.parametrize("drag", [drag_by_mouse, drag_by_touch, drag_by_keys])
def test_the_start_follows_the_hand(fresh, python, drag):
    before = state(fresh)
    drag(fresh, START)
    rested(fresh)
    after = state(fresh)
    assert after["settings"]["ybar"][:2] != before["settings"]["ybar"][:2]
    assert after["settings"]["ybar"][2] == before["settings"]["ybar"][2]
    assert after["runs"] != before["runs"]
    assert after["labels"] != before["labels"]
    assert_is_python(after)
    assert_has(python, after["settings"])


def test_a_box_is_ticked_off_and_the_reason_is_python_s(fresh, python):
    before = state(fresh)
    fresh.uncheck(control("known v_c1"))
    rested(fresh)
    refused = state(fresh)
    with pytest.raises(ImpossibleChoice) as reason:
        unknowns_of(refused["settings"])
    assert fresh.inner_text(f"{TOLD} .refused").lower() == f"{reason.value}.".lower()
    assert refused["runs"] == {}
    assert set(refused["drawn"]) == {"image", "depth"}
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
    assert set(shown["drawn"]) == {"unknown1", "error", "determinant"}
    assert_is_python(shown)


@pytest.mark.parametrize("number", [3, 5])
def test_a_corollary_is_one_click(fresh, number):
    fresh.click(control(f"corollary {number}"))
    rested(fresh)
    shown = state(fresh)
    assert f"Corollary {number}," in fresh.inner_text(TOLD)
    assert fresh.get_attribute(control(f"corollary {number}"), "aria-pressed") == "true"
    assert shown["verdicts"][0].startswith("ISMO, ideal switch: converged")
    assert_is_python(shown)
    if number == 5:
        fresh.check(control("earlier"))
        rested(fresh)
        assert "Corollary 2," in fresh.inner_text(TOLD)
        assert_is_python(state(fresh))


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


@pytest.mark.parametrize(
    ("name", "value"), [("ideal feedback", "40"), ("noise size", "0.00001"), ("v_c2", "0.3"), ("period", "0.01")]
)
def test_a_number_changes_curves_and_words(fresh, name, value):
    before = state(fresh)
    fresh.fill(control(f"{name} number"), value)
    rested(fresh)
    after = state(fresh)
    assert after["runs"] != before["runs"]
    assert after["labels"] != before["labels"]
    assert_is_python(after)


def test_several_observers_stand_side_by_side(fresh):
    for name in ("layer", "extended_kalman", "identifier_based"):
        fresh.check(control(f"observer {name}"))
    for name in ("image", "depth", "innovation", "range"):
        fresh.check(control(f"picture {name}"))
    fresh.click(control("keep"))
    rested(fresh)
    shown = state(fresh)
    assert len(shown["runs"]) == 4
    dashes = fresh.evaluate("""() => [...window.perceptObsLabs][0].drawn.range.lines
        .filter((line) => !line.name.startsWith("kept")).map((line) => line.dash.join(" "))""")
    assert len(dashes) == len(set(dashes)) == 5
    starts = (
        "Image plane: the point goes from y1 0.32",
        "Scene, seen from the side: the point goes from",
        "Innovation over time",
    )
    for start in starts:
        assert any(label.startswith(start) for label in shown["labels"]), start
    assert "one gain for all unknowns" in fresh.inner_text(".why")
    assert_is_python(shown)


def test_the_limit_of_the_layer_is_told_with_its_remedy(fresh):
    fresh.click(control("preset limit"))
    assert "What will happen" in fresh.inner_text(".question")
    fresh.click(control("act limit 0"))
    rested(fresh)
    assert "from 34.4 s on" in fresh.inner_text(".why")
    assert "take the ideal switch" in fresh.inner_text(".why")
    fresh.click(control("act limit 1"))
    rested(fresh)
    assert "from 34.4 s on" not in fresh.inner_text(".why")
    fresh.click(control("way back"))
    rested(fresh)
    assert state(fresh)["settings"] == structure_lab().settings


def test_too_many_steps_are_refused_where_they_were_typed(fresh):
    field = fresh.locator(control("step number"))
    fresh.fill(control("duration number"), "21")
    field.fill("0.0001")
    assert field.get_attribute("aria-invalid") == "true"
    assert state(fresh)["settings"]["step"] == 1e-3


def test_every_control_is_reached_and_moved_by_keyboard(browser):
    settings = {
        "period": 0.02,
        "step": 0.01,
        "duration": 1.0,
        "observers": ["ideal", "layer"],
        "pictures": ["error", "depth"],
    }
    page = opened(browser, structure_lab(**settings))
    page.wait_for_function(DRAWN)
    page.evaluate(UNFOLD)
    page.check(control("swings"))
    assert len(moved_by_keyboard(page, "ybar")) > 60
    page.wait_for_function(DRAWN)
    page.close()


def test_axe_finds_nothing_serious(fresh):
    fresh.click(control("preset story"))
    assert serious_violations(fresh) == []


@pytest.mark.parametrize("width", [400, 800])
def test_the_lab_fits_its_cell(fresh, width):
    assert_fits(fresh, width)


def test_dark_and_light_have_their_own_colours(fresh):
    assert_own_colours(fresh)


def test_random_events_break_nothing_and_reset_restores_everything(fresh, python):
    opening, wanted = state(fresh), usable(fresh)
    assert wanted - used_at_random(fresh, 11, wanted) == set()
    shown = state(fresh)
    assert_has(python, shown["settings"])
    assert shown["problems"] == []
    fresh.click(control("reset"))
    rested(fresh, 60)
    assert state(fresh) == opening
    assert_is_python(opening)
