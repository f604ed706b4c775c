"""The derivation desk reads and judges what is typed, line by line, and every student has a system of her own."""

import xml.etree.ElementTree as ElementTree

import pytest
from test_checking_reading import CANARY, HOSTILE

from percept_obs import PerspectiveSystem, affine, plane, rigid
from percept_obs.checking.explaining import plain
from percept_obs.labs import derivation_desk
from percept_obs.labs.desk.settings import LONGEST_LINE, SCHEMA
from percept_obs.labs.desk.sheets import PARTS, name_of, sheet_of
from percept_obs.labs.desk.systems import OBSERVERS, SURFACES, system_of, system_of_student

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


def told(line):
    """The hints on a line as one text, with formulas as they are typed."""
    return "; ".join("".join(p.get("text", "") or in_text(p["math"]) for p in sentence) for sentence in line["told"])


def in_text(mathml):
    """The letters of a simple product."""
    tree = as_tree(mathml)
    return " ".join("".join(node.itertext()) for node in tree.iter() if node.tag == "msub")


def as_tree(mathml):
    """MathML as a tree; it fails where it is not well formed."""
    return ElementTree.fromstring(f"<math>{mathml.replace('&InvisibleTimes;', '').replace('&nbsp;', ' ')}</math>")


@pytest.mark.parametrize("name", MISTAKES)
def test_three_mistakes_are_named_with_their_step_hint_by_hint(name):
    text, slip, step = MISTAKES[name]
    first = answer({"y1'": text})
    begun = name == "forgotten"  # all that is there is right
    found = ("Right so far: 4 terms are missing.", "begun", []) if begun else ("Not right yet.", "", [])
    assert (first["words"], first["lines"][0]["mark"], first["lines"][0]["told"]) == found
    assert (first["hint"], first["says"]) == (2, "which term")
    second = answer({"y1'": text}, 2)
    assert second["lines"][0]["mark"] == "wrong"
    assert slip not in told(second["lines"][0])
    assert "in step" not in told(second["lines"][0])
    third = answer({"y1'": text}, 3)
    assert slip in told(third["lines"][0])
    assert "in step" not in told(third["lines"][0])
    fourth = answer({"y1'": text}, 4)
    assert step in told(fourth["lines"][0])
    assert fourth["hint"] == 0


def test_a_bracket_without_its_factor_is_named_term_by_term():
    lacking = f"a13 + (a11 - a33) y1 + {TAIL.removesuffix(' + b1 y3')} + (b1 - b3 y1)"
    assert answer({"y1'": lacking}, 2)["lines"][0]["told"][0][0]["text"] == "look at "
    shown = told(answer({"y1'": lacking}, 3)["lines"][0])
    assert "b1 should be b1 y3" in shown
    assert "b3 y1 should be b3 y1 y3" in shown


def test_two_slips_are_told_apart_each_with_its_steps():
    two = f"a13 + (a11 + a33) y1 + {TAIL} + b3 y1 y3"
    assert (answer({"y1'": two}, 3)["hint"], answer({"y1'": two}, 3)["says"]) == (4, "which step")
    shown = told(answer({"y1'": two}, 4)["lines"][0])
    assert "the first slip comes out so if in step 5" in shown
    assert "the second slip comes out so if in step" in shown


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


def test_a_right_line_is_said_to_be_right_at_once():
    found = answer({"y1'": f"y1' = {RIGHT}"})
    assert (found["words"], found["right"], found["lines"][0]["mark"]) == ("Right so far, 1 of 3 lines.", True, "right")
    assert found["steps"][5] == {"mark": "right", "given": 1, "asked": 3}


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


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize(
    "surface", ["chained", *(pytest.param(s, marks=pytest.mark.slow) for s in ("plane", "sphere"))]
)
def test_every_line_takes_its_own_formula(part, surface):
    system = system_of("affine", surface)
    outputs = system.output_choices[-1]
    for observer in OBSERVERS if part in ("observer", "error") else ["identifier_based"]:
        sheet = sheet_of(system, outputs, observer, part)
        for number, step in enumerate(sheet.derivation, 1):
            lines = {name: plain(value) for name, value in step.values.items()}
            lines = {name: text for name, text in lines.items() if len(text) < LONGEST_LINE}
            found = answer(lines, step=number, part=part, surface=surface, outputs=outputs, observer=observer)
            assert found["right"], (observer, found)


@pytest.mark.parametrize("text", HOSTILE[::6], ids=range(len(HOSTILE[::6])))  # all of them where text is read
def test_nothing_that_is_typed_is_run(text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    desk = derivation_desk()
    message = {"settings": {**desk.settings, "step": 6, "typed": {"rate 6 y1'": text}}, "summary": {"serial": 1}}
    if len(text) > LONGEST_LINE:
        with pytest.raises(ValueError, match="at most 2000 characters"):
            desk.set_state(message)
        return
    desk.set_state(message)
    assert desk.analysis["serial"] == 1
    line = desk.analysis["lines"][0]
    assert line.get("refusal") or not text.strip()
    assert not any(CANARY in path.name for path in tmp_path.iterdir())


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
    assert (str(system.rate[0]), outputs) == PINNED
    assert system_of_student(" ada ")[0].rate == system.rate
    desk = derivation_desk(student="Ada", surface="sphere")
    assert desk.sheet().goal.lines[-3].name == derivation_desk().sheet().goal.lines[-3].name
    assert "sphere" not in desk.sheets["student Ada, rate"]["title"]


PINNED = ("a11*y1 + a13*y2 - a22*y1 - a23*y1*y2 + b1*y3 - b2*y1*y3", ("y2",))


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
    with pytest.raises(
        ValueError, match="on the sphere surface what is hidden can be separated if y1 and y2 is measured"
    ):
        derivation_desk(surface="sphere", outputs=["y1"])


def test_every_setting_opens_with_what_is_of_its_kind_and_is_in_the_docstring():
    for name, kind in SCHEMA.items():
        assert kind.read(name, derivation_desk(student="").settings[name]) == kind.opening
        assert f"\n{name} : " in derivation_desk.__doc__
