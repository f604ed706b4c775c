"""Whatever is set in a lab, by hand or by the page, is read as plain data or refused with a reason and taken back."""

import inspect
import json
import pickle

import numpy as np
import pytest
import sympy as sp
from lab_settings import whole_model
from refusals import refuses

from percept_obs.labs import derivation_desk, observer_lab, points_lab, structure_lab
from percept_obs.labs.shared.lab import BadSettings
from percept_obs.labs.shared.schema import (
    Choice,
    Entries,
    Flag,
    Group,
    Kind,
    Names,
    Number,
    Optional,
    Row,
    Several,
    Text,
)

LABS = {"observer_lab": observer_lab, "structure_lab": structure_lab, "points_lab": points_lab}


@pytest.fixture(scope="module")
def opened():
    """Each lab by its name, with a run so short that its analysis compiles nothing."""
    return {name: make(duration=2.0) for name, make in LABS.items()} | {"desk_lab": derivation_desk()}


@pytest.fixture(params=LABS)
def lab(opened, request):
    return opened[request.param]


@pytest.mark.parametrize("whole", [None, 5, "settings", [], [("seed", 1)], {1: 2}, {"seed": 1, None: 2}])
def test_settings_that_are_none_are_refused(lab, whole):
    before = lab.settings
    with pytest.raises(ValueError, match=r"they must be a mapping of|there is no setting"):
        lab.settings = whole
    assert lab.settings == before


def test_arrays_and_numbers_of_numpy_are_read_as_plain_data():
    lab = observer_lab(A=np.eye(3), b=(np.float32(0.5), 0, 1), seed=np.int64(3))
    assert lab.settings["A"] == np.eye(3).tolist()
    assert [type(value) for value in (*lab.settings["b"], lab.settings["seed"])] == [float] * 3 + [int]


def outside(kind, value):
    """Values just outside of a kind, or with one entry outside of its own, each with a part of the refusal."""
    if isinstance(kind, Optional):
        kind, value = kind.of, kind.of.opening
    bad = {
        Number: lambda: [
            kind.low - abs(kind.low) - 1,
            2 * abs(kind.high) + 1,
            float("nan"),
            True,
            "1",
            *([0.5] if kind.whole else []),
        ],
        Choice: lambda: ["no such", 7],
        Names: lambda: [["nothing"], [kind.names[0]] * 2, *([[]] if kind.least else [])],
        Text: lambda: ["x" * (kind.most + 1)],
        Flag: lambda: [1],
        Row: lambda: [[*value, value[0]], [], 7],
        Several: lambda: [[], [kind.of.opening] * (kind.most + 1)],
        Entries: lambda: [7, {"x" * (kind.longest + 1): ""}, dict.fromkeys(range(kind.most + 1)), {"it": object()}],
    }.get(type(kind), lambda: [7])()
    yield from ((each, "it must be ") for each in bad)
    if isinstance(kind, Number) and kind.nonzero:
        yield 0, "not 0"
    if isinstance(kind, Group):
        yield {**value, "nothing": 1}, "has no nothing; there are "
    inside = {Row: lambda: enumerate(kind.entries), Several: lambda: [(0, kind.of)]}
    inside = inside.get(type(kind), lambda: kind.of.items() if isinstance(kind, Group) else ())
    for place, of in inside():
        for entry, reason in outside(of, value[place]):
            changed = value.copy()
            changed[place] = entry
            yield changed, reason


ALIEN = (object(), 1j, b"1", {1, 2}, {1: 2}, sp.Symbol("x"))
"""Values that no setting takes."""


@pytest.mark.parametrize("name", [*LABS, "desk_lab"])
def test_whatever_lies_outside_of_its_kind_is_refused_by_its_name_and_changes_nothing(opened, name):
    lab = opened[name]
    before, refused = lab.settings, 0
    for setting, kind in lab.schema.items():
        for value, reason in (*outside(kind, before[setting]), *((each, "") for each in ALIEN)):
            with pytest.raises(BadSettings, match=rf"{setting}.*{reason}"):
                lab.settings = {**before, setting: value}
            refused += 1
    assert refused > 9 * len(before)
    assert lab.settings == before


