"""Checking a derivation: reading a formula, deciding whether it is the same, explaining where it is not."""

from percept_obs.checking.matching import Verdict
from percept_obs.checking.reading import CannotRead
from percept_obs.checking.review import Review, check
from percept_obs.checking.target import Target
from percept_obs.checking.targets import target_of

__all__ = ["CannotRead", "Review", "Target", "Verdict", "check", "target_of"]
