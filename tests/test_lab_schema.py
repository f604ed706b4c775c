"""Whatever is set in a lab, by hand or by the page, is read as plain data or refused with a reason and taken back."""

import inspect
import json
import pickle

import numpy as np
import pytest
import sympy as sp

from percept_obs.labs import observer_lab, points_lab, structure_lab
from percept_obs.labs.shared.lab import BadSettings
from percept_obs.labs.shared.schema import Kind, Number, Row

LABS = {make.__name__: make for make in (observer_lab, structure_lab, points_lab)}
HOSTILE = [
    *(None, True, 5, -1, 1e9, float("nan"), float("inf"), 1 + 2j, "1", "", "x' = 1", b"1"),
    *([], [None], [[]], [[1, 2], [3]], ["y1", "y1"], [1, 2, float("nan")], [True] * 3, ["1"] * 3, [[[0.0] * 3] * 3]),
    *({}, {"kind": "pink"}, {"kind": None, "size": {}}, {1: 2}, {"mode": "own", "values": "abc"}, {"A": 1, "b": 2}),
    *(np.zeros((2, 2)), np.full(3, np.nan), np.array(["a"]), np.array(3.0), sp.Symbol("x"), object(), {1, 2}, range(3)),
    *({"identifier_based": 5}, {"identifier_based": {"gain": None}}, {"ideal": {"feedback": "1"}}, {"seed": "../.."}),
]


@pytest.fixture(scope="module", params=LABS)
def lab(request):
    """Each lab, with a run so short that its analysis compiles nothing."""
    return LABS[request.param](duration=2.0)


def refusal_of(act):
    """The ValueError that an act ends with, if any."""
    try:
        act()
    except ValueError as error:
        return error
    return None


def test_every_setting_takes_what_is_of_its_kind_and_nothing_else(lab):
    before = lab.settings
    for name in before:
        for value in HOSTILE:
            refusal = refusal_of(lambda changed={**before, name: value}: setattr(lab, "settings", changed))
            if refusal is None:
                assert json.loads(json.dumps(lab.settings, allow_nan=False)) == lab.settings
                lab.settings = before
                continue
            assert isinstance(refusal, BadSettings)
            assert name in ("kept", "points", "surface") or name in str(refusal)
            assert any(
                part in str(refusal) for part in ("it must", "there are", "cannot be used", "has no", "is needed")
            )
            assert lab.settings == before


@pytest.mark.parametrize("whole", [None, 5, "settings", [], [("seed", 1)], {1: 2}, {"seed": 1, None: 2}])
def test_settings_that_are_none_are_refused(lab, whole):
    before = lab.settings
    with pytest.raises(ValueError, match=r"they must be a mapping of|there is no setting"):
        lab.settings = whole
    assert lab.settings == before


def test_the_page_changes_settings_and_nothing_else(lab):
    before, model = lab.settings, lab.model
    for value in HOSTILE:
        for wrong in (value, {**before, "period": value}, {**before, "kept": value}):
            message = {"settings": wrong, "summary": {}, "model": value, "texts": value, "parts": ["/etc/passwd"]}
            refusal = refusal_of(lambda message=message: lab.set_state(message))
            assert refusal is None or str(refusal) in lab.error
            assert lab.check(lab.settings) == lab.settings
            lab.settings = before
    assert lab.model is model
    assert lab.texts.startswith(b"\x1f\x8b")
    lab.set_state({"settings": {**before, "seed": 1}, "summary": {"serial": 9}})
    assert (lab.error, lab.settings["seed"], lab.analysis["serial"]) == ("", 1, 9)
    lab.settings = before


def test_arrays_and_numbers_of_numpy_are_read_as_plain_data():
    lab = observer_lab(A=np.eye(3), b=(np.float32(0.5), 0, 1), seed=np.int64(3))
    assert lab.settings["A"] == np.eye(3).tolist()
    assert [type(value) for value in (*lab.settings["b"], lab.settings["seed"])] == [float] * 3 + [int]


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
        Row(entries=[Number(), Number(low=-1, high=1, zero=False, reason="why")]).read("n", [0, 0])


def test_a_kind_of_its_own_says_what_it_expects_and_how_it_reads():
    with pytest.raises(NotImplementedError):
        Kind().read("it", 1)
    assert pickle.loads(pickle.dumps(Number(low=1))).low == 1
