"""Imaging surfaces of the labs, and the settings that hold the numbers of their shapes."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from percept_obs.system import surfaces
from percept_obs.system.surfaces import ImagingSurface

MOST_NUMBERS = 3
"""Largest number of parameters of a surface, a control each; an ellipsoid's six are left to Python."""

SURFACES = {make.__name__: make for make in surfaces.SURFACES if len(make().parameters) <= MOST_NUMBERS}

SHAPES = MappingProxyType({"plane": "normal", "unified": "xi"})
"""Settings that hold the numbers of a shape, by surfaces."""


def shaped_surface(settings: Mapping[str, Any]) -> ImagingSurface:
    """The package's surface of settings."""
    name = settings["surface"]
    return SURFACES[name](*([settings[SHAPES[name]]] if name in SHAPES else []))


def numbers_of(surface: ImagingSurface, name: str) -> dict[str, Any]:
    """Settings that hold the parameters of a surface of this name; empty if it has none."""
    numbers = list(surface.values.values()) if name in SHAPES else []
    return {SHAPES[name]: numbers if len(numbers) > 1 else numbers[0]} if numbers else {}
