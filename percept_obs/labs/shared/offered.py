"""Which imaging surfaces the labs offer, and where settings keep the numbers of their shapes."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from percept_obs.system import surfaces
from percept_obs.system.surfaces import ImagingSurface

MOST_NUMBERS = 3
"""Numbers that a surface's shape may have, a control each; an ellipsoid's six are left to Python."""

SURFACES = {make.__name__: make for make in surfaces.SURFACES if len(make().parameters) <= MOST_NUMBERS}

SHAPES = MappingProxyType({"plane": "normal", "unified": "xi"})
"""Settings that hold the numbers of a shape, by surfaces."""


def surface_of(settings: Mapping[str, Any]) -> ImagingSurface:
    """The surface that settings describe."""
    name = settings["surface"]
    return SURFACES[name](*([settings[SHAPES[name]]] if name in SHAPES else []))


def shape_of(surface: ImagingSurface) -> dict[str, Any]:
    """The settings that describe a surface.

    Raises
    ------
    ValueError
        If the labs do not offer it.
    """
    name = surface.name
    if name not in SURFACES or not SURFACES[name]().fits(surface):
        raise ValueError(
            f"the labs do not offer the {name} with {len(surface.image)} image coordinates; they offer "
            f"{', '.join(SURFACES)}: convert a recording with seen_on(recording, pinhole())"
        )
    numbers = list(surface.values.values())
    return {"surface": name} | ({SHAPES[name]: numbers if len(numbers) > 1 else numbers[0]} if numbers else {})
