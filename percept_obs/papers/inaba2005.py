"""Inaba, Abdursul and Ghosh 2005: all parts of its ledger."""

from percept_obs.papers import (
    inaba2005_bounds,
    inaba2005_conditions,
    inaba2005_observer,
    inaba2005_proof,
    inaba2005_theorem,
)

PAPER = "Inaba, Abdursul and Ghosh 2005 (pages counted from the first)"
PARTS = (
    (*inaba2005_theorem.ENTRIES, *inaba2005_bounds.ENTRIES),
    (*inaba2005_observer.ENTRIES, *inaba2005_conditions.ENTRIES, *inaba2005_proof.ENTRIES),
)
