"""Structure and motion from a scaled inverse depth: choices of unknowns, and their canonical forms."""

from percept_obs.structure.choice import QUANTITIES, ImpossibleChoice, StructureAndMotion
from percept_obs.structure.corollaries import COROLLARIES, Corollary
from percept_obs.structure.dynamics import scaled_dynamics
from percept_obs.structure.linear import LinearView
from percept_obs.structure.simulation import (
    DepthSource,
    GivenDepth,
    PatchDepth,
    ScaledDepthCamera,
    StructureScenario,
    grid_patch,
    linear_view,
    seen_as,
)

__all__ = [
    "COROLLARIES",
    "QUANTITIES",
    "Corollary",
    "DepthSource",
    "GivenDepth",
    "ImpossibleChoice",
    "LinearView",
    "PatchDepth",
    "ScaledDepthCamera",
    "StructureAndMotion",
    "StructureScenario",
    "grid_patch",
    "linear_view",
    "scaled_dynamics",
    "seen_as",
]