test_what_is_expected_is_said_in_words = refuses(
    lambda make, settings: make(**settings),
    (observer_lab, {"colour": "red"}, "there is no setting colour"),
    (observer_lab, {"hold": "second"}, "hold is 'second'; it must be one of zero, first, exact"),
    (observer_lab, {"outputs": []}, "a list with at least one of y1, y2, s, each once"),
    (observer_lab, {"A": [1, 2, 3]}, "A 1 is 1; it must be a list of 3, each a number from -1000 to 1000"),
    (observer_lab, {"normal": [0.0, 1.0, 0.0]}, "normal n3 is 0.0; it must be .* not 0; the plane must not hold the"),
    (observer_lab, {"surface": "sphere", "outputs": ["y1"]}, r"it must be one of \['y1', 'y2'\]"),
    (observer_lab, {"gains": {"identifier_based": {"gain": -1.0}}}, "G > 0 is needed"),
    (observer_lab, {"observers": ["range_identification"], "outputs": ["y1"]}, "measure every image coordinate"),
    (observer_lab, {"kept": {"seed": -1}}, "whole number"),
    (points_lab, {"points": []}, "a list of 1 to 12, each a list of 3"),
    (points_lab, {"hidden": [None]}, "an entry for each of the 3 points"),
    (points_lab, {"hidden": [None, [3, 2], None]}, "hidden 2 is .* it must begin at 0 s or later"),
    (structure_lab, {"earlier": 1}, "must be True or False"),
    (structure_lab, {"gains": {"ideal": {"feedback": -1.0}}}, "k1 > 0 is needed"),
    (structure_lab, {"ybar": [0.3, 0.3, 0.0]}, "it must be positive, for the point is in front"),
    (structure_lab, {"noise": {"kind": "uniform", "size": 0.1}}, "noise depth is None"),
    (structure_lab, {"duration": 100, "step": 1e-4}, "1e[+]06 steps are too many"),
    (derivation_desk, {"hints": {"rate 1": 5}}, "it must be a whole number from 0 to 4"),
    (derivation_desk, {"typed": {"rate 1 X'": 5}}, "rate 1 X'.* is 5; it must be a text of at most 2000 characters"),
)


def leaves(kind):
    """A kind as the page has it, and all kinds inside it."""
    yield kind
    inside = kind.get("of", kind.get("entries", []))
    inside = [inside] if "kind" in inside and isinstance(inside["kind"], str) else inside
    for part in inside.values() if isinstance(inside, dict) else inside:
        yield from leaves(part)


def test_the_page_reads_each_range_in_the_schema_and_a_slider_stays_inside(lab):
    schema = lab.model["schema"]
    assert set(schema) == set(lab.settings)
    numbers = [kind for whole in schema.values() for kind in leaves(whole) if kind["kind"] == "number"]
    assert len(numbers) > 20
    for kind in numbers:
        low, high = kind.get("usual", (kind["low"], kind["high"]))
        assert kind["low"] <= low < high <= kind["high"]
        assert "usual" not in kind or low > 0 or "step" in kind


def test_what_a_lab_opens_with_is_of_its_kind_and_in_its_docstring(lab):
    for name, kind in lab.schema.items():
        assert kind.read(name, lab.settings[name]) == lab.settings[name]
        assert f"\n{name} : " in inspect.getdoc(type(lab))


def test_a_number_says_its_range_and_its_reason():
    whole = Number(low=0, high=2**32 - 1, whole=True)
    assert whole.expected == "a whole number from 0 to 4294967295"
    with pytest.raises(ValueError, match=r"^n 2 is 0; it must be a number from -1 to 1, not 0; why$"):
        Row(entries=[Number(), Number(low=-1, high=1, nonzero=True, reason="why")]).read("n", [0, 0])


def test_a_kind_of_its_own_says_what_it_expects_and_how_it_reads():
    with pytest.raises(NotImplementedError):
        Kind().read("it", 1)
    assert pickle.loads(pickle.dumps(Number(low=1))).low == 1


def test_settings_survive_json_and_are_completed(lab):
    before = lab.settings
    there = json.loads(json.dumps(before, allow_nan=False))
    lab.settings = {"seed": there["seed"]}
    assert set(lab.settings) == set(there)
    lab.settings = there
    assert lab.settings == before
    assert json.dumps(lab.model, allow_nan=False)


# A sign has no width to smooth it over, and no slope that would turn noise into a bias.
UNUSED = {
    ("range_identification", "sign", "boundary_layer"),
    ("integral_sliding_mode", "sign", "boundary_layer"),
    ("sliding_mode", "sign", "noise_variance"),
    ("sign", "", "boundary_layer"),  # the structure lab's name of an integral sliding mode observer
}


@pytest.mark.parametrize("name", ["observer_lab", "structure_lab"])
def test_every_gain_is_linked_to_a_letter_of_the_equations(opened, name):
    for observer, texts in whole_model(opened[name])["observers"].items():
        for switch, variants in texts["equations"].items():
            text = "".join(variants[-1]["lines"])
            assert variants[-1]["zero"] == []
            for gain in texts["ways"][switch]:
                unused = (observer, switch, gain) in UNUSED
                assert (f'data-letter="{gain}"' in text) != unused, (observer, switch, gain)
