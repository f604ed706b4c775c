"""A derivation in steps is judged line by line: the first line is named that does not follow from the one before."""

import re
import tomllib
from functools import cache

import pytest
from formula_corpus import FOLDER, target

from percept_obs import check

SLIP = re.compile(r"⟨([a-e]):((?:[^⟨⟩|]|⟨[^⟨⟩]*⟩)*)\|([^⟨⟩]*)⟩")


@cache
def derivations():
    """Derivations with their targets."""
    return tuple(tomllib.loads((FOLDER / "derivations.toml").read_text(encoding="utf-8"))["derivation"])


def written(text, slip):
    """The text with one slip, or none."""
    while SLIP.search(text):
        text = SLIP.sub(lambda found: found[3] if found[1] == slip else found[2], text)
    return text


def step(text, slip):
    """Number of the line in which a slip is made, among those with an equation."""
    lines = [line for line in text.splitlines() if "=" in line]
    return 1 + next(k for k, line in enumerate(lines) if f"⟨{slip}:" in line)


def shown(text, slip, name):
    """Return the sentences of a check on the lines of a derivation with a slip."""
    return str(check(written(text, slip).strip(), target(name)).hint(1))


@pytest.mark.parametrize("each", derivations(), ids=lambda each: each["text"][:20].strip())
def test_a_derivation_without_a_slip_is_right(each):
    assert check(written(each["text"], "").strip(), target(each["target"])).right


def named():
    """Derivations and slips of which the step is named, and the others with what is said."""
    found = {}
    for number, each in enumerate(derivations()):
        for slip in "abcde":
            said = shown(each["text"], slip, each["target"])
            found[number, slip] = re.search(rf"[Ll]ine {step(each['text'], slip)} does not follow", said), said
    return found


@pytest.mark.slow
def test_the_step_of_a_slip_is_named():
    found = named()
    for (number, slip), (right, said) in found.items():
        if not right:
            print(number, slip, said)
    assert len(found) == 30
    assert sum(bool(right) for right, _ in found.values()) >= 27
