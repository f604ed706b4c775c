"""Settings that do nothing with some others, which a lab refuses when somebody writes them."""

from collections.abc import Callable, Mapping

from percept_obs.labs.shared.schema import Settings

Idle = Mapping[str, Callable[[Settings], str]]
"""Functions of all settings, by the names of some: why this one does nothing with the others, or empty."""


def only(name: str, *values: str) -> Callable[[Settings], str]:
    """Return the reason why a setting is idle that does something for some values of another one only."""
    named = " or ".join(map(repr, values))
    return lambda whole: "" if whole[name] in values else f"{name} is {whole[name]!r}, not {named}"


def within_run(seconds: Callable[[Settings], float]) -> Callable[[Settings], str]:
    """Return the reason why a setting is idle whose seconds are more than the run has."""
    return lambda whole: f"duration is {whole['duration']:g}" if seconds(whole) > whole["duration"] else ""


WINDOW = within_run(lambda whole: float(whole["window"]))
