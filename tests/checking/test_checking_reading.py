"""A formula is read as it is meant, or refused with its place and what is allowed; nothing is ever executed."""

import random
import re
import sys
from collections import Counter
from contextlib import suppress

import pytest
import sympy as sp
from examples import MOTIONS
from hostile_formulas import HOSTILE
from refusals import refuses

from percept_obs import CannotRead, PerspectiveSystem, check, pinhole
from percept_obs.checking import spelling
from percept_obs.checking.deciding import explicit, same
from percept_obs.checking.points import key
from percept_obs.checking.reading import read

LETTERS = {key(s.name): s for s in sp.symbols("y1 y2 y3 yhat1 a13 a31 v_c1 w1 lambda theta ybar3 d a3 y", real=True)}
y1, y2, y3, yhat1, a13, a31, v_c1, w1, lam, theta, ybar3, d, a3, y = LETTERS.values()


@pytest.mark.parametrize(
    ("text", "formula"),
    [
        ("y1^2 + y2**2", y1**2 + y2**2),
        ("-y1^2", -(y1**2)),
        ("2y1 y2", 2 * y1 * y2),
        ("2(y1 + y2)(y1 - y2)", sp.Mul(2, y1 + y2, y1 - y2)),
        ("a31y1²", a31 * y1**2),
        ("a31y1y2^3", a31 * y1 * y2**3),
        ("y1/y2*y3", y1 * y3 / y2),
        ("y1*-y2", -y1 * y2),
        ("1.25 y1 - .5", sp.Rational(5, 4) * y1 - sp.Rational(1, 2)),
        ("y1^(1/2) + y2^-2", sp.sqrt(y1) + y2**-2),
        ("ŷ1 + y1hat + yhat_1 + y_1", 3 * yhat1 + y1),
        ("λ θ + lambda theta", 2 * lam * theta),
        ("v_c1 + vc1 + v_{c1} − v_c1·y₁", 3 * v_c1 - v_c1 * y1),
        ("sin(y1)^2 + cos(2 y1) + sqrt(y2)", sp.sin(y1) ** 2 + sp.cos(2 * y1) + sp.sqrt(y2)),
        ("abs(y1) sign(y2) + tanh(y1)", sp.Abs(y1) * sp.sign(y2) + sp.tanh(y1)),
        ("e^(y1) + pi + exp(-y1)", sp.exp(y1) + sp.pi + sp.exp(-y1)),
        (r"\frac{y_{1}^{2}}{2 y_2} + \sqrt{y_3}", y1**2 / (2 * y2) + sp.sqrt(y3)),
        (r"\sin^{2}{\left(\theta \right)} \cdot \hat{y}_{1} \bar y_3", sp.sin(theta) ** 2 * yhat1 * ybar3),
        (
            r"\left|{y_{1}}\right| \operatorname{sign}{\left(y_{2} \right)} e^{- y_{1}}",
            sp.Abs(y1) * sp.sign(y2) * sp.exp(-y1),
        ),
        ("[[y1, 1], [0, y2]] [y1, y2]", sp.ImmutableMatrix([y1**2 + y2, y2**2])),
        ("[y1, y2]^T", sp.ImmutableMatrix([[y1, y2]])),
        ("y1 < 2 y2", sp.StrictLessThan(y1, 2 * y2)),
        ("y1 + y2 = 3", sp.Eq(y1 + y2, 3)),
    ],
)
def test_formulas_are_read_as_they_are_meant(text, formula):
    (reading,) = read(text, LETTERS).lines
    assert reading.formula == formula


def test_a_line_has_a_name_and_a_system_several():
    labels = ["y1dot", "y2dot"]
    for text in (
        "y1' = y2\ny2' = -y1",
        "y1' = y2; y2' = -y1",
        r"\dot{y}_{1} = y_2 \\ \dot{y_2} = -y_1",
        "y1′ = y2, y2′ = −y1",
    ):
        assert [(r.name, r.formula) for r in read(text, LETTERS, labels).lines] == [("y1dot", y2), ("y2dot", -y1)]
    assert [r.formula for r in read("q = y1 + 1\ny2' = q^2", LETTERS, labels).lines] == [(y1 + 1) ** 2]
    assert [r.formula for r in read("y1' = y2 = y3", LETTERS, labels).lines] == [y2, y3]


def test_definitions_may_stand_before_or_after_their_use_and_say_if_they_are_used():
    found = read("y1' = q y1 where q = r + 1, r = y2 = 2 y2 - y2, s = 3", LETTERS, ["y1dot"])
    assert [(line.name, line.formula) for line in found.lines] == [("y1dot", y1 * (y2 + 1))]
    assert [(d.name, d.formulas, d.used) for d in found.definitions] == [
        ("q", (y2 + 1,), True),
        ("r", (y2, y2), True),
        ("s", (3,), False),
    ]


