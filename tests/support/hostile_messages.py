"""Messages that no page of ours would send, from a seed: wrong kinds, wrong places, extremes of what is allowed."""

import math

import numpy as np

from percept_obs.labs.shared.schema import Choice, Entries, Flag, Group, Names, Number, Optional, Row, Several, Text

CANARY = "percept_obs_canary"
"""A file that appears if any text is run as code or taken for a path."""

WRONG = [
    *(None, True, False, 5, -1, -0.0, 1e9, 1e300, -1e-300, 2**70, math.nan, math.inf, b"1"),
    *("", "1", "x", "y1", "exact", "pinhole", "../../etc/passwd", f"__import__('os').mkdir('{CANARY}')", f"/{CANARY}"),
    *([], [None], [[]], [1, 2, 3], [[0.0] * 3] * 3, ["y1"], ["y2", "y1"], ["y1", "y1"], [math.nan] * 3),
    *({}, {1: 2}, {"kind": "pink"}, {"mode": "own", "values": "abc"}, {"__class__": "x"}, {"seed": f"/{CANARY}"}),
]
TYPED = [
    *("", "a11 y1 + a12 (y2 +", "y1' = a13", "9^9^9^9", "((((", "</math><img src=x onerror=alert(1)>", "y1; y2", "1/0"),
    *(f"__import__('os').mkdir('{CANARY}')", f"open('/{CANARY}', 'w')", "\\frac{y1}{", "\x00", "yⅠ + а11", "nan"),
]
NAMES = ["rate 1 X'", "rate 6 y1'", "rate 6", "form 1", "error 1 e1'", "rate 99 x", "", "__class__", "rate -1 y1'"]


def messages(lab, count, seed, with_summary):
    """States as a page would send them; a share `with_summary` asks for an analysis as well."""
    draw = np.random.default_rng(seed)
    opening = lab.settings
    for serial in range(count):
        settings = dict(opening if draw.random() < 0.5 else lab.settings)
        for _ in range(draw.integers(1, 4)):
            name = str(draw.choice(list(settings)))
            if draw.random() < 0.6:
                settings[name] = _allowed(lab.schema[name], draw)
            else:
                places = list(_places(settings[name]))
                settings[name] = _put(settings[name], places[draw.integers(len(places))], _one_of(WRONG, draw))
        message = {"settings": settings if draw.random() < 0.97 else _one_of(WRONG, draw)}
        if draw.random() < with_summary:
            message["summary"] = {"serial": serial} if draw.random() < 0.7 else _one_of(WRONG, draw)
        if draw.random() < 0.1:
            message |= {name: _one_of(WRONG, draw) for name in ("model", "texts", "kind", "parts", "error", CANARY)}
        yield message


def _one_of(values, draw):
    return values[draw.integers(len(values))]


def _allowed(kind, draw):
    """A value of a kind, often at an end of its range."""
    if isinstance(kind, Number):
        low, high = kind.usual or (kind.low, kind.high)
        value = _one_of([kind.low, kind.high, low, high, draw.uniform(low, high), 10 ** draw.uniform(-9, 2)], draw)
        return int(value) if kind.whole else float(value)
    if isinstance(kind, Choice):
        return str(draw.choice(kind.names))
    if isinstance(kind, Names):
        return [str(name) for name in draw.permutation(kind.names)[: draw.integers(0, len(kind.names) + 1)]]
    if isinstance(kind, Flag):
        return bool(draw.integers(2))
    if isinstance(kind, Row):
        return [_allowed(entry, draw) for entry in kind.entries]
    if isinstance(kind, Several):
        return [_allowed(kind.of, draw) for _ in range(draw.integers(0, kind.most + 2))]
    if isinstance(kind, Group):
        return {name: _allowed(of, draw) for name, of in kind.of.items() if draw.random() < 0.9}
    if isinstance(kind, Text):
        return _one_of([*TYPED, "y" * kind.most], draw)[: kind.most]
    if isinstance(kind, Entries):
        return {_one_of(NAMES, draw)[: kind.longest]: _allowed(kind.of, draw) for _ in range(draw.integers(0, 4))}
    if isinstance(kind, Optional):
        return None if draw.random() < 0.5 else _allowed(kind.of, draw)
    return {}  # settings to keep


def _places(value, so_far=()):
    yield so_far
    inside = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in inside:
        yield from _places(part, (*so_far, key))


def _put(value, place, new):
    if not place:
        return new
    changed = value.copy()
    changed[place[0]] = _put(value[place[0]], place[1:], new)
    return changed
