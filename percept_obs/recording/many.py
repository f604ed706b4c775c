"""Scenarios with other numbers."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

import numpy as np

from percept_obs.recording.simulation import Scenario
from percept_obs.system.signal import Signal
from percept_obs.system.surfaces import POINT


def numbers_of(scenario: Scenario) -> dict[str, float]:
    """Return the numbers of a scenario by name: X, Y, Z, a constant motion's and the surface's."""
    motion, surface = scenario.motion, scenario.surface
    found = {symbol.name: float(value) for symbol, value in zip(POINT, scenario.position, strict=True)}
    found |= {symbol.name: value for symbol, value in motion.values.items()}
    return found | {symbol.name: value for symbol, value in surface.values.items()}


def with_numbers(scenario: Scenario, **values: float) -> Scenario:
    """Return the scenario with some of its `numbers_of` replaced."""
    now = numbers_of(scenario) | values
    motion, surface = scenario.motion, scenario.surface
    if motion.values:
        motion = replace(motion, signal=Signal(np.array([[now[s.name] for s in motion.parameters]])))
    surface = replace(surface, values=MappingProxyType({s: now[s.name] for s in surface.values}))
    position = [now[symbol.name] for symbol in POINT]
    return replace(scenario, motion=motion, position=position, surface=surface)