@pytest.mark.parametrize(
    ("text", "formula"),
    [
        ("a3 y1(t)", a3 * y1),
        ("y1 + \\sum_{i=1}^{2} 2 y_i^2", y1 + 2 * y1**2 + 2 * y2**2),
        (r"\left\{ y_1 - y_2 \right\} y_3", (y1 - y2) * y3),
        ("|y1| y2 |y3|", sp.Abs(y1) * y2 * sp.Abs(y3)),
        (r"\int_0^{y_1} \tau d\tau", sp.Integral(sp.Symbol("tau", real=True), (sp.Symbol("tau", real=True), 0, y1))),
        ("[y1, y2; y3, 1]", sp.ImmutableMatrix([[y1, y2], [y3, 1]])),
        ("[y1, y2] [y1; y2]", sp.ImmutableMatrix([y1**2 + y2**2])),
        ("y1/2 (y1 + y2)", y1 / 2 * (y1 + y2)),
    ],
)
def test_notation_of_papers_is_read_as_it_is_meant(text, formula):
    (reading,) = read(text, LETTERS).lines
    assert reading.formula == formula


@pytest.mark.parametrize("text", ["y1 by 2", "y1 with y2 y3", "$y1$ plus $y2$", "y1 (y2) and y3", "b3(y4)"])
def test_no_part_of_a_formula_is_left_out_as_a_word(text):
    letters = LETTERS | {"b3": sp.Symbol("b3", real=True)}
    with suppress(CannotRead):
        assert len(read(text, letters).lines) > 1


def test_what_sympy_prints_is_read():
    switching = sp.Piecewise((2 * y1, y2 < sp.Abs(y1) / 2), (0, True))
    for formula in (
        switching,
        y1 ** sp.Rational(3, 2) / (1 + y2),
        sp.exp(-y1) * sp.tanh(y2),
        sp.Matrix([[y1, 0], [y2 / y3, 1]]),
    ):
        assert (
            read(sp.latex(formula), LETTERS).lines[0].formula == sp.ImmutableMatrix(formula)
            if formula.is_Matrix
            else formula
        )


watched: list[str] = []
looks = False


def _watch(event, arguments):
    if looks and event in ("exec", "compile", "open", "import", "os.system", "subprocess.Popen", "socket.connect"):
        watched.append(event)


sys.addaudithook(_watch)


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_what_is_no_formula_is_refused_and_executes_nothing(text, tmp_path, monkeypatch):
    global looks
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CannotRead):  # whatever a first refusal has to load is loaded
        read(text, LETTERS)
    looks = True
    try:
        read(text, LETTERS)
    except CannotRead as refusal:
        message, position = str(refusal), refusal.position
    finally:
        looks = False
    assert watched == []
    assert not list(tmp_path.iterdir())
    what, shown, caret = message.rsplit("\n", 2)
    assert len(what.split()) > 3
    assert 0 <= position <= len(text)
    assert re.fullmatch(r" {4,54}\^", caret)
    assert len(shown) <= 90


def test_the_canary_sings():
    global looks
    looks = True
    compile("1", "<test>", "eval")
    looks = False
    assert watched.pop() == "compile"
    assert not watched


test_a_refusal_says_what_is_allowed = refuses(
    lambda text: read(text, LETTERS, ["y1dot"]),
    ("y1 + q", '"q" is no letter here; there are a13, a3, a31'),
    ("у1", "CYRILLIC SMALL LETTER U; letters are Latin or Greek"),
    ("y1^y2", "exponents are whole or half numbers up to 20"),
    ("y1/2y2", "after a / it is not clear what is below it"),
    ("y1 + (y2", r"the bracket \( is not closed"),
    ("yhat2", 'did you mean "yhat1"'),
    ("9^9^9", "a power of a power needs brackets"),
    ("1/0", "zero cannot stand below a fraction"),
    ("x1' = y1", "the line x1' is not asked for here"),
    error=CannotRead,
)


def test_what_can_be_read_in_two_ways_is_refused():
    letters = LETTERS | {"a": sp.Symbol("a"), "31y1": sp.Symbol("odd"), "da": sp.Symbol("da")}
    with pytest.raises(CannotRead, match=r'"da3" can be read as .*; write \* between'):
        read("da3", letters | {"3": sp.Symbol("three"), "d": d})


def test_the_caret_stands_under_the_place():
    with pytest.raises(CannotRead) as refusal:
        read("y1' = y2\ny2' = y1 + q y2", LETTERS, ["y1dot", "y2dot"])
    _, shown, caret = str(refusal.value).rsplit("\n", 2)
    assert shown[caret.index("^")] == "q"


def test_everything_that_a_system_prints_is_read_back():
    for motion in MOTIONS.values():
        system = PerspectiveSystem(motion, pinhole())
        for form in (system.measure("y1", "y2"), system.measure("y1")):
            assert check(sp.latex(form.rate), form).right
            assert check(sp.latex(form.w.T), form.w.T).right
        for step in system.derivation():
            if step.values:
                assert check([sp.latex(value) for value in step.values.values()], step).right


