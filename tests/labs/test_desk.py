"""The derivation desk reads and judges what is typed, line by line, and every student has a system of her own."""

import xml.etree.ElementTree as ElementTree

import pytest

from percept_obs import PerspectiveSystem, affine, plane, rigid
from percept_obs.labs import derivation_desk
from percept_obs.labs.desk.sheets import name_of
from percept_obs.labs.desk.systems import SURFACES, system_of, system_of_student

TAIL = "a12 y2 - a31 y1^2 - a32 y1 y2 + b1 y3"
RIGHT = f"a13 + (a11 - a33) y1 + {TAIL} - b3 y1 y3"
MISTAKES = {
    "wrong sign": (RIGHT.replace("- b3", "+ b3"), "the sign of b3 y1 y3 is wrong", "in step 6"),
    "swapped index": (RIGHT.replace("a12 y2", "a21 y2"), "a21 stands where a12 belongs", "in step 5"),
    "forgotten": (
        "a13 + a11 y1 + a12 y2 + b1 y3",
        "y1 y3: you have 0, it is -1",
        "in step 4 “Derivatives of the image coordinates, and of the distance l, taken on the ray”, the derivative of "
        "y1 = X/Z with respect to Z was left out",
    ),
}


def answer(typed, hints=0, step=6, part="rate", **settings):
    """Return the desk's answer to lines of a step by their names."""
    lines = {f"{part} {step} {name}": text for name, text in typed.items()}
    desk = derivation_desk(part=part, step=step, typed=lines, hints={f"{part} {step}": hints}, **settings)
    return desk.analysis


def as_tree(mathml):
    """MathML as a tree; it fails where it is not well formed."""
    return ElementTree.fromstring(f"<math>{mathml.replace('&InvisibleTimes;', '').replace('&nbsp;', ' ')}</math>")


def test_a_beginning_is_right_so_far_and_a_slip_in_it_is_not():
    for count, text in [(5, "a13 + (a11 - a33) y1"), (1, f"a13 + (a11 - a33) y1 + {TAIL}")]:
        found = answer({"y1'": text})
        terms = f"{count} terms are" if count > 1 else "a term is"
        assert found["words"] == f"Right so far: {terms} missing."
        assert found["lines"][0]["mark"] == "begun"
    assert answer({"y1'": "a13 - a11 y1"})["words"] == "Not right yet."


def test_the_first_hint_says_which_of_several_lines():
    lines = {"y1'": MISTAKES["wrong sign"][0], "y3'": "-y3 (a31 y1 + a32 y2 + a33 + b3 y3)"}
    closed = answer(lines)
    assert closed["words"] == "1 of 2 lines is not right yet."
    assert [line["mark"] for line in closed["lines"]] == ["", "", ""]
    assert [line["mark"] for line in answer(lines, 1)["lines"]] == ["wrong", "", "right"]


def test_an_error_is_carried_from_step_to_step():
    lines = {"rate 5 the velocity along Z": "a31 y1 + a32 y2 + a33 - b3 y3"}
    lines["rate 6 y3'"] = "-y3 (a31 y1 + a32 y2 + a33 - b3 y3)"
    found = derivation_desk(step=6, typed=lines).analysis
    assert found["words"].startswith("Right from there on: this follows from your “The velocity")
    assert derivation_desk(step=6, typed={"rate 6 y3'": lines["rate 6 y3'"]}).analysis["words"] == "Not right yet."


def test_the_numbers_of_steps_are_those_of_the_derivation():
    steps = [step.reason for step in derivation_desk().sheet().derivation]
    derivation = [step.reason for step in system_of("affine", "pinhole").derivation()]
    assert steps[:6] == derivation[:6]
    assert steps[6] == derivation[7]  # what is only multiplied out is not asked for again
    assert all(len(name_of(reason).split()) <= 3 for reason in steps)


@pytest.mark.parametrize(
    ("text", "refusal"),
    [
        ("y2' = a21", "this is the line for y1'; type its right side only"),
        ("y1; y2", "one formula is asked for here, without other equations or relations"),
        ("y1 + 0 = y2 + 1", "one formula is asked for here"),
        ("[y1, y2]", "one formula is asked for here"),
        ("y1 + q", '"q" is no letter here'),
    ],
)
def test_a_line_that_does_not_fit_is_refused(text, refusal):
    line = answer({"y1'": text})["lines"][0]
    assert line["refusal"].startswith(refusal)
    assert line["mark"] == ""


def test_a_system_follows_from_a_name_on_every_machine():
    system, outputs = system_of_student("Ada")
    rate = "a11*y1 + a13*y2 - a22*y1 - a23*y1*y2 + b1*y3 - b2*y1*y3"
    assert (str(system.rate[0]), outputs) == (rate, ("y2",))
    assert system_of_student(" ada ")[0].rate == system.rate
    desk = derivation_desk(**{**derivation_desk(student="Ada").settings, "surface": "sphere"})
    assert desk.sheet().goal.lines[-3].name == derivation_desk().sheet().goal.lines[-3].name
    assert "sphere" not in desk.sheets["student Ada, rate"]["title"]


def test_neighbours_have_different_systems():
    rates = {(system.rate, outputs) for system, outputs in map(system_of_student, map(str, range(16)))}
    assert len(rates) > 14
    for rate, _ in rates:
        assert rate[2] != 0
        assert max(len(str(entry)) for entry in rate) < 120


def test_a_system_of_ones_own_can_be_given():
    system = PerspectiveSystem(rigid(), plane((0.1, 0.2, 1.0), outputs=3))
    desk = derivation_desk(system, step=6)
    printed = desk.sheets["own, rate"]
    assert (printed["title"], printed["outputs"]) == ("rigid motion on the plane surface", ["y1", "y2", "y3"])
    assert derivation_desk(PerspectiveSystem(affine(), SURFACES["chained"]())).system()[0].surface.name == "chained"
    with pytest.raises(ValueError, match="system is the number 5; expected a PerspectiveSystem"):
        derivation_desk(5)


def test_outputs_that_leave_what_is_hidden_inseparable_are_refused():
    with pytest.raises(ValueError, match="what is hidden can be separated if y1 and y2 is measured"):
        derivation_desk(surface="sphere", outputs=["y1"])
