"""The article on the first page: scenes, each a set of the observer lab's settings, a question, and words."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from importlib import resources
from typing import Any

import numpy as np

from percept_obs.labs import observer_lab
from percept_obs.labs.observer.lab import ObserverLab
from percept_obs.labs.observer.settings import DRIVE
from percept_obs.labs.shared.schema import Settings
from percept_obs.site.extension import displayed

ARTICLE: dict[str, Any] = tomllib.loads(
    (resources.files("percept_obs.site") / "texts" / "article.toml").read_text("utf-8")
)
"""The text file of the article, which says at its top what may stand in a scene."""

WORDS = ("title", "text", "do", "question", "answers", "told")
"""Parts of a scene that are read without unfolding anything."""

_STILL = np.zeros((3, 3)).tolist()


def settings_of(lab: ObserverLab, wanted: Mapping[str, Any]) -> Settings:
    """Complete settings of the observer lab, checked by it, from those that the text file of the article gives."""
    own = {name: value for name, value in wanted.items() if name in DRIVE or name in lab.schema}
    own |= {"X0": wanted.get("X0", DRIVE["X0"])}
    X0, travels = np.array(own["X0"], dtype=float), -np.array(DRIVE["b"])
    speed = wanted.get("speed", float(np.linalg.norm(travels)))
    way = _along([*wanted["towards"], 1.0]) if "towards" in wanted else _along(travels)
    b = -speed * way
    own["b"] = b.tolist()
    if "guess" in wanted:
        X, Y, Z = X0
        own["start"] = {"mode": "chosen", "values": [X / Z, Y / Z, float(np.linalg.norm(X0)) / Z / wanted["guess"]]}
    if told := wanted.get("told"):
        own["believed"] = {"A": _STILL, "b": (told * b).tolist()}
    if turn := wanted.get("turn"):
        then = -speed * _along(X0 + turn * b)
        own["motion"] = "; ".join(f"b{k} = b{k} if t < {turn} else {then[k - 1]:.9f}" for k in (1, 2, 3))
    if "gain" in wanted:
        own["gains"] = {"identifier_based": {"gain": float(wanted["gain"])}}
    if "noise" in wanted:
        own["noise"] = {"kind": "uniform", "size": wanted["noise"]}
    whole = lab.check({**DRIVE, **own})
    lab.write_down(whole)
    return whole


def _along(way: Any) -> Any:
    return np.array(way) / np.linalg.norm(way)


def prepared(scene: Mapping[str, Any], lab: ObserverLab) -> dict[str, Any]:
    """Return the settings of a scene for the page: at first, after the answer, and at each stop of its hand."""
    first = scene["settings"]
    settings = settings_of(lab, first)
    after = settings_of(lab, {**first, **scene["after"]})
    if "kept" in scene:
        after["kept"] = settings_of(lab, {**first, **scene.get("before", {})})
    hand = scene["hand"]
    if not isinstance(hand, str):
        stops = [
            {"text": text, "changes": _changed(settings, settings_of(lab, {**first, hand["setting"]: value}))}
            for text, value in _stops(hand)
        ]
        hand = {"stops": stops, "at": [stop["changes"] for stop in stops].index({})}
    played = ("name", "bare", "why", "play", "end", "charts", "note", "kept", "right")
    given = {name: scene[name] for name in played if name in scene}
    return {**given, "settings": settings, "after": after, "hand": hand}


def _stops(hand: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield the stops of a hand, each with its text."""
    if "stops" in hand:
        yield from hand["stops"].items()
        return
    for k in range(round((hand["to"] - hand["from"]) / hand["step"]) + 1):
        value = round(hand["from"] + k * hand["step"], 6)
        yield f"{value:g} {hand['unit']}".strip(), value


def _changed(before: Mapping[str, Any], after: Mapping[str, Any]) -> Settings:
    """Return the settings that differ from those before; of a group only the entries that differ."""
    return {
        name: _changed(before[name], value) if isinstance(value, dict) and isinstance(before[name], dict) else value
        for name, value in after.items()
        if value != before[name]
    }


def scenes() -> tuple[list[dict[str, Any]], ObserverLab]:
    """The scenes with their words, formulas and what the page plays; and the lab that plays them."""
    lab = observer_lab()
    found = [
        {**scene, "played": prepared(scene, lab), "formulas": [displayed(each) for each in scene["symbols"]]}
        for scene in ARTICLE["scene"]
    ]
    lab.settings = found[0]["played"]["settings"]
    for scene in found:
        played = scene["played"]
        played["after"] = _changed(played["settings"], played["after"])
        played["settings"] = _changed(lab.settings, played["settings"])
    return found, lab
