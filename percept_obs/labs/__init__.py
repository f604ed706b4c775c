"""Live labs: what may be moved, and what follows from it at once.  One folder a lab."""

from percept_obs.labs.desk.lab import derivation_desk
from percept_obs.labs.observer.lab import observer_lab
from percept_obs.labs.points.lab import points_lab
from percept_obs.labs.structure.lab import structure_lab

__all__ = ["derivation_desk", "observer_lab", "points_lab", "structure_lab"]