x, z, t, u = sp.symbols("x z t u", real=True)


@pytest.mark.parametrize(
    ("one", "other", "verdict"),
    [
        ((x + z) ** 3, sp.expand((x + z) ** 3), True),
        (x / z - z / x, (x**2 - z**2) / (x * z), True),
        ((x + z) ** 3, sp.expand((x + z) ** 3) + sp.Rational(1, 10**9), False),
        (x + sp.prime(9) ** 40 * z, x, False),
        (sp.sin(x + z), sp.sin(x) * sp.cos(z) + sp.cos(x) * sp.sin(z), True),
        (sp.sin(x + z), sp.sin(x) * sp.cos(z) - sp.cos(x) * sp.sin(z), False),
        (sp.cos(2 * sp.atan(x)), (1 - x**2) / (1 + x**2), True),
        (sp.cos(x + sp.pi / 4), (sp.cos(x) - sp.sin(x)) / sp.sqrt(2), True),
        (sp.tanh(x + z), (sp.tanh(x) + sp.tanh(z)) / (1 + sp.tanh(x) * sp.tanh(z)), True),
        (sp.exp(x) ** 2 * sp.exp(-z), sp.exp(2 * x - z), True),
        (sp.sqrt(x**2 + z**2) ** 3, (x**2 + z**2) * sp.sqrt(x**2 + z**2), True),
        (1 / (1 + sp.sqrt(x)), (1 - sp.sqrt(x)) / (1 - x), True),
        (sp.sqrt((x + z) ** 2), x + z, False),
        (sp.sqrt((x + z) ** 2), sp.Abs(x + z), True),
        (x * sp.sign(x), sp.Abs(x), True),
        (sp.Abs(x) * sp.sqrt(x**2 + 1) * sp.sqrt(z**2 + 1), sp.Abs(x) * sp.sqrt(x**2 * z**2 + x**2 + z**2 + 1), True),
        (sp.sign(x**2 - x * z + z**2 + 1), sp.S.One, True),
        (sp.Piecewise((x, x > z), (z, True)), sp.Max(x, z), True),
        (sp.Piecewise((x, x > z), (z, True)), sp.Min(x, z), False),
        (sp.sin(x) ** 2 + sp.cos(x) ** 2, sp.S.One + sp.Rational(1, 10**12), False),
        (sp.Integral(x * t, (t, 0, z)), sp.Integral(x * u, (u, 0, z)), True),
        pytest.param(sp.Integral(x * t, (t, 0, z)), -sp.Integral(x * t, (t, 0, z)), False, marks=pytest.mark.slow),
        pytest.param(sp.Integral(t, (t, 0, z)), z**2 / 2, True, marks=pytest.mark.slow),
        pytest.param(sp.Integral(t, (t, 0, z)) + y, y, False, marks=pytest.mark.slow),
        (sp.Function("f")(x + z), sp.Function("f")(z + x), True),
    ],
)
def test_what_is_the_same_is_told_from_what_is_not(one, other, verdict):
    assert same(explicit(one), explicit(other)) is verdict


@pytest.mark.slow
def test_whatever_is_typed_is_read_or_refused():
    words = r"""
        y1 y2 yhat1 a13 + - * / ^ ( ) [ ] { } , ; = < != 2 0 1/2 sin sqrt log( e^ pi ' ² ^T \frac \sqrt \left[ \right]
        \left| \begin{matrix} \end{matrix} \begin{cases} & \\ \text{for} \hat{y}_{1} \dot _ {1} \sin \cdot d/dt J( y1'
        λ ŷ _{ oo
    """
    draw = random.Random(0)
    outcomes = Counter()
    for _ in range(3000):
        text = " ".join(draw.choices([*words.split(), ""], k=draw.randint(1, 12)))
        try:
            outcomes["read"] += bool(read(text, LETTERS, ["y1dot"]).lines)
        except CannotRead:
            outcomes["refused"] += 1
    assert outcomes["read"] > 30
    assert outcomes["refused"] > 2000


@pytest.mark.slow
def test_a_kept_parser_is_the_one_made_and_one_cut_off_is_made_anew(tmp_path, monkeypatch):
    monkeypatch.setattr(spelling, "user_cache_path", lambda name: tmp_path / name)
    make = spelling.parser.__wrapped__
    made = make()
    (file,) = tmp_path.rglob("*.parser")
    whole = file.read_bytes()
    kept = make()
    assert kept.rules == made.rules
    assert [t.pattern.to_regexp() for t in kept.terminals] == [t.pattern.to_regexp() for t in made.terminals]
    file.write_bytes(whole[:1000])
    assert make().rules == made.rules
    assert len(file.read_bytes()) > 1000
