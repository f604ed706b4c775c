"""Nothing that is nearly the same is called right, and no text takes longer than two seconds of computing."""

import sys
import time

import pytest
import sympy as sp
from attacks import attacks, hostile
from examples import AFFINE
from sample_sizes import sampled

from percept_obs import check
from percept_obs.checking import limits, target_of
from percept_obs.checking.deciding import decided
from percept_obs.checking.limits import SECONDS, TooLong, _Over, limited

x, y = sp.symbols("y1 y2", real=True)


def test_there_are_two_hundred_of_each():
    assert min(len(list(attacks())), len(list(hostile()))) >= 200


@pytest.mark.slow
def test_what_is_nearly_the_same_is_not_called_right():
    tried = list(attacks())[:: sampled(5, 1)]
    found = [(family, str(one), str(other)) for family, one, other in tried if check(one, other).right]
    assert found == []


@pytest.mark.parametrize(
    ("one", "other", "where"),
    [
        (sp.asin(sp.sin(x)), x, "|y1| < pi/2"),
        (sp.sqrt(x**2 - 4 * x + 4), 2 - x, "y1 < 2"),
        (sp.sqrt(1 - sp.sin(x) ** 2), sp.cos(x), "cos(y1) > 0"),
        (sp.sign(x - 10**7), -sp.S.One, "y1 < 10000000"),
    ],
)
def test_of_what_holds_for_some_values_it_is_said_for_which(one, other, where):
    assert (decided(one, other).truth, decided(one, other).where) == (False, where)
    assert f"right for {where} only" in str(check(one, other).hint(3))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (sp.Piecewise((x, x > y), (y, True)), sp.Max(x, y)),
        pytest.param(x * sp.Heaviside(x), (x + sp.Abs(x)) / 2, marks=pytest.mark.slow),
        pytest.param(sp.sign(x) * sp.sign(y), sp.sign(x * y), marks=pytest.mark.slow),
        (sp.sqrt(sp.expand((x - 2) ** 2 * (1 + y**2))), sp.Abs(x - 2) * sp.sqrt(1 + y**2)),
        (sp.sin(3 * x + y), sp.expand_trig(sp.sin(3 * x + y))),
        (sp.cos(x + sp.pi / 6), sp.sqrt(3) / 2 * sp.cos(x) - sp.sin(x) / 2),
        (sp.tanh(x / 2), (sp.exp(x) - 1) / (sp.exp(x) + 1)),
        (sp.sech(x) ** 2, 1 - sp.tanh(x) ** 2),
        (1 / (sp.sqrt(x**2 + 1) + x), sp.sqrt(x**2 + 1) - x),
    ],
)
def test_identities_are_proved(one, other):
    assert (decided(one, other).truth, decided(one, other).proved) == (True, True)


def test_what_is_sampled_says_so_and_where_it_holds():
    assert check(sp.sqrt(1 - sp.sin(x) ** 2), sp.Abs(sp.cos(x))).summary.endswith("not proved.")
    assert "ight for |y1| < 1" in check(sp.asin(x), sp.pi / 2 - sp.acos(x)).summary
    assert check(sp.sin(x) ** 2, 1 - sp.cos(x) ** 2).summary == "Right."


def test_the_assumptions_of_letters_are_the_domain():
    p = sp.Symbol("p", positive=True)
    assert check(sp.log(p**2 * x**2), 2 * sp.log(p) + sp.log(x**2)).right
    assert decided(sp.sqrt(p**2 + 2 * p + 1), p + 1).truth
    assert decided(sp.sqrt(x**2 + 2 * x + 1), x + 1).truth is False


def cost(text):
    """Processor seconds for the check of a text, with all hints and both ways to print them."""
    target = target_of(AFFINE)
    target.read("y1' = y1")
    began = time.thread_time()
    try:
        review = check(text, target)
        for number in (1, 2, 3):
            opened = review.hint(number)
            assert str(opened)
            assert opened._repr_markdown_()
    except ValueError:
        pass  # refused
    return time.thread_time() - began


@pytest.mark.slow
def test_no_text_takes_longer_than_the_limit():
    costs = [(round(cost(text), 2), family, text[:80]) for family, text in list(hostile())[:: sampled(24, 1)]]
    assert [each for each in costs if each[0] > SECONDS] == []


def forever():
    while True:
        limits.heed()


def test_what_never_ends_is_stopped_in_words(monkeypatch):
    with pytest.raises(TooLong, match="too long to decide in 2 s; write it shorter"):
        limited(forever, 0.05)
    with pytest.raises(TooLong):
        limited(lambda: limited(forever), 0.05)
    assert limited(lambda: limited(lambda: 3)) == 3


@pytest.mark.parametrize(("error", "reported"), [(_Over, 0), (ArithmeticError, 1)])
def test_the_end_is_not_reported_where_it_cannot_be_raised_and_other_errors_are(error, reported, monkeypatch):
    class Closing:
        def __del__(self):
            raise error

    found = []
    monkeypatch.setattr(sys, "unraisablehook", found.append)
    limited(lambda: Closing() and None)
    assert len(found) == reported
    assert sys.unraisablehook == found.append


def test_what_never_ends_is_stopped_where_there_are_no_threads(monkeypatch):
    def refuse(*arguments):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(limits._thread, "start_new_thread", refuse)
    with pytest.raises(TooLong):
        limited(forever, 0.05)


def test_nothing_is_raised_after_the_work_is_done():
    """Where work ends as the time does, the exception comes in time or not at all."""
    began = time.thread_time()
    outcomes = set()
    while time.thread_time() - began < 0.3:
        until = time.thread_time() + 0.003
        try:
            limited(lambda until=until: all(time.thread_time() < until for _ in range(10**6)), 0.003)
            outcomes.add("done")
        except TooLong:
            outcomes.add("stopped")
        sum(range(2000))
    assert outcomes <= {"done", "stopped"}
